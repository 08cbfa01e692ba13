// SPDX-License-Identifier: Apache-2.0
// What a table of the albedo is held against: viewers that no part of it stands at.
#pragma once

#include <vector>

#include "integrals.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

// Viewers at random and at azimuths beside which f changes most, and their albedo by integrals of their own.
class AlbedoWitnesses {
 public:
  AlbedoWitnesses(const Field& field, double relative_error, std::uint64_t seed, const Host& host,
                  std::uint64_t limit);
  // The largest relative miss of the table, beyond what the integrals leave open. Throws Error where f tells
  // of its albedo and is more than a hundredth off.
  double miss_of(const AlbedoTable& table) const;

 private:
  const Field& field_;
  std::vector<Viewer> viewers_;
  Integrals integrals_;
};

}  // namespace reflectree::detail
