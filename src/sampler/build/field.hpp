// SPDX-License-Identifier: Apache-2.0
// The builder's view of a BRDF: T(wo, x, y) over the square of a domain, evaluated in batches, and
// what all steps of a build share.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "known_box.hpp"
#include "patches.hpp"
#include "reflectree/brdf/family.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/host.hpp"
#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "ridge.hpp"

namespace reflectree::detail {

// A viewer, in its frame (viewer_frame.hpp), and a point of the square.
struct FieldPoint {
  Direction wo;
  Vec2<float> p;
  Coordinates at = {};  // of families: of the parameters
  Viewer viewer() const { return {wo, at}; }
};
inline FieldPoint field_point(const Viewer& viewer, Vec2<float> p) { return {viewer.wo, p, viewer.at}; }

// With half domains T differs between wi and its mirror image where f is not quite mirror-symmetric:
// exact trees bound `upper`, albedo and densities use `mean`.
struct FieldValue {
  float mean, upper;
};

// A place of the square where f may hide a needle that a grid steps over, and how small it is there, in
// coordinates of the square.
struct Landmark {
  Vec2<float> p;
  Vec2<float> size;
};

struct TreeMarks;

struct Field {
  AnyBrdf f;
  Target target;
  Domain domain;
  bool both_sides = false;         // evaluate the mirror image too
  std::vector<Ridge> ridges = {};  // sharp lobes that f did not tell of and that were met all the same
  ViewerFrame frame = {};
  std::optional<AnyFamily> family = {};  // of which f is a member
  std::vector<KnownParameter> parameters = {};
  ScaleLaw law = {};
  const TreeMarks* marks = nullptr;  // what trees of this field have met, for the cubature of the albedo
  std::vector<PatchCell> patches = {};

  // All that is known of viewers.
  KnownBox whole() const;
  // Throws Error, naming the directions, for a value that is negative, NaN or infinite.
  void eval(std::span<const FieldPoint> points, std::span<FieldValue> out) const;
  // The place of wi in the square, and back; both directions in the viewer's frame.
  Vec2<float> place_of(const Viewer& viewer, Direction wi) const;
  Direction direction_at(const FieldPoint& point) const;
  // From the viewer's frame to the caller's.
  Direction to_caller(Direction w) const;
  // The mirror direction of wo, wo itself, and the sharp lobes that f tells of; the same number, in the same
  // order, for every wo for which f tells of as many.
  std::vector<Landmark> landmarks(const Viewer& viewer) const;
};

// What a build may cost, and has.
struct Effort {
  std::uint64_t evaluations = 0, limit = ~std::uint64_t(0);
  bool spent() const { return evaluations >= limit; }
};

// All points of a round at once, through the host's threads where f allows.
void eval_in_parallel(const Field& field, const Host& host, Effort& effort,
                      std::span<const FieldPoint> points, std::span<FieldValue> out);

// Where f leaps as a whole when the viewer moves.
struct ThetaJump {
  float at = 0;                  // radians
  double before = 0, after = 0;  // of the cosines, neighbouring floats where it can be told, on both sides
};
struct Jumps {
  std::vector<ThetaJump> theta_o;  // ascending
  std::vector<float> phi_o;        // radians, in the viewer's frame, ascending: found and told of
  std::vector<float> phi_o_bends;  // those of them that f tells of and at which it is steady
};

float albedo_of(const Field& field, const AlbedoTable& table, const Viewer& viewer);

// What is known about a function once its domain is chosen, and by what means it is asked.
struct Survey {
  const Field& field;
  const AlbedoTable& albedo;
  const Host& host;
  Effort& effort;
  const Jumps* jumps = nullptr;
  std::vector<FieldPoint>* towers = nullptr;  // where the attack met values far above a bound are noted here
  const CosineLookup* guide = nullptr;        // of an isotropic function's albedo

  float albedo_at(const Viewer& viewer) const {
    return guide ? reflectree::albedo_at(albedo, *guide, viewer.wo.z) : albedo_of(field, albedo, viewer);
  }
  // So close to a jump that rounding decides on which side wo is.
  bool at_jump(Direction wo) const;
  bool at_jump(const FieldPoint& q) const { return at_jump(q.wo) || on_patch_border(field.patches, q.p); }
  void eval(std::span<const FieldPoint> points, std::span<FieldValue> out) const {
    eval_in_parallel(field, host, effort, points, out);
  }
};

}  // namespace reflectree::detail
