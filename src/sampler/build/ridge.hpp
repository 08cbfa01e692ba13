// SPDX-License-Identifier: Apache-2.0
// A sharp lobe that was met by chance, followed over the viewer's elevation, so that a build can look at it
// from the start as if f had told of it.
#pragma once

#include <optional>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"

namespace reflectree::detail {

struct Ridge {
  std::vector<float> theta_o;  // ascending, radians
  std::vector<SharpLobe> lobe;

  // Where it is for wo = (sin theta_o, 0, cos theta_o); nothing where it was lost.
  std::optional<SharpLobe> at(float theta) const;
};

// Climbs from wi to the top of the lobe and follows it towards the normal and towards grazing.
Ridge follow_ridge(const AnyBrdf& f, const Target& target, float theta_o, Direction wi);

}  // namespace reflectree::detail
