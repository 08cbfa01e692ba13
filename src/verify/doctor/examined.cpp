// SPDX-License-Identifier: Apache-2.0
#include "examined.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>

#include "elevations.hpp"
#include "parallel.hpp"
#include "reflectree/math/sum.hpp"
#include "reflectree/verify/bin_masses.hpp"
#include "reflectree/verify/chi_square.hpp"

namespace reflectree::detail {
namespace {

// At least six per side; a bin in a dim place is large and has more.
Nodes nodes_of(const Bins& bins) {
  Nodes nodes;
  for (std::size_t b = 0; b < bins.boxes.size(); ++b) {
    const CubatureBox& r = bins.boxes[b];
    const int nx = std::max(6, int(std::ceil((r.x1 - r.x0) / 4 * 160)));
    const int ny = std::max(6, int(std::ceil((r.y1 - r.y0) / 2 * 80)));
    const double dx = (r.x1 - r.x0) / nx, dy = (r.y1 - r.y0) / ny;
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const auto p = bins.chart.direction({r.x0 + (i + 0.5) * dx, r.y0 + (j + 0.5) * dy});
        nodes.wi.push_back(narrow(p.w));
        nodes.solid_angle.push_back(p.jacobian * dx * dy);
        nodes.bin.push_back(b);
      }
    }
  }
  return nodes;
}

// Half of each, both of mass 1: bins resolve the lobes of pdf and those of f.
TargetFunction mixed(TargetFunction a, double a_total, TargetFunction b, double b_total) {
  TargetFunction mix;
  mix.concurrent = a.concurrent && b.concurrent;
  const double share_a = !(a_total > 0) ? 0 : b_total > 0 ? 0.5 / a_total : 1 / a_total;
  const double share_b = !(b_total > 0) ? 0 : a_total > 0 ? 0.5 / b_total : 1 / b_total;
  mix.eval = [=](Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> t) {
    std::vector<double> other(t.size());
    if (share_a > 0) a.eval(wo, wi, t);
    if (share_b > 0) b.eval(wo, wi, other);
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = share_a * t[i] + share_b * other[i];
  };
  return mix;
}

TargetFunction scaled(TargetFunction f, double factor) {
  f.eval = [inner = f.eval, factor](Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> t) {
    inner(wo, wi, t);
    for (double& x : t) x *= factor;
  };
  return f;
}

double rough_total(const TargetFunction& f, Direction wo) {
  const double tolerance = f.concurrent ? 1e-3 : 1e-2;  // where a call is dear, few of a few points
  return reference_albedo(f, wo, {.relative_tolerance = tolerance, .max_evaluations = 100'000}).value;
}

void integrate_density(const Functions& f, double tolerance, const Host& host, ExaminedView& view) {
  BinMasses masses = function_masses(f.density_function(), view.bins, tolerance, host);
  for (double& m : masses.mass) m = std::max(m, 0.);
  view.pdf_mass = std::move(masses.mass);
  view.pdf_error = masses.error;
  view.pdf_integral = std::accumulate(view.pdf_mass.begin(), view.pdf_mass.end(), 0.);
}

void integrate(const Functions& f, const DoctorOptions& options, const Host& host, ExaminedView& view) {
  const TargetFunction target = f.target_function();
  const TargetFunction density = f.has_pdf() ? f.density_function() : target;
  const double albedo = rough_total(target, view.wo);
  const double integral = f.has_pdf() ? rough_total(density, view.wo) : 0;
  BinOptions bin_options;
  bin_options.count = options.bins;
  bin_options.tolerance = 3e-3;  // of masses that are not used; those that are follow
  view.bins = equal_mass_bins(mixed(target, albedo, density, integral), view.wo, bin_options, host);
  if (view.bins.boxes.empty()) view.bins.boxes = {HemisphereChart::domain}, view.bins.total = 1;
  if (albedo > 0) {
    view.f_mass = function_masses(scaled(target, 1 / albedo), view.bins, 1e-3, host).mass;
    for (double& m : view.f_mass) m = std::max(m * albedo, 0.);
  } else {
    view.f_mass.assign(view.bins.boxes.size(), 0);
  }
  if (f.has_pdf()) integrate_density(f, 1e-3, host, view);
  view.albedo = std::accumulate(view.f_mass.begin(), view.f_mass.end(), 0.);

  view.nodes = nodes_of(view.bins);
  const Directions wo(view.nodes.wi.size(), view.wo);
  const std::vector<double> channels = f.f_cos(wo, view.nodes.wi);
  if (f.has_pdf()) view.pdf_at = f.pdf(wo, view.nodes.wi);
  for (double& p : view.pdf_at) p = sane_or_zero(p);
  view.channel_albedo.resize(f.channels());
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto here = std::span(channels).subspan(i * f.channels(), f.channels());
    view.f_cos_at.push_back(f.target(here));
    for (std::size_t c = 0; c < here.size(); ++c) {
      view.channel_albedo[c] += view.nodes.solid_angle[i] * sane_or_zero(here[c]);
    }
  }
}

struct Drawn {
  Functions::Draws draws;
  std::vector<double> weight;
};

void keep(const Functions& f, const Drawn& drawn, ExaminedView& view) {
  for (std::size_t i = 0; i < drawn.draws.draw.size(); ++i) {
    const PatientDraw& d = drawn.draws.draw[i];
    const auto values = std::span(drawn.draws.value).subspan(i * f.channels(), f.channels());
    ++view.draws;
    view.order.push_back(-1);
    if (is_lost(d, values, f.has_pdf())) {
      ++view.lost;
      if (d.drawn && is_finite(d.wi) && d.wi.z < 0) {
        ++view.draws_lost_below;
        if (view.lost_below.size() < 256) view.lost_below.push_back(d.wi);
      }
      continue;
    }
    if (!is_finite(d.wi) || !std::isfinite(d.pdf)) {
      ++view.broken, ++view.lost;
      continue;
    }
    view.broken_values +=
        std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
    if (!(d.wi.z > 0)) {
      view.a_below = d.wi;
      ++view.below;
      continue;
    }
    const std::size_t b = view.bins.find(d.wi);
    view.order.back() = int(view.wi.size());
    view.wi.push_back(d.wi);
    view.pdf.push_back(d.pdf);
    view.weight.push_back(drawn.weight[i]);
    view.bin.push_back(b);
    ++view.count[b];
    view.light[b] += drawn.weight[i];
    view.light2[b] += sqr(drawn.weight[i]);
  }
}

void draw_all(const Functions& f, const DoctorOptions& options, std::uint64_t seed, const Host& host,
              ExaminedView& view) {
  const std::size_t chunk = f.patient().concurrent ? batch / 4 : batch;  // draws of one seed
  const std::size_t bins = view.bins.boxes.size(), chunks = (options.samples + chunk - 1) / chunk;
  view.count.assign(bins, 0), view.light.assign(bins, 0), view.light2.assign(bins, 0);
  std::vector<Drawn> parts(chunks);
  const auto start = std::chrono::steady_clock::now();
  for_each_index(host, f.patient().concurrent, chunks, [&](std::size_t c) {
    const Directions wo(std::min(chunk, options.samples - c * chunk), view.wo);
    parts[c].draws = f.draw(wo, mixed_seed(seed, c));
  });
  view.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (Drawn& part : parts) {
    const std::size_t n = part.draws.draw.size(), channels = f.channels();
    std::vector<double> f_cos(n * channels);
    if (f.value_kind() == ValueKind::none) {
      Directions wi;
      for (const PatientDraw& d : part.draws.draw) wi.push_back(d.drawn ? d.wi : Direction{0, 0, 1});
      f_cos = f.f_cos(Directions(n, view.wo), wi);
    }
    std::vector<double> weights(channels);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < channels; ++c) {
        weights[c] =
            f.weight(part.draws.draw[i], part.draws.value[i * channels + c], f_cos[i * channels + c]);
      }
      part.weight.push_back(f.target(weights));
    }
    keep(f, part, view);
    part = {};
  }
}

