// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/leaf_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "elevations.hpp"
#include "parallel.hpp"
#include "reflectree/sampler/known/incidence.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {
namespace {

constexpr int cdf_bins = 64;
constexpr std::size_t viewers_of_places = 8;  // the draws are shared among so many wo
// Square coordinates of a direction in float are known to about this.
constexpr double blur = 1.5e-7;
// A leaf is resolved where the blur is below this share of it: 0.6 % of the last of 64 bins changes sides,
// and as much comes back where the density is the same there.
constexpr double resolved = 1e-4;
constexpr double largest_theta_o = pi_v<double> / 3;

struct Place {
  std::size_t leaf;  // of the slab
  double tx, ty;     // across it, in [0, 1]
  double width, length;
  double gx, gy;
};

// Down the packed tree by halving cells; the shares of probability play no part.
std::optional<Place> locate(const PackedSampler& packed, const Parameters& member, Direction wo,
                            Direction wi) {
  Incidence in;
  if (!find_incidence(packed, wo, member, in)) return std::nullopt;
  const bool half = packed.domain.half();
  Direction local = to_incidence(in, wi);
  if (half) local.y = std::abs(local.y);
  const Vec2<float> p = lower(domain_at(packed.viewer, packed.domain, in), in.wo, local);
  const PackedForest& forest = packed.one_shot;
  const PackedSlab& slab = slab_at(packed, forest, in);
  const DescentNode* node = forest.nodes.data() + slab.first_node;
  std::size_t leaf = 0;
  double x = -1, y = half ? 0 : -1, width = 2, length = half ? 1 : 2;
  for (std::uint32_t leaves = slab.count; leaves > 1;) {
    const bool along_x = node->split_x;
    double &start = along_x ? x : y, &size = along_x ? width : length;
    const std::uint32_t below = node->lower_leaves;
    size *= 0.5;
    const bool upper = double(along_x ? p.x : p.y) >= start + size;
    if (upper) start += size;
    leaf += upper ? below : 0;
    leaves = upper ? leaves - below : below;
    node += upper ? below : 1;
  }
  const PackedLeaf& l = forest.leaves[slab.first + leaf];
  // Whether a leaf is resolved may depend on nothing but the leaf and wo: a choice by the place itself would
  // bend what is counted. The half vector turns by the error of wi over 2 wo.wh, about cos theta_o where
  // lobes are; the azimuth about the pole is known to the blur over the distance from it, y or, where y is
  // sin^2 theta_i, its root.
  const DomainKind kind = packed.domain.kind;
  const bool about_normal =
      kind == DomainKind::projected_disk || kind == DomainKind::equal_area || kind == DomainKind::stretched;
  const double blurred = about_normal ? blur : blur / double(in.wo.z), middle = std::abs(y + 0.5 * length);
  const double distance = about_normal ? std::sqrt(middle) : middle;
  if (blurred / width > resolved * distance || blurred / length > resolved) return std::nullopt;
  return Place{leaf,
               std::clamp((double(p.x) - x) / width, 0., 1.),
               std::clamp((double(p.y) - y) / length, 0., 1.),
               width,
               length,
               double(l.slope_x) / 128,
               double(l.slope_y) / 128};
}

double cdf(double slope, double t) { return t * (1 - slope * (1 - t)); }

struct Axis {
  double moment = 0, variance = 0;
  std::array<std::array<std::uint64_t, cdf_bins>, 2> count{};
  void add(double slope, double t) {
    const double s = 2 * t - 1, sign = slope < 0 ? -1 : 1;
    moment += sign * (s - slope / 3);
    variance += 1. / 3 - slope * slope / 9;
    const int bin = std::clamp(int(cdf(slope, t) * cdf_bins), 0, cdf_bins - 1);
    ++count[std::size_t(slope < 0)][std::size_t(bin)];
  }
  void add(const Axis& other) {
    moment += other.moment, variance += other.variance;
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t b = 0; b < cdf_bins; ++b) count[k][b] += other.count[k][b];
    }
  }
};

struct Part {
  Axis x, y;
  std::uint64_t seen = 0;
};

