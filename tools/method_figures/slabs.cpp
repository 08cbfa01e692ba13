// SPDX-License-Identifier: Apache-2.0
// Steps 3 and 9: what a slab's bounds cost with and without the albedo divided out, and albedo curves.
#include <algorithm>
#include <array>

#include "figures.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/oren_nayar.hpp"
#include "reflectree/brdf/models/phong.hpp"
#include "reflectree/draw/disk_image.hpp"
#include "reflectree/draw/plot.hpp"
#include "reflectree/draw/svg.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

constexpr double deg = pi_v<double> / 180;

// T on an even grid of the square's half, n x n points.
std::vector<double> grid_of(const AnyBrdf& f, const Domain& domain, double theta_o, int n) {
  const Direction wo = viewer_at(float(theta_o));
  const Target target;
  std::vector<double> values;
  for (int k = 0; k < n * n; ++k) {
    const Vec2<float> p{2 * (float(k % n) + 0.5f) / float(n) - 1, (float(k / n) + 0.5f) / float(n)};
    const DomainPoint point = lift(domain, wo, p);
    values.push_back(double(target(f(point.geometry)) * point.projected_area));
  }
  return values;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / double(values.size());
}

}  // namespace

Figure normalised_bounds_figure() {
  // A slab towards grazing, 25 views, each leaf a point of the grid: what is left is due to theta_o alone.
  const AnyBrdf f = Ggx{0.3f, {0.04f, 0.04f, 0.04f}};
  const Domain domain{DomainKind::half_vector, Symmetry::mirror, 0};
  constexpr int n = 128, views = 25;
  const double from = 70, to = 88;
  std::vector<std::vector<double>> grids;
  std::vector<double> theta, albedo, plain(std::size_t(n) * n, 0.0), normalised(std::size_t(n) * n, 0.0);
  for (int v = 0; v < views; ++v) {
    theta.push_back(from + (to - from) * v / (views - 1));
    grids.push_back(grid_of(f, domain, theta.back() * deg, n));
    albedo.push_back(mean(grids.back()));
    for (std::size_t i = 0; i < plain.size(); ++i) {
      plain[i] = std::max(plain[i], grids.back()[i]);
      normalised[i] = std::max(normalised[i], grids.back()[i] / albedo.back());
    }
  }
  std::vector<double> trials_plain, trials_normalised;
  for (const double a : albedo) {
    trials_plain.push_back(mean(plain) / a);
    trials_normalised.push_back(mean(normalised));
  }
  Figure figure{560, 320, "Bounds of the normalised target", {}, {}};
  figure.body =
      label(16, 26, "Bounds of *T* against bounds of *T* / *â* over one slab", Anchor::start, "head");
  Frame plot;
  plot.x = {from, to, 54, 544};
  plot.y = {1, trials_plain.front() * 1.1, 250, 62};
  plot.x_ticks = ticks_every(plot.x, 3, "°");
  plot.y_ticks = ticks(plot.y, 5);
  plot.x_title = "*θ*_o";
  plot.y_title = "expected trials, were the leaves infinitely small";
  figure.body += frame(plot) + curve(plot, theta, trials_plain, "curve-2") +
                 curve(plot, theta, trials_normalised, "curve");
  figure.body += line(54, 300, 74, 300, "curve-2") + label(80, 304, "bounds of *T*", Anchor::start, "note") +
                 line(190, 300, 210, 300, "curve") +
                 label(216, 304, "bounds of *T* / *â*: the same for every *θ*_o", Anchor::start, "note");
  figure.description =
      "Expected trials over a slab from 70 to 88 degrees for GGX of width 0.3. With bounds of T they fall "
      "from " +
      number(trials_plain.front(), 2) + " to " + number(trials_plain.back(), 2) +
      " across the slab; with bounds of the normalised target they are " +
      number(trials_normalised.front(), 2) + " everywhere.";
  return figure;
}

Figure albedo_figure() {
  struct Entry {
    const char* name;
    AnyBrdf f;
    Domain domain;
    const char* css;
  };
  const Domain disk{DomainKind::equal_area, Symmetry::mirror, 0},
      half{DomainKind::half_vector, Symmetry::mirror, 0};
  const std::array<Entry, 4> entries{{{"Lambert, *ρ* = 0.5", Lambert{}, disk, "curve"},
                                      {"Oren–Nayar", OrenNayar{}, disk, "curve-3"},
                                      {"gold-like GGX, *α* = 0.1", Ggx{0.1f}, half, "curve-2"},
                                      {"gold-like GGX, *α* = 0.5", Ggx{0.5f}, half, "curve-4"}}};
  Figure figure{560, 332, "The albedo of the target", {}, {}};
  figure.body = label(16, 26, "The albedo *a*(*ω*_o) of the target", Anchor::start, "head");
  figure.description =
      "Albedo of the target over the viewer's elevation for four models; rough metal falls towards grazing, "
      "smooth metal rises.";
  Frame plot;
  plot.x = {0, 90, 54, 544};
  plot.y = {0, 1.8, 250, 48};
  plot.x_ticks = ticks_every(plot.x, 15, "°");
  plot.y_ticks = ticks(plot.y, 5);
  plot.x_title = "*θ*_o";
  figure.body += frame(plot);
  double x = 40, y = 300;
  for (const Entry& e : entries) {
    std::vector<double> theta, albedo;
    for (int k = 0; k <= 89; ++k) {
      theta.push_back(k < 89 ? k : 89.5);
      albedo.push_back(mean(grid_of(e.f, e.domain, theta.back() * deg, 160)));
    }
    figure.body += curve(plot, theta, albedo, e.css);
    figure.body += line(x, y - 4, x + 22, y - 4, e.css) + label(x + 28, y, e.name, Anchor::start, "note");
    x += 260;
    if (x > 400) x = 40, y += 18;
  }
  return figure;
}

}  // namespace reflectree::method
