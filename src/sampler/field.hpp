// SPDX-License-Identifier: Apache-2.0
// The builder's view of a BRDF: T(cos_theta_o, x, y) over the square of a domain, evaluated in batches.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/sampler/domain_map.hpp"
#include "reflectree/sampler/host.hpp"

namespace reflectree::detail {

struct FieldPoint {
  float cos_theta_o;
  Vec2<float> p;
};

// With half domains T differs between wi and its mirror image where f is not quite mirror-symmetric:
// exact trees bound `upper`, albedo and densities use `mean`.
struct FieldValue {
  float mean, upper;
};

inline Direction wo_from_cosine(float cos_theta_o) {
  return {sqrt(max((1 - cos_theta_o) * (1 + cos_theta_o), 0.f)), 0, cos_theta_o};
}

// Where reflectance functions hide needles that a grid steps over: the mirror direction of wo, and wo itself.
inline constexpr int landmark_count = 2;
inline Vec2<float> landmark(const Domain& domain, float cos_theta_o, int i) {
  const Direction wo = wo_from_cosine(cos_theta_o);
  return lower(domain, wo, i == 0 ? Direction{-wo.x, 0, wo.z} : wo);
}

struct Field {
  AnyBrdf f;
  Target target;
  Domain domain;
  bool both_sides = false;  // evaluate the mirror image too

  // Throws Error, naming the directions, for a value that is negative, NaN or infinite.
  void eval(std::span<const FieldPoint> points, std::span<FieldValue> out) const;
};

// All points of a round at once, through the host's threads where f allows.
void eval_in_parallel(const Field& field, const Host& host, std::span<const FieldPoint> points,
                      std::span<FieldValue> out);

}  // namespace reflectree::detail
