// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/packed_family.hpp"

namespace reflectree {

namespace {

PackedWidth pack(const std::array<float, 1 + max_parameters>& law, const PackedFamily& family) {
  PackedWidth width;
  double largest = double(law[0]);
  for (std::size_t i = 0; i < family.count; ++i) {
    const PackedParameter& p = family.parameters[i];
    width.slope[i] = law[1 + i];
    width.corner[i] = law[1 + i] > 0 ? p.highest : p.lowest;
    largest += double(width.slope[i]) * double(width.corner[i]);
  }
  width.largest = float(std::exp(largest));
  return width;
}

}  // namespace

PackedFamily pack(const std::vector<KnownParameter>& parameters, const ScaleLaw& law) {
  PackedFamily family;
  family.count = std::min(parameters.size(), max_parameters);
  for (std::size_t i = 0; i < family.count; ++i) {
    const KnownParameter& p = parameters[i];
    family.parameters[i] = {p.range.lo, p.range.hi, lowest(p), highest(p), p.logarithmic};
  }
  family.x = pack(law.x, family), family.y = pack(law.y, family);
  family.round = law.x == law.y;
  return family;
}

}  // namespace reflectree
