// SPDX-License-Identifier: Apache-2.0
// T and its bound over boxes of viewers and places in a leaf, by the formulas that a sampler runs.
#pragma once

#include <array>
#include <optional>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/sampler/square/enclosed_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree::detail {

// theta_o in radians, then shares of the leaf's cell along x and y.
struct ProofBox {
  static constexpr std::size_t axes = 3;
  std::array<double, axes> lo{}, hi{};
};
using ProofPoint = std::array<double, ProofBox::axes>;

// The viewers of a slab: floats cos_theta_o of [lo, hi].
struct CosineRange {
  float lo, hi;
};
// The elevations of wo that hold them.
struct Elevations {
  double lo, hi;
};

struct EnclosedPoint {
  // T for both signs of wi.y: the second is missing where a square tells them apart, or f does not.
  AffineForm target;
  std::optional<AffineForm> mirrored;
  AffineForm unit;  // albedo q: T may reach majorant times it
};
struct PointValue {
  float target = 0, unit = 0;  // of both signs the larger T
};

// Throws Error where a value is not what the enclosure over its place says.
void check_value(const EnclosedPoint& enclosed, const PointValue& value);

class EnclosedField {
 public:
  // Keeps f's enclosure and the references.
  EnclosedField(const AnyBrdf& f, const PackedSampler& packed);

  Elevations elevations(CosineRange cosines) const;
  LeafCell<float> cell_of(const PackedLeaf& leaf) const { return unpack(leaf, packed_.domain.half()); }
  // Whether the square holds wi about the normal, not half vectors and the like.
  bool is_of_directions() const {
    const DomainKind kind = packed_.domain.kind;
    return kind == DomainKind::projected_disk || kind == DomainKind::equal_area ||
           kind == DomainKind::stretched;
  }
  EnclosedPoint over(const ProofBox& box, CosineRange cosines, const PackedLeaf& leaf) const;
  // The stored albedo, over elevations.
  AffineForm albedo(double theta_lo, double theta_hi, CosineRange cosines) const;
  // As a sampler computes it.
  PointValue at(const ProofPoint& point, CosineRange cosines, const PackedLeaf& leaf) const;

 private:
  Vec3<AffineForm> viewer_over(double theta_lo, double theta_hi, CosineRange cosines) const;
  AffineForm albedo_over(const AffineForm& cosine) const;
  // g: the point's geometry, or its image.
  AffineForm target_over(const DomainPointT<AffineForm>& point, const ShadingGeometry<AffineForm>& g) const;

  const AnyBrdf& f_;
  std::shared_ptr<const BrdfEnclosure> enclosure_;
  bool mirror_symmetric_;
  const PackedSampler& packed_;
};

}  // namespace reflectree::detail
