// SPDX-License-Identifier: Apache-2.0
// T and its bound over boxes of viewers and places in a leaf, by the formulas that a sampler runs.
#pragma once

#include <array>
#include <optional>

#include "enclosed_viewer.hpp"
#include "reflectree/brdf/family.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree::detail {

// theta_o in radians, shares of the leaf's cell along x and y, then what else is unknown of the viewer: its azimuth,
// the coordinates of a family's parameters. As many as the field says; all others are 0, but star_axis of boxes.
inline constexpr std::size_t most_axes = AffineForm::variables;
using ProofPoint = std::array<double, most_axes>;
struct ProofBox {
  ProofPoint lo{}, hi{};
};

struct EnclosedPoint {
  // T for both signs of wi.y: the second is missing where a square tells them apart, or f does not.
  AffineForm target;
  std::optional<AffineForm> mirrored;
  AffineForm unit;           // albedo q: T may reach majorant times it; 0 where the box is empty
  RealInterval angle{0, 0};  // of the star, as far as the box has it
};
struct PointValue {
  float target = 0, unit = 0;  // of both signs the larger T
};

// Throws Error where a value is not what the enclosure over its place says.
void check_value(const EnclosedPoint& enclosed, const PointValue& value);

class EnclosedField {
 public:
  // Keep the enclosure and the references.
  EnclosedField(const AnyBrdf& f, const PackedSampler& packed);
  EnclosedField(const AnyFamily& family, const PackedSampler& packed);

  std::size_t axes() const { return 2 + viewer_.axes(); }
  // Whether boxes have a range of the star's angle, too (slope_star in enclosed_map.hpp).
  bool divides_angle() const {
    const DomainKind kind = packed_.domain.kind;
    return !packed_.viewer.turns && (kind == DomainKind::slope_star || kind == DomainKind::scaled_star);
  }
  Elevations elevations(const KnownRange& known) const { return viewer_.elevations(known); }
  // All viewers of a slab, and the whole leaf.
  ProofBox whole(const KnownRange& known) const;
  LeafCell<float> cell_of(const PackedLeaf& leaf) const { return unpack(leaf, packed_.domain.half()); }
  // Whether the square holds wi about the normal, not half vectors and the like.
  bool is_of_directions() const {
    const DomainKind kind = packed_.domain.kind;
    return kind == DomainKind::projected_disk || kind == DomainKind::equal_area ||
           kind == DomainKind::stretched;
  }
  // About the angle of the star.
  double star_angle(const ProofPoint& point, const LeafCell<float>& cell) const;
  // The viewers of a box, to be kept while boxes differ in their places alone.
  ViewerForms viewers_of(const ProofBox& box, const KnownRange& known) const;
  EnclosedPoint over(const ViewerForms& viewers, const ProofBox& box, const PackedLeaf& leaf) const;
  EnclosedPoint over(const ProofBox& box, const KnownRange& known, const PackedLeaf& leaf) const {
    return over(viewers_of(box, known), box, leaf);
  }
  // The stored albedo, over elevations; of viewers without an azimuth.
  AffineForm albedo(double theta_lo, double theta_hi, const KnownRange& known) const;
  // As a sampler computes it.
  PointValue at(const ProofPoint& point, const KnownRange& known, const PackedLeaf& leaf) const;

 private:
  // g: the point's geometry, or its image; of value_over in the frame of the function.
  AffineForm target_over(const DomainPointT<AffineForm>& point, const ShadingGeometry<AffineForm>& g,
                         const ViewerForms& v) const;
  AffineForm value_over(const DomainPointT<AffineForm>& point, const ShadingGeometry<AffineForm>& g,
                        const ViewerForms& v) const;

  EnclosedField(const PackedSampler& packed, int channels, bool turned, ExactSymmetry keeps);

  const AnyBrdf* f_ = nullptr;  // or
  const AnyFamily* family_ = nullptr;
  std::shared_ptr<const BrdfEnclosure> enclosure_;
  std::shared_ptr<const FamilyEnclosure> family_enclosure_;
  const PackedSampler& packed_;
  int channels_;
  bool turned_;  // f is evaluated where wo has no y
  EnclosedViewer viewer_;
  bool both_sides_;  // of half squares
  std::vector<ViewerImage> images_;
};

}  // namespace reflectree::detail
