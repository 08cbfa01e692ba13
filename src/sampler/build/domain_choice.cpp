// SPDX-License-Identifier: Apache-2.0
// The domain with the fewest leaves, by trial.
#include <algorithm>
#include <cmath>

#include "examine.hpp"
#include "grow.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

namespace {

constexpr float half_square_up_to = 0.2f;  // asymmetry that still is cheaper on half a square

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
            {slab.views[slab.views.size() / 2].cos_theta_o,
             {box.x0 + box.width * to_unit_float(u()), box.y0 + box.height * to_unit_float(u())}});
        weight.push_back(1 / double(leaf.height));
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

Domain choose_domain(const AnyBrdf& f, const BuildOptions& options, const Examination& seen,
                     const std::vector<Ridge>& ridges, const Host& host) {
  constexpr float degree = pi / 180;
  constexpr struct {
    float theta, width;
  } trials[] = {{2, 3}, {20, 3}, {40, 3}, {60, 3}, {75, 2}, {84, 1}, {88.5f, 0.5f}};
  const Symmetry symmetry = seen.asymmetry <= half_square_up_to ? Symmetry::mirror : Symmetry::none;
  const AlbedoTable flat{{min_cos_theta_o, 1}, {1, 1}, 0};
  // A coarser goal, and no slab is halved: what theta_o costs is counted in.
  const float goal = 1 + 2 * (options.expected_trials - 1);
  GrowthRules rules{goal, 1, 2000, false, true, analyse_exact, 1e30f};
  Domain best;
  std::vector<Slab> best_slabs;
  float least = 1e30f;
  double best_mass = 0;
  for (const Domain domain :
       {Domain{DomainKind::half_vector, symmetry, 0}, Domain{DomainKind::equal_area, symmetry, 0},
        Domain{DomainKind::projected_disk, symmetry, 0}, Domain{DomainKind::back_vector, symmetry, 0},
        Domain{DomainKind::stretched, symmetry, 1.5f}, Domain{DomainKind::mirror_vector, symmetry, 0},
        Domain{DomainKind::normal_vector, symmetry, 0}}) {
    const Field field{f, seen.target, domain, domain.half() && !seen.mirror_symmetric, ridges};
    std::vector<Slab> slabs;
    for (const auto& t : trials)
      slabs.push_back(make_slab(t.theta * degree, (t.theta + t.width) * degree, flat, field));
    Effort effort{0, options.max_evaluations / 20};
    grow(slabs, {field, flat, host, effort}, rules);
    float price = 0;
    double mass = 0;  // what the domain's grids saw: one that oversaw a lobe is cheap for that reason
    for (const Slab& slab : slabs) {
      double cost = 0, ideal = 0, theta_cost = 0;
      float leaves = 0;
      for (const Node& node : slab.nodes) {
        if (node.split != TreeSplit::leaf) continue;
        cost += double(node.leaf.cost), ideal += double(node.leaf.ideal),
            theta_cost += double(node.leaf.theta_cost);
        ++leaves;
      }
      if (!(ideal > 0)) continue;
      mass += ideal;
      const float budget = goal - 1;
      const float missed = max(1.f, float((cost - ideal) / ideal) / budget);
      const float narrower = max(1.f, float(theta_cost / ideal) / (0.4f * budget));
      price += leaves * missed * missed * narrower;
    }
    const bool blind = mass == 0 && best_mass > 0, sees_more = mass > 0 && best_mass == 0;
    if (sees_more || (price < least && !blind))
      least = price, best = domain, best_mass = mass, best_slabs = std::move(slabs);
    // A domain that needs in one slab twice as many leaves as the best in all cannot win.
    rules.max_leaves = std::size_t(clamp(2 * least, 32.f, 2000.f));
  }
  // Leaves grow as 1 / (what is left of the trials allowed): past half of them a whole square is cheaper.
  if (best.half() && !seen.mirror_symmetric) {
    const Field field{f, seen.target, best, true, ridges};
    const float cost = folding_cost(best_slabs, field, options.seed);
    if (!(cost < 0.5f * (options.expected_trials - 1))) best.symmetry = Symmetry::none;
  }
  return best;
}

}  // namespace reflectree::detail
