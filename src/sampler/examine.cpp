// SPDX-License-Identifier: Apache-2.0
#include "examine.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "grow.hpp"
#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/albedo.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t pairs = 4096;
constexpr float symmetric_enough = 1e-4f;  // mirror images are one function, up to rounding
constexpr float half_square_up_to = 0.2f;  // asymmetry that still is cheaper on half a square
constexpr float isotropic_enough = 1e-2f;

Direction mirrored(Direction w) { return {w.x, -w.y, w.z}; }
Direction turned(Direction w, float c, float s) { return {c * w.x - s * w.y, s * w.x + c * w.y, w.z}; }

// Pairs in the plane of incidence of wo, spread by the maps of two domains so that lobes are met.
void make_pairs(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi) {
  Pcg32 u(seed, 11);
  while (wo.size() < pairs) {
    const float cos_theta_o = max(to_unit_float(u()), 1e-3f);
    const float shrink = wo.size() % 4 < 2 ? 1.f : to_unit_float(u());
    const Vec2<float> p{shrink * (2 * to_unit_float(u()) - 1), shrink * (2 * to_unit_float(u()) - 1)};
    const Domain domain{wo.size() % 2 ? DomainKind::half_vector : DomainKind::equal_area, false, 0};
    const Direction known = wo_from_cosine(cos_theta_o);
    const DomainPoint q = lift(domain, known, p);
    if (!(q.geometry.wi.z > 1e-3f)) continue;
    wo.push_back(known), wi.push_back(q.geometry.wi);
  }
}

struct Difference {
  float relative = 0;  // sum |a - b| / sum (a + b) / 2
  std::size_t worst = 0;
};
Difference difference(const std::vector<float>& a, const std::vector<float>& b, std::size_t channels) {
  double miss = 0, sum = 0;
  float worst = -1;
  Difference d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float m = abs(a[i] - b[i]);
    miss += double(m), sum += 0.5 * (double(a[i]) + double(b[i]));
    if (m > worst) worst = m, d.worst = i / channels;
  }
  d.relative = sum > 0 ? float(miss / sum) : 0.f;
  return d;
}

std::string describe(Direction wo, Direction wi) {
  char text[160];
  std::snprintf(text, sizeof text, " at wo = (%.7g, %.7g, %.7g), wi = (%.7g, %.7g, %.7g)", double(wo.x),
                double(wo.y), double(wo.z), double(wi.x), double(wi.y), double(wi.z));
  return text;
}

// What half a square costs beside a whole one, however many leaves it has: the mass of the larger of both
// mirror images over that of their mean, less 1, at the worst of the slabs. Points are drawn by the trees'
// own bounds.
float folding_cost(const std::vector<Slab>& slabs, const Field& field, std::uint64_t seed) {
  constexpr std::size_t points_a_slab = 4096;
  Pcg32 u(seed, 13);
  float worst = 0;
  for (const Slab& slab : slabs) {
    std::vector<FieldPoint> points;
    std::vector<double> weight;
    const double step = double(total(slab, &Leaf::cost)) / double(points_a_slab);
    double cost = 0, next = 0.5 * step;
    for (const std::uint32_t i : leaves_in_order(slab)) {
      const Leaf& leaf = slab.nodes[i].leaf;
      const Box box = box_of(leaf.cell, field.domain);
      for (cost += double(leaf.cost); next < cost; next += step) {
        points.push_back(
            {slab.cos_theta_o[1],
             {box.x0 + box.width * to_unit_float(u()), box.y0 + box.height * to_unit_float(u())}});
        weight.push_back(1 / double(leaf.share));
      }
    }
    std::vector<FieldValue> values(points.size());
    field.eval(points, values);
    double mean = 0, upper = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
      mean += weight[k] * double(values[k].mean), upper += weight[k] * double(values[k].upper);
    if (mean > 0) worst = max(worst, float(upper / mean - 1));
  }
  return worst;
}

}  // namespace

