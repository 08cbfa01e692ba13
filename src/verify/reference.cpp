// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "reflectree/math/frame.hpp"
#include "reflectree/math/low_discrepancy.hpp"

namespace reflectree {
namespace {

constexpr int start_cells_x = 32, start_cells_y = 16;  // 8 per grading of 15 to 19 e-folds
constexpr int patch_cells = 2;

Vec3<double> widen(Direction w) { return normalize(Vec3<double>{w.x, w.y, w.z}); }

struct Highest {
  Vec3<double> w{0, 0, 1};
  double value = 0;  // of t cos_i
};

Highest highest_of(std::span<const Vec3<double>> wi, std::span<const double> t) {
  Highest best;
  for (std::size_t i = 0; i < wi.size(); ++i) {
    if (t[i] * wi[i].z > best.value) best = {wi[i], t[i] * wi[i].z};
  }
  return best;
}

Highest highest(const TargetFunction& f, Vec3<double> wo, std::span<const Vec3<double>> wi) {
  std::vector<double> t(wi.size());
  f.eval(wo, wi, t);
  return highest_of(wi, t);
}

void append_grid(const HemisphereChart& chart, std::vector<Vec3<double>>& points) {
  constexpr int nx = 64, ny = 32;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      points.push_back(chart.direction({4 * (i + 0.5) / nx, 2 * (j + 0.5) / ny}).w);
    }
  }
}

void append_anywhere(std::vector<Vec3<double>>& points) {
  constexpr std::uint32_t count = 8192;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double z = 1 - scrambled_sobol(i, 0, 1), phi = 2 * pi_v<double> * scrambled_sobol(i, 1, 1);
    const double r = std::sqrt(1 - z * z);
    points.push_back({r * std::cos(phi), r * std::sin(phi), z});
  }
}

// The same climb where a call is dear: all steps at once, and azimuths that turn. A thousandth of the height is
// some hundredths of a lobe's width: near enough for the centre of a chart.
Highest climbed_in_few_calls(const TargetFunction& f, Vec3<double> wo, Highest best) {
  constexpr int azimuths = 12, steps = 40;
  for (int round = 0; round < 60; ++round) {
    const LocalFrame<double> frame = frame_from_normal(best.w);
    std::vector<Vec3<double>> around;
    for (int s = 0; s < steps; ++s) {
      const double step = 0.1 * std::pow(0.7, s);  // down to 1e-7
      for (int k = 0; k < azimuths; ++k) {
        const double phi = (k + 0.37 * round + 0.5 * s) * 2 * pi_v<double> / azimuths;
        around.push_back(normalize(best.w + step * (std::cos(phi) * frame.s + std::sin(phi) * frame.t)));
      }
    }
    const Highest next = highest(f, wo, around);
    const bool higher = next.value > best.value * (1 + 1e-3);
    if (next.value > best.value) best = next;
    if (!higher) break;
  }
  return best;
}

Highest climbed(const TargetFunction& f, Vec3<double> wo, Highest best) {
  if (!f.concurrent) return climbed_in_few_calls(f, wo, best);
  // Climb: the best of eight neighbours; halve the step where none is higher by more than rounding.
  double step = 0.05;
  for (int round = 0; round < 200 && step > 1e-7; ++round) {
    const LocalFrame<double> frame = frame_from_normal(best.w);
    std::array<Vec3<double>, 8> around;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const double phi = double(k) * pi_v<double> / 4;
      around[k] = normalize(best.w + step * (std::cos(phi) * frame.s + std::sin(phi) * frame.t));
    }
    const Highest next = highest(f, wo, around);
    if (!(next.value > best.value * (1 + 1e-5))) step *= 0.5;
    if (next.value > best.value) best = next;
  }
  return best;
}

CubatureResult over_patches(const TargetFunction& f, Vec3<double> wo, std::size_t max_evaluations,
                            CubatureOptions options) {
  const HemisphereChart chart = HemisphereChart::projected_disk();
  const Integrand integrand = chart_integrand(f, wo, chart);
  const std::vector<CubatureBox> parts = chart_parts(f);
  options.max_evaluations = max_evaluations / parts.size();
  options.cells_x = options.cells_y = patch_cells;
  CubatureResult sum{0, 0, 0, true};
  for (const CubatureBox& part : parts) {
    const CubatureResult r = cubature(integrand, part, options);
    sum.value += r.value, sum.error += r.error, sum.evaluations += r.evaluations;
    sum.converged = sum.converged && r.converged;
  }
  return sum;
}

}  // namespace

