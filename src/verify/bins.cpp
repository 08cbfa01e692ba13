// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/bin_masses.hpp"

#include <algorithm>
#include <cmath>

#include "box_integrals.hpp"
#include "neighbours.hpp"
#include "reflectree/math/sum.hpp"

namespace reflectree {
namespace {

using Regions = std::vector<CubatureRegion>;

double lo(const CubatureBox& r, bool x) { return x ? r.x0 : r.y0; }
double hi(const CubatureBox& r, bool x) { return x ? r.x1 : r.y1; }

// The share of a region below `at`, its mass taken as uniform: good enough to place borders.
double share_below(const CubatureBox& r, bool x, double at) {
  return std::clamp((at - lo(r, x)) / (hi(r, x) - lo(r, x)), 0., 1.);
}

double mass_below(const Regions& regions, bool x, double at) {
  double mass = 0;
  for (const auto& r : regions) mass += r.value * share_below(r.box, x, at);
  return mass;
}

double spread(const Regions& regions, bool x) {
  double mass = 0, first = 0, second = 0;
  for (const auto& r : regions) {
    const double c = 0.5 * (lo(r.box, x) + hi(r.box, x));
    mass += r.value;
    first += r.value * c;
    second += r.value * (c * c + sqr(hi(r.box, x) - lo(r.box, x)) / 12);
  }
  return mass > 0 ? second / mass - sqr(first / mass) : 0;
}

double quantile(const Regions& regions, bool x, double mass, double a, double b) {
  for (int i = 0; i < 45; ++i) {
    const double middle = 0.5 * (a + b);
    (mass_below(regions, x, middle) < mass ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

Regions part(const Regions& regions, bool x, double at, bool upper) {
  Regions result;
  for (CubatureRegion r : regions) {
    const double below = share_below(r.box, x, at);
    r.value *= upper ? 1 - below : below;
    if (!(r.value > 0)) continue;
    if (below > 0 && below < 1) (x ? (upper ? r.box.x0 : r.box.x1) : (upper ? r.box.y0 : r.box.y1)) = at;
    result.push_back(r);
  }
  return result;
}

// What bins are made of: a patch of f, or the whole chart.
struct Part {
  CubatureBox box;
  Regions regions;
  double mass = 0;
};

// Returns the node's number, or -1 - bin.
int divide(Bins& bins, const Regions& regions, const CubatureBox& box, int count) {
  if (count <= 1) {
    bins.boxes.push_back(box);
    return -int(bins.boxes.size());
  }
  const bool x = spread(regions, true) >= spread(regions, false);
  double mass = 0;
  for (const auto& r : regions) mass += r.value;
  const int lower_count = count / 2;
  const double at = quantile(regions, x, mass * lower_count / count, lo(box, x), hi(box, x));
  CubatureBox below = box, above = box;
  (x ? below.x1 : below.y1) = at;
  (x ? above.x0 : above.y0) = at;
  const auto node = bins.nodes.size();
  bins.nodes.push_back({x, at, 0, 0});
  const int lower = divide(bins, part(regions, x, at, false), below, lower_count);
  const int upper = divide(bins, part(regions, x, at, true), above, count - lower_count);
  bins.nodes[node].lower = lower;
  bins.nodes[node].upper = upper;
  return int(node);
}

// The same for parts in rows: a line between two rows, or two parts of a row, cuts none. Each has a bin at least.
int divide(Bins& bins, std::span<const Part> parts, double mass_of_a_bin) {
  if (parts.size() == 1) {
    const Part& part = parts.front();
    return divide(bins, part.regions, part.box, std::max(1, int(std::lround(part.mass / mass_of_a_bin))));
  }
  const auto row = [&](std::size_t i) { return parts[i].box.y0; };
  const bool x = row(0) == row(parts.size() - 1);
  std::size_t half = parts.size() / 2;
  while (!x && half > 0 && row(half - 1) == row(half)) --half;
  if (half == 0)
    half = std::size_t(
        std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.box.y0 > row(0); }) -
        parts.begin());
  const auto node = bins.nodes.size();
  bins.nodes.push_back({x, lo(parts[half].box, x), 0, 0});
  const int lower = divide(bins, parts.first(half), mass_of_a_bin);
  const int upper = divide(bins, parts.subspan(half), mass_of_a_bin);
  bins.nodes[node].lower = lower;
  bins.nodes[node].upper = upper;
  return int(node);
}

// Relative, of the total and of a cubature from cells that share no border with the first: where kinks or
// the rim deceive both rules of a cell, the two disagree.
double difference_to_another_road(const Integrand& f, std::span<const Part> parts, double total) {
  CubatureOptions options;
  options.relative_tolerance = 1e-5;
  options.max_evaluations = 200'000;
  options.cells_x = parts.size() > 1 ? 3 : 37;
  options.cells_y = parts.size() > 1 ? 3 : 23;
  double sum = 0;
  for (const Part& part : parts) sum += cubature(f, part.box, options).value;
  return std::abs(sum / total - 1);
}

}  // namespace

std::size_t Bins::find(Direction wi) const {
  const auto bin_of = [this](Vec3<double> w) {
    const Vec2<double> p = chart.coordinates(w);
    int i = nodes.empty() ? -1 : 0;
    while (i >= 0) {
      const Node& n = nodes[std::size_t(i)];
      i = (n.split_x ? p.x : p.y) < n.at ? n.lower : n.upper;
    }
    return std::size_t(-1 - i);
  };
  const std::size_t bin = bin_of({wi.x, wi.y, wi.z});
  if (!patches || mass.empty() || mass[bin] > 0) return bin;
  for (const Vec3<double>& w : detail::neighbours(wi)) {
    if (mass[bin_of(w)] > 0) return bin_of(w);
  }
  return bin;
}

Bins equal_mass_bins(const TargetFunction& f, Direction wo, const BinOptions& options, const Host& host) {
  const Vec3<double> w = normalize(Vec3<double>{wo.x, wo.y, wo.z});
  Bins bins{wo, HemisphereChart({0, 0, 1}), {}, {}, {}, 0, 0, !f.patches.empty()};
  const bool told = options.centre && !bins.patches;
  if (w.z > 0) bins.chart = told ? HemisphereChart(*options.centre) : choose_chart(f, w);
  if (!(w.z > 0)) return bins;
  const Integrand integrand = chart_integrand(f, w, bins.chart);

  CubatureOptions coarse;
  coarse.relative_tolerance = f.concurrent ? 1e-3 : 1e-2;  // where a call is dear, few of a few points
  coarse.max_evaluations = 400'000;
  coarse.cells_x =
      bins.patches ? 2 : detail::grid_x;  // ten regions per bin: a region's mass is taken as uniform
  coarse.cells_y = bins.patches ? 2 : detail::grid_y;
  std::vector<Part> parts;
  double whole = 0;
  for (const CubatureBox& box : chart_parts(f)) {
    Part& part = parts.emplace_back(Part{box, {}, 0});
    part.mass = cubature(integrand, box, coarse, part.regions).value;
    for (auto& r : part.regions)
      r.value = std::max(r.value, 0.);  // a rule with a negative weight may undershoot
    whole += part.mass;
  }
  if (!(whole > 0)) return bins;
  divide(bins, parts, whole / options.count);

  detail::BoxRule fine;
  fine.relative_tolerance = options.tolerance;
  fine.absolute_tolerance = 0.1 * options.tolerance * whole / options.count;
  fine.max_evaluations = 200'000;
  const auto results = detail::integrate_all(integrand, f.concurrent, bins.boxes, fine, host);
  CompensatedSum total;
  for (const CubatureResult& r : results) {
    bins.mass.push_back(r.value);
    total += r.value;
    if (r.value > 0) bins.worst_error = std::max(bins.worst_error, r.error / r.value);
  }
  bins.total = total.value();
  bins.worst_error = std::max(bins.worst_error, difference_to_another_road(integrand, parts, bins.total));
  return bins;
}

namespace {

BinMasses masses(const Integrand& integrand, bool concurrent, const Bins& bins, double tolerance,
                 double absolute_tolerance, bool slivers, const Host& host) {
  detail::BoxRule rule;
  rule.relative_tolerance = tolerance;
  rule.absolute_tolerance = absolute_tolerance;
  rule.max_evaluations = 60'000;
  rule.slivers = slivers;
  BinMasses result;
  CompensatedSum error;
  for (const CubatureResult& r : detail::integrate_all(integrand, concurrent, bins.boxes, rule, host)) {
    result.mass.push_back(r.value);
    error += r.error;
  }
  result.error = error.value();
  return result;
}

double share_of_a_bin(const Bins& bins) { return 1 / double(std::max<std::size_t>(bins.boxes.size(), 1)); }

}  // namespace

std::vector<double> density_masses(const ErasedSampler& sampler, const Bins& bins, double tolerance,
                                   const Host& host) {
  return masses(chart_integrand(sampler, bins.wo, bins.chart), sampler.concurrent, bins, tolerance,
                0.1 * tolerance * share_of_a_bin(bins), bins.patches, host)
      .mass;
}

BinMasses function_masses(const TargetFunction& f, const Bins& bins, double tolerance, const Host& host) {
  const Vec3<double> w = normalize(Vec3<double>{bins.wo.x, bins.wo.y, bins.wo.z});
  return masses(chart_integrand(f, w, bins.chart), f.concurrent, bins, tolerance,
                0.1 * tolerance * share_of_a_bin(bins) * bins.total, false, host);
}

}  // namespace reflectree
