// SPDX-License-Identifier: Apache-2.0
#include "judge_density.hpp"

#include <algorithm>
#include <cmath>

#include "bound_draws.hpp"
#include "canonical.hpp"

namespace reflectree::detail {

DensityJudgement judge_density(const std::vector<Slab>& one_shot, const std::vector<Slab>& exact,
                               std::uint64_t seed, const Survey& survey) {
  constexpr std::size_t most_draws = 4'000'000, most_towers = 64;
  constexpr float towering = 8;
  const std::size_t draws = std::clamp<std::size_t>(most_draws / one_shot.size(), 64, 2048);  // per slab
  const Domain& domain = survey.field.domain;
  const KnownBox whole = survey.field.whole();
  const Partition partition = partition_of(exact, survey.field.parameters);
  std::vector<Urn> urns;
  for (const Slab& slab : exact) urns.push_back(urn_of(slab));

  std::vector<FieldPoint> points;
  std::vector<float> shares;  // of the integral over the square, for each T / albedo
  Pcg32 u(seed, 37);
  for (const Slab& slab : one_shot) {
    for (std::size_t k = 0; k < draws; ++k) {
      Shares share{};
      for (int axis = 0; axis < slab.box.axes; ++axis) share[std::size_t(axis)] = to_unit_float(u());
      const Viewer viewer = viewer_at(slab.box.at(share));
      const Urn& urn = urns[slab_index(partition, viewer, whole)];
      const BoundDraw drawn = draw(urn, domain, u);
      points.push_back(field_point(viewer, drawn.p));
      shares.push_back(float(urn.volume() / double(draws)) / drawn.bound);
    }
  }
  std::vector<FieldValue> values(points.size());
  survey.eval(points, values);

  DensityJudgement result;
  std::vector<std::pair<float, std::size_t>> towers;
  for (std::size_t s = 0; s < one_shot.size(); ++s) {
    const Slab& slab = one_shot[s];
    const double volume = double(total(slab, &Leaf::cost));
    double square = 0;  // of the weights, relative
    for (std::size_t i = s * draws; i < (s + 1) * draws; ++i) {
      const float albedo = survey.at_jump(points[i].wo) ? 0 : survey.albedo_at(points[i].viewer());
      if (!(albedo > 0)) continue;
      const Leaf& leaf = slab.nodes[leaf_at(slab, points[i].p, domain)].leaf;
      const float ratio = values[i].mean / albedo;
      const double weight =
          double(ratio) * volume / double(leaf.height * shape(leaf, box_of(leaf.cell, domain), points[i].p));
      square += double(ratio) * double(shares[i]) * weight;
      if (weight > double(towering)) towers.push_back({-float(weight), i});
    }
    if (square - 1 > result.variance) result.variance = square - 1, result.worst = &slab;
  }
  std::sort(towers.begin(), towers.end());
  if (towers.size() > most_towers) towers.resize(most_towers);
  for (const auto& [weight, i] : towers) result.towers.push_back(points[i]);
  return result;
}

}  // namespace reflectree::detail