Examination examine(const AnyBrdf& f, const BuildOptions& options, const Host&) {
  const auto channels = std::size_t(f.channels());
  if (f.channels() < 1 || f.channels() > max_channels) {
    throw Error("the BRDF has " + std::to_string(f.channels()) + " channels", f.traits().name,
                "give it 1 to " + std::to_string(max_channels));
  }
  if (!f.traits().isotropic) {
    throw Error("the material is anisotropic: it depends on the azimuth of wo", f.traits().name,
                "use an isotropic material; anisotropic samplers are not built yet");
  }
  std::vector<Direction> wo, wi;
  make_pairs(options.seed, wo, wi);
  const auto values_at = [&](const std::vector<Direction>& o, const std::vector<Direction>& i) {
    std::vector<float> values(o.size() * channels);
    f.eval(o, i, values);
    return values;
  };
  const std::vector<float> first = values_at(wo, wi);
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (std::isfinite(first[k]) && first[k] >= 0) continue;
    throw Error("the BRDF returned " + std::to_string(first[k]) + ": it must be finite and not negative",
                f.traits().name + describe(wo[k / channels], wi[k / channels]),
                "mend the function at these directions");
  }
  const std::vector<float> second = values_at(wo, wi);
  if (first != second) {
    const Difference d = difference(first, second, channels);
    throw Error(
        "two calls with the same directions gave different values: a stochastic function has no bounds",
        f.traits().name + describe(wo[d.worst], wi[d.worst]), "average it into a deterministic function");
  }
  std::vector<Direction> other_wo = wo, other_wi = wi;
  Pcg32 u(options.seed, 12);
  for (std::size_t k = 0; k < wo.size(); ++k) {
    const float phi = 6.2831853f * to_unit_float(u()), c = cos(phi), s = sin(phi);
    other_wo[k] = turned(wo[k], c, s), other_wi[k] = turned(wi[k], c, s);
  }
  const Difference turn = difference(first, values_at(other_wo, other_wi), channels);
  if (turn.relative > isotropic_enough) {
    throw Error("the BRDF changes when both directions turn about the normal: it is anisotropic",
                f.traits().name + describe(wo[turn.worst], wi[turn.worst]),
                "use an isotropic material; anisotropic samplers are not built yet");
  }
  for (std::size_t k = 0; k < wo.size(); ++k) other_wi[k] = mirrored(wi[k]);
  Examination seen;
  seen.asymmetry = difference(first, values_at(wo, other_wi), channels).relative;
  seen.mirror_symmetric = seen.asymmetry <= symmetric_enough;
  return seen;
}

Domain choose_domain(const AnyBrdf& f, const BuildOptions& options, const Examination& seen,
                     const Host& host) {
  constexpr float degree = pi / 180;
  constexpr struct {
    float theta, width;
  } trials[] = {{2, 3}, {20, 3}, {40, 3}, {60, 3}, {75, 2}, {84, 1}, {88.5f, 0.5f}};
  const bool half = seen.asymmetry <= half_square_up_to;
  const AlbedoTable flat{{min_cos_theta_o, 1}, {1, 1}, 0};
  // A coarser goal, and no slab is halved: what theta_o costs is counted in.
  const float goal = 1 + 2 * (options.expected_trials - 1);
  GrowthRules rules{goal, 1, 2000, false, true, analyse_exact, 1e30f};
  Domain best;
  std::vector<Slab> best_slabs;
  float least = 1e30f;
  for (const Domain domain :
       {Domain{DomainKind::half_vector, half, 0}, Domain{DomainKind::equal_area, half, 0},
        Domain{DomainKind::projected_disk, half, 0}, Domain{DomainKind::back_vector, half, 0},
        Domain{DomainKind::stretched, half, 1.5f}}) {
    std::vector<Slab> slabs;
    for (const auto& t : trials)
      slabs.push_back(make_slab(t.theta * degree, (t.theta + t.width) * degree, flat, domain));
    std::uint64_t evaluations = 0;
    const Field field{f, options.target, domain, half && !seen.mirror_symmetric};
    grow(slabs, field, flat, rules, host, &evaluations);
    float price = 0;
    for (const Slab& slab : slabs) {
      double cost = 0, ideal = 0, theta_cost = 0;
      float leaves = 0;
      for (const Node& node : slab.nodes) {
        if (node.split != Split::leaf) continue;
        cost += double(node.leaf.cost), ideal += double(node.leaf.ideal),
            theta_cost += double(node.leaf.theta_cost);
        ++leaves;
      }
      if (!(ideal > 0)) continue;
      const float budget = goal - 1;
      const float missed = max(1.f, float((cost - ideal) / ideal) / budget);
      const float narrower = max(1.f, float(theta_cost / ideal) / (0.4f * budget));
      price += leaves * missed * missed * narrower;
    }
    if (price < least) least = price, best = domain, best_slabs = std::move(slabs);
    // Who needs twice as many leaves in one slab as the best in all has lost.
    rules.max_leaves = std::size_t(clamp(2 * least, 32.f, 2000.f));
  }
  // Leaves grow as 1 / (what is left of the trials allowed): past half of them a whole square is cheaper.
  if (half && !seen.mirror_symmetric) {
    const Field field{f, options.target, best, true};
    const float cost = folding_cost(best_slabs, field, options.seed);
    best.half = cost < 0.5f * (options.expected_trials - 1);
  }
  return best;
}

}  // namespace reflectree::detail