CheckResult slope_result(const char* name, const Axis& axis, std::uint64_t seen, const ChiSquareOptions& o) {
  CheckResult r;
  r.name = name;
  r.threshold = normal_two_sided_quantile(sidak(o.family_significance, o.tests));
  r.decided = seen >= 10'000;
  // Leaves are told apart in float: some 1e-4 of the draws near a border may be counted on its wrong side.
  const double bias = 1e-5 * double(seen);
  r.statistic = axis.variance > 0 ? std::max(std::abs(axis.moment) - bias, 0.) / std::sqrt(axis.variance) : 0;
  r.p_value = std::erfc(r.statistic / std::sqrt(2.));
  r.passed = !r.decided || r.statistic <= r.threshold;
  char buffer[120];
  std::snprintf(buffer, sizeof buffer, "standard deviations of the mean place; %llu places, off by %.2g",
                static_cast<unsigned long long>(seen), seen > 0 ? axis.moment / double(seen) : 0.);
  r.detail = buffer;
  return r;
}

CheckResult shape_result(const Part& all, const ChiSquareOptions& o) {
  CheckResult r;
  r.name = "leaf_shape";
  double dof = 0;
  for (const Axis* axis : {&all.x, &all.y}) {
    for (const auto& count : axis->count) {
      double sum = 0;
      for (const std::uint64_t n : count) sum += double(n);
      if (sum < 20 * cdf_bins) continue;
      const double expected = sum / cdf_bins;
      for (const std::uint64_t n : count) r.statistic += sqr(double(n) - expected) / expected;
      dof += cdf_bins - 1;
    }
  }
  r.decided = dof > 0;
  const double level = sidak(o.family_significance, o.tests);
  r.threshold = dof > 0 ? chi_square_quantile(level, dof) : 0;
  r.p_value = dof > 0 ? chi_square_tail(r.statistic, dof) : 1;
  r.passed = !r.decided || r.p_value >= level;
  char buffer[120];
  std::snprintf(buffer, sizeof buffer, "%.0f degrees of freedom, %llu places", dof,
                static_cast<unsigned long long>(all.seen));
  r.detail = buffer;
  return r;
}

// Among n places on a lattice of m points (1 - 1/m)^n m stay empty.
double expected_distinct(double n, double m) { return m * -std::expm1(n * std::log1p(-1 / m)); }

struct Lattice {
  double n = 0, distinct = 0, points = 0;
  double lost() const { return expected_distinct(n, points) - distinct; }
};

// Places rounded to the finest lattice that the blur leaves, at most 2^20.
Lattice lattice_of(std::vector<double>& places, double size) {
  Lattice l;
  l.n = double(places.size());
  l.points = std::exp2(std::min(20., std::floor(-std::log2(2 * blur / size))));
  for (double& t : places) t = std::floor(t * l.points);
  std::sort(places.begin(), places.end());
  l.distinct = double(std::unique(places.begin(), places.end()) - places.begin());
  return l;
}

CheckResult distinct_result(const Suspect& s, std::uint64_t draws, std::uint64_t seed,
                            const ChiSquareOptions& o) {
  CheckResult r;
  r.name = "leaf_distinct";
  r.passed = true, r.decided = false;
  r.detail = "no leaf is large enough";
  r.threshold = normal_two_sided_quantile(sidak(o.family_significance, 4 * o.tests));
  for (const double theta_deg : {20., 55.}) {
    Pcg32 u = detail::part_generator(seed, std::uint64_t(theta_deg));
    const Direction wo = detail::viewer(std::cos(theta_deg * pi_v<double> / 180), 2);
    std::vector<std::vector<Place>> by_leaf;
    for (std::uint64_t i = 0; i < draws; ++i) {
      const auto wi = s.propose(wo, u);
      const auto at = wi ? locate(*s.packed, s.at, wo, *wi) : std::nullopt;
      if (!at) continue;
      if (by_leaf.size() <= at->leaf) by_leaf.resize(at->leaf + 1);
      by_leaf[at->leaf].push_back(*at);
    }
    for (const bool along_x : {true, false}) {
      // 2^18 points and more can tell 2^16; the fullest such leaf.
      const std::vector<Place>* best = nullptr;
      for (const auto& places : by_leaf) {
        if (places.size() < 2000) continue;
        if (2 * blur / (along_x ? places[0].width : places[0].length) > 0x1p-18) continue;
        if (!best || places.size() > best->size()) best = &places;
      }
      if (!best) continue;
      std::vector<double> t;
      for (const Place& p : *best) t.push_back(along_x ? cdf(p.gx, p.tx) : cdf(p.gy, p.ty));
      const Lattice l = lattice_of(t, along_x ? (*best)[0].width : (*best)[0].length);
      // The number of coincidences is nearly Poisson.
      const double coincidences = l.n - expected_distinct(l.n, l.points);
      const double z = l.lost() / std::sqrt(coincidences + 1);
      r.decided = true;
      if (z <= r.statistic && r.statistic > 0) continue;
      r.statistic = std::max(z, 0.);
      r.passed = r.statistic <= r.threshold;
      char buffer[160];
      std::snprintf(buffer, sizeof buffer,
                    "along %s: %.0f distinct among %.0f on 2^%.0f points, %.0f expected", along_x ? "x" : "y",
                    l.distinct, l.n, std::log2(l.points), expected_distinct(l.n, l.points));
      r.detail = buffer;
    }
  }
  return r;
}

