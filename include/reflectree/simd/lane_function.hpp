// SPDX-License-Identifier: Apache-2.0
// The formula of a model in lanes, chosen at run time: one virtual call for as many directions
// as there are lanes.
#pragma once

#include <memory>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/models/all.hpp"
#include "reflectree/simd/block_values.hpp"

namespace reflectree {

class LaneFunction {
 public:
  virtual ~LaneFunction() = default;
  // sr^-1, without cosine, where both cosines are positive: the bits of the float formula (lanes.hpp).
  virtual RgbT<Lanes> operator()(const ShadingGeometry<Lanes>& g) const = 0;
};

// Of a material that is one model and nothing else; nullptr for any other.
inline std::shared_ptr<const LaneFunction> lane_function(const Material& material) {
  std::shared_ptr<const LaneFunction> found;
  if (material.terms.size() != 1 || material.terms[0].weight != 1) return found;
  const MaterialTerm& term = material.terms[0];
  for_each_model([&]<class M>(std::type_identity<M>) {
    if constexpr (LaneBrdf<M>) {
      struct Model final : LaneFunction {
        M f;
        explicit Model(M model) : f(std::move(model)) {}
        RgbT<Lanes> operator()(const ShadingGeometry<Lanes>& g) const override { return f(g); }
      };
      if (term.model == M::describe().name)
        found = std::make_shared<const Model>(model_from_values<M>(term.values));
    }
  });
  return found;
}

}  // namespace reflectree