// Steps of a density may deceive the cubatures by more than they estimate: a sum that is slightly off is
// computed again, more finely, before anybody is blamed.
void look_again(const Functions& f, const Host& host, ExaminedView& view) {
  const double off = std::abs(unaccounted(view)), tolerance = integral_tolerance(view, 3);
  if (f.has_pdf() && off > tolerance && off < 5 * tolerance) integrate_density(f, 1e-4, host, view);
}

}  // namespace

std::vector<ExaminedView> examine_views(const Functions& f, const DoctorOptions& options, const Host& host) {
  Pcg32 u = part_generator(options.seed, 21);
  std::vector<ExaminedView> views;
  const auto add = [&](Direction wo) {
    ExaminedView& view = views.emplace_back();
    view.wo = wo;
    char buffer[48];
    std::snprintf(buffer, sizeof buffer, "theta_o %.4g deg", degrees(double(theta_of(wo))));
    view.where = buffer;
  };
  for (const double theta : options.theta_o_deg) {
    add(viewer(std::sin((90 - theta) * pi_v<double> / 180), 2 * pi_v<double> * to_unit_double(u())));
  }
  for (int i = 0; i < options.random_viewers; ++i) add(random_viewer(u));
  for (std::size_t i = 0; i < views.size(); ++i) {
    host.stage("viewers");
    integrate(f, options, host, views[i]);
    draw_all(f, options, mixed_seed(options.seed, 22, i), host, views[i]);
    look_again(f, host, views[i]);
    host.progress(float(i + 1) / float(views.size() + 2));
  }
  return views;
}

Fit fit_of(const DoctorView& view, std::span<const double> mass, bool shape_alone) {
  Tally tally;
  for (const double c : view.count) tally.count.push_back(std::uint64_t(c));
  std::vector<double> all(mass.begin(), mass.end());
  const double total = std::accumulate(all.begin(), all.end(), 0.), rest = 1 - total;
  if (!shape_alone && rest > 0 && (rest * view.draws > 5 || view.lost > 0)) {
    all.push_back(rest);
    tally.count.push_back(std::uint64_t(view.lost));
  }
  tally.samples = std::uint64_t(view.draws);
  Fit fit;
  fit.integral = total;
  fit.dof = double(all.size()) - 1;
  double impossible = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(all[i] > 0)) impossible += double(tally.count[i]);
  }
  const CheckResult r = check_counts(tally, all, {.samples = tally.samples});
  fit.statistic = r.statistic + 1e3 * impossible;
  fit.p_value = impossible > 0 ? 0 : r.p_value;
  return fit;
}

double unaccounted(const ExaminedView& view) {
  return view.pdf_integral + (view.lost + view.below) / view.draws - 1;
}

double integral_tolerance(const ExaminedView& view, double z) {
  const double lost = view.lost / view.draws;
  return 1e-3 + std::min(0.3 * view.pdf_error, 4e-3) +
         z * std::sqrt(std::max(lost * (1 - lost), 0.) / view.draws);
}

}  // namespace reflectree::detail
