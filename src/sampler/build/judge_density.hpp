// SPDX-License-Identifier: Apache-2.0
// One-shot trees, judged by draws from exact trees. Those land in a lobe as often as it has energy, however small it
// is; grids and uniform probes, of which one-shot trees are made, step over it.
#pragma once

#include "slab.hpp"

namespace reflectree::detail {

struct DensityJudgement {
  double variance = 0;  // of weights, relative, in the worst slab
  const Slab* worst = nullptr;
  std::vector<FieldPoint> towers;  // where T is far above the density, the highest first
};

DensityJudgement judge_density(const std::vector<Slab>& one_shot, const std::vector<Slab>& exact,
                               std::uint64_t seed, const Survey& survey);

}  // namespace reflectree::detail
