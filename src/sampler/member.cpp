// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/member.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

// A partition where some of its coordinates stand still: the nodes that are left, and the slabs, by number.
struct Cut {
  const Partition& from;
  std::span<const float> known;  // by coordinate, from `first_known` on
  std::size_t first_known;
  Partition to = {};
  std::vector<std::size_t> slabs = {};
  std::size_t node = 0, inner = 0, slab = 0;

  void walk(bool kept) {
    const std::uint8_t axis = from.axis[node++];
    if (axis == Partition::leaf) {
      if (kept) slabs.push_back(slab), to.axis.push_back(Partition::leaf);
      ++slab;
      return;
    }
    const float split = from.split[inner++];
    if (axis < first_known) {
      if (kept) to.axis.push_back(axis), to.split.push_back(split);
      walk(kept), walk(kept);
      return;
    }
    const bool upper = known[axis - first_known] >= split;  // borders belong to the upper slab
    walk(kept && !upper), walk(kept && upper);
  }
};

template <class Tree>
void cut(const Partition& partition, const std::vector<Tree>& trees, std::span<const float> known,
         std::size_t first_known, Partition& to, std::vector<Tree>& kept) {
  Cut cutter{partition, known, first_known};
  cutter.to.coordinates.assign(partition.coordinates.begin(),
                               partition.coordinates.begin() + std::ptrdiff_t(first_known));
  cutter.walk(true);
  to = std::move(cutter.to);
  for (const std::size_t slab : cutter.slabs) kept.push_back(trees[slab]);
}

}  // namespace

SamplerData member_data(const SamplerData& family, const Parameters& at, std::string material,
                        const BrdfProbes& probes) {
  if (family.parameters.empty())
    throw Error("the sampler is of one function and has no members", family.material, "name a family");
  Coordinates known{};
  for (std::size_t i = 0; i < family.parameters.size(); ++i) {
    const KnownParameter& p = family.parameters[i];
    if (!p.range.contains(at[i])) {
      throw Error(p.range.name + " is outside of its range", family.material,
                  "stay between " + std::to_string(p.range.lo) + " and " + std::to_string(p.range.hi));
    }
    known[i] = clamp(coordinate_of(p, at[i]), lowest(p), highest(p));
  }
  SamplerData member;
  member.material = std::move(material);
  member.target = family.target, member.frame = family.frame;
  member.domain = family.domain;
  if (member.domain.kind == DomainKind::scaled_star) {
    member.domain.scale_x = scale_by(family.law.x, known);
    member.domain.scale_y = scale_by(family.law.y, known);
  }
  const std::size_t first_known = family.frame.isotropic() ? 1 : 2;
  cut(family.exact_partition, family.exact, known, first_known, member.exact_partition, member.exact);
  cut(family.one_shot_partition, family.one_shot, known, first_known, member.one_shot_partition,
      member.one_shot);
  const AlbedoTable& table = family.albedo;
  member.albedo.cos_theta_o = table.cos_theta_o, member.albedo.phi_o = table.phi_o;
  member.albedo.even = table.even, member.albedo.relative_error = table.relative_error;
  const std::vector<float>& azimuths = table.phi_o;
  for (std::size_t k = 0; k < std::max<std::size_t>(azimuths.size(), 1); ++k) {
    float phi = azimuths.empty() ? 0 : azimuths[k];
    // Where a segment ends and the next one begins, both sides.
    if (k + 1 < azimuths.size() && azimuths[k + 1] == phi) phi = std::nextafter(phi, 0.f);
    for (const float c : table.cos_theta_o) member.albedo.albedo.push_back(albedo_at(table, c, phi, known));
  }
  member.probes = probes;
  member.report = family.report;
  member.report.expected_trials = 0;
  for (MajorantTree& tree : member.exact) {
    member.report.expected_trials = std::max(member.report.expected_trials, tree.volume);
    // What is proved is proved beside the family's albedo, of which the member's is a rounding.
    tree.status = BoundStatus::estimated, tree.bound_ratio = 0;
  }
  validate(member);
  return member;
}

}  // namespace reflectree