using DrawDirections =
    std::function<void(Direction wo, Pcg32& u, std::vector<std::optional<Direction>>& out)>;

Part places_of(const Suspect& s, const DrawDirections& draw, std::uint64_t draws, std::uint64_t seed,
               const Host& host) {
  constexpr std::uint64_t chunk = 1 << 13;
  Pcg32 choice = detail::part_generator(seed, 0);
  std::vector<Direction> viewers;
  for (std::size_t i = 0; i < viewers_of_places; ++i) {
    const double theta = largest_theta_o * (double(i) + to_unit_double(choice())) / double(viewers_of_places);
    viewers.push_back(detail::viewer(std::cos(theta), 2 * pi_v<double> * to_unit_double(choice())));
  }
  std::vector<Part> parts((draws + chunk - 1) / chunk);
  detail::for_each_index(host, s.concurrent(), parts.size(), [&](std::size_t c) {
    Pcg32 u = detail::part_generator(seed, c + 1);
    const Direction wo = viewers[c % viewers.size()];
    std::vector<std::optional<Direction>> drawn(chunk);
    draw(wo, u, drawn);
    for (const auto& wi : drawn) {
      const auto at = wi ? locate(*s.packed, s.at, wo, *wi) : std::nullopt;
      if (!at) continue;
      ++parts[c].seen;
      parts[c].x.add(at->gx, at->tx);
      parts[c].y.add(at->gy, at->ty);
    }
  });
  Part all;
  for (const Part& p : parts) all.x.add(p.x), all.y.add(p.y), all.seen += p.seen;
  return all;
}

DrawDirections drawn_by(const WayIn& way, std::size_t channels) {
  return [&way, channels](Direction wo, Pcg32& u, std::vector<std::optional<Direction>>& out) {
    std::vector<DrawnAt> drawn(out.size());
    std::vector<float> weights(out.size() * channels);
    way.draw(wo, u, drawn, weights);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = drawn[i].drawn ? std::optional(drawn[i].wi) : std::nullopt;
    }
  };
}

}  // namespace

std::vector<CheckResult> check_leaf_places(const Suspect& s, std::uint64_t draws, std::uint64_t seed,
                                           const ChiSquareOptions& options, const Host& host) {
  std::vector<CheckResult> results;
  const auto judge = [&](const std::string& way, const Part& part) {
    for (CheckResult r :
         {slope_result("leaf_slope_x", part.x, part.seen, options),
          slope_result("leaf_slope_y", part.y, part.seen, options), shape_result(part, options)}) {
      r.way = way;
      results.push_back(std::move(r));
    }
  };
  const DrawDirections propose = [&](Direction wo, Pcg32& u, std::vector<std::optional<Direction>>& out) {
    for (auto& wi : out) wi = s.propose(wo, u);
  };
  judge("one-shot, propose", places_of(s, propose, draws, seed, host));
  for (std::size_t w = 0; w < s.ways.size(); ++w) {
    if (s.ways[w].exact) continue;
    judge(s.ways[w].name,
          places_of(s, drawn_by(s.ways[w], s.channels()), draws / 8, detail::mixed_seed(seed, w), host));
  }
  results.push_back(distinct_result(s, std::min<std::uint64_t>(draws / 8, 1'000'000), seed, options));
  results.back().way = "one-shot, propose";
  return results;
}

}  // namespace reflectree
