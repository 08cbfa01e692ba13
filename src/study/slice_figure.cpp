// SPDX-License-Identifier: Apache-2.0
// The slices as a picture: the target as an area, every density as a curve over it.
#include <algorithm>

#include "page_parts.hpp"
#include "reflectree/draw/plot.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

struct Point {
  double x, y;
};

// Without the points that lie within a quarter of a unit of the line between their neighbours kept
// (Douglas and Peucker 1973).
void keep(std::span<const Point> points, std::vector<Point>& out) {
  if (points.size() > 2) {
    const Point a = points.front(), b = points.back();
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    std::size_t far = 0;
    double most = 0.25;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const Point p = points[i];
      const double off = length > 0 ? std::abs((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / length
                                    : std::hypot(p.x - a.x, p.y - a.y);
      if (off > most) most = off, far = i;
    }
    if (far > 0) {
      keep(points.first(far + 1), out);
      keep(points.subspan(far), out);
      return;
    }
  }
  for (const Point& p : points) {
    if (&p == &points.front() || &p == &points.back()) out.push_back(p);
  }
}

// Where the density is 0 the curve is broken.
PathData drawn(const Frame& axes, std::span<const double> angles, std::span<const double> densities) {
  PathData data;
  std::vector<Point> run;
  const auto flush = [&] {
    std::vector<Point> kept;
    if (!run.empty()) keep(run, kept);
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (i == 0) data.move_to(kept[i].x, kept[i].y);
      data.line_to(kept[i].x, kept[i].y);
    }
    run.clear();
  };
  for (std::size_t i = 0; i < angles.size() && i < densities.size(); ++i) {
    if (densities[i] > 0) {
      run.push_back({axes.x.at(angles[i]), axes.y.at(densities[i])});
    } else {
      flush();
    }
  }
  flush();
  return data;
}

Frame axes_of(std::span<const double> angles, std::span<const double> target, double x, double y) {
  double highest = 0, lowest = 1e300;
  for (std::size_t i = 0; i < target.size(); ++i) {
    highest = std::max(highest, target[i]);
    if (std::abs(angles[i]) < 85 && target[i] > 0) lowest = std::min(lowest, target[i]);
  }
  if (!(highest > 0)) highest = 1;
  lowest = std::clamp(lowest / 3, highest * 1e-6, highest / 30);
  Frame axes;
  axes.x = {-90, 90, x, x + 420}, axes.y = {lowest, highest * 2, y + 190, y, true};
  axes.x_ticks = ticks_every(axes.x, 30, "°"), axes.y_ticks = ticks(axes.y, 6);
  return axes;
}

}  // namespace

Figure slice_figure(const MaterialResult& m, const StudyOptions& o) {
  // Samplers of one density share a line of the key.
  std::vector<std::pair<std::string, const SamplerResult*>> key;
  for (const SamplerResult& s : m.samplers) {
    if (s.slices.empty() || s.slices[0].empty()) continue;
    const auto same =
        std::find_if(key.begin(), key.end(), [&](const auto& k) { return k.second->slices == s.slices; });
    if (same == key.end()) {
      key.emplace_back(s.sampler, &s);
    } else {
      same->first += ", " + s.sampler;
    }
  }
  const std::size_t panels = std::min(m.slices.size(), o.theta_o_deg.size());
  constexpr double wide = 480, high = 250;
  Figure f{2 * wide + 210,
           high * double((panels + 1) / 2) + 24,
           "Slices in the plane of incidence",
           "The density of light directions in the plane of incidence, per steradian, on a log axis: the "
           "target as an area, every sampler as a curve.",
           {}};
  for (std::size_t i = 0; i < panels; ++i) {
    const double x = 46 + wide * double(i % 2), y = 26 + high * double(i / 2);
    const auto angles = plane_angles(o.theta_o_deg[i]);
    if (m.slices[i].size() != angles.size()) continue;
    const Frame axes = axes_of(angles, m.slices[i], x, y);
    f.body += frame(axes);
    f.body += label(x, y - 8, "*θ*_o = " + number(o.theta_o_deg[i]) + "°", Anchor::start, "label");
    // The area ends where the target does, on the axis.
    std::vector<double> closed = m.slices[i];
    for (double& d : closed) d = std::max(d, axes.y.lo);
    closed.front() = closed.back() = axes.y.lo;
    f.body += path(drawn(axes, angles, closed), "fill-target");
    for (std::size_t k = key.size(); k-- > 0;) {  // ours last, on top
      const SamplerResult& s = *key[k].second;
      if (i < s.slices.size()) f.body += path(drawn(axes, angles, s.slices[i]), curve_class(s.sampler));
    }
  }
  double y = 38;
  const double x = 2 * wide + 10;
  f.body += rectangle(x, y - 10, 24, 10, "fill-target") + label(x + 32, y, "target", Anchor::start, "tick");
  for (const auto& [names, s] : key) {
    y += 18;
    f.body += line(x, y - 4, x + 24, y - 4, curve_class(s->sampler));
    f.body += label(x + 32, y, names, Anchor::start, "tick");
  }
  f.height = std::max(f.height, y + 20);
  return f;
}

}  // namespace reflectree::study