HemisphereChart choose_chart(const TargetFunction& f, Vec3<double> wo) {
  if (!f.patches.empty()) return HemisphereChart::projected_disk();
  const HemisphereChart mirror({-wo.x, -wo.y, wo.z});
  std::vector<Vec3<double>> points;
  append_grid(mirror, points);
  const std::size_t grid = points.size();
  append_anywhere(points);
  std::vector<double> t(points.size());
  f.eval(wo, points, t);
  const auto of = [&](std::size_t from, std::size_t n) {
    return highest_of(std::span(points).subspan(from, n), std::span(t).subspan(from, n));
  };
  const Highest seen = of(0, grid), peak = climbed(f, wo, of(grid, points.size() - grid));
  return peak.value > 1.5 * seen.value ? HemisphereChart(peak.w) : mirror;
}

std::vector<CubatureBox> chart_parts(const TargetFunction& f) {
  if (f.patches.empty()) return {HemisphereChart::domain};
  constexpr double narrowest = 1e-6;  // of the chart: what is narrower is a border told of twice
  std::vector<CubatureBox> parts;
  double y0 = 0;
  for (const PatchBand& band : f.patches) {
    const bool last = &band == &f.patches.back();
    const double y1 = last ? 2 : 2 * sqr(std::sin(double(band.theta_i_end)));
    if (!(y1 > y0 + narrowest)) continue;
    std::vector<double> edges{4};
    for (const float phi : band.phi_i) {
      const double quarters = std::fmod(double(phi) / (0.5 * pi_v<double>), 4);
      edges.push_back(quarters < 0 ? quarters + 4 : quarters);
    }
    std::sort(edges.begin(), edges.end());
    double x0 = 0;
    for (const double edge : edges) {
      const double x1 = edge > 4 - narrowest ? 4 : edge;
      if (!(x1 > x0 + narrowest)) continue;
      parts.push_back({x0, x1, y0, y1});
      x0 = x1;
    }
    y0 = y1;
  }
  return parts;
}

Integrand chart_integrand(const TargetFunction& f, Vec3<double> wo, const HemisphereChart& chart) {
  return [&f, wo, &chart](std::span<const Vec2<double>> p, std::span<double> out) {
    std::vector<Vec3<double>> wi(p.size());
    std::vector<double> measure(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto point = chart.direction(p[i]);
      wi[i] = point.w;
      measure[i] = point.jacobian * point.w.z;
    }
    f.eval(wo, wi, out);
    for (std::size_t i = 0; i < p.size(); ++i) out[i] *= measure[i];
  };
}

Integrand chart_integrand(const ErasedSampler& sampler, Direction wo, const HemisphereChart& chart) {
  return [&sampler, wo, &chart](std::span<const Vec2<double>> p, std::span<double> out) {
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto [w, jacobian] = chart.direction(p[i]);
      out[i] = jacobian * double(sampler.pdf(wo, {float(w.x), float(w.y), float(w.z)}));
    }
  };
}

CubatureResult reference_albedo(const TargetFunction& f, Direction wo, const ReferenceOptions& options) {
  const Vec3<double> w = widen(wo);
  if (!(w.z > 0)) return {0, 0, 0, true};
  CubatureOptions cubature_options;
  cubature_options.relative_tolerance = options.relative_tolerance;
  if (!f.patches.empty()) return over_patches(f, w, options.max_evaluations, cubature_options);
  const HemisphereChart chart =
      options.mirror_symmetric ? HemisphereChart({-w.x, -w.y, w.z}) : choose_chart(f, w);
  cubature_options.max_evaluations = options.max_evaluations;
  const int finer = f.concurrent ? 1 : 2;  // where a call is dear, more in the first one
  cubature_options.cells_x = finer * start_cells_x;
  cubature_options.cells_y = finer * start_cells_y;
  CubatureBox domain = HemisphereChart::domain;
  if (options.mirror_symmetric) {
    domain.x1 *= 0.5;
    cubature_options.cells_x /= 2;
  }
  CubatureResult result = cubature(chart_integrand(f, w, chart), domain, cubature_options);
  if (options.mirror_symmetric) {
    result.value *= 2;
    result.error *= 2;
  }
  return result;
}

}  // namespace reflectree
