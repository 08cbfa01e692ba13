// SPDX-License-Identifier: Apache-2.0
// The viewers of a slab over boxes: all that a sampler knows of wo and of a family's parameters (incidence.hpp), and
// the turns from the domain's frame to the caller's.
#pragma once

#include <array>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/sampler/square/enclosed_map.hpp"

namespace reflectree::detail {

// The viewers of a slab: floats cos_theta_o of [lo, hi], phi_o, parameters as they are given.
struct KnownRange {
  float lo, hi;
  std::array<RealInterval, 1 + max_parameters> beyond{};
};
// The elevations of wo that hold them.
struct Elevations {
  double lo, hi;
};

struct ViewerForms {
  Vec3<AffineForm> wo;               // in the frame of the domain
  Vec3<AffineForm> framed;           // in the viewer's frame, folded
  AffineForm sine;                   // of theta_o
  AffineForm phi, cos_phi, sin_phi;  // its azimuth there
  AffineForm albedo;
  ParameterForms parameters, coordinates;
};

// Which of the viewers that fold to the same: turned by half a circle, and mirrored before that.
struct ViewerImage {
  bool half_turn = false, mirrored = false;
};

class EnclosedViewer {
 public:
  // turned: the function is evaluated where wo has no y.
  EnclosedViewer(const PackedViewer& viewer, bool turned);

  // The unknowns: theta_o; the azimuth, radians; of families the coordinates of the parameters.
  std::size_t axes() const { return 1 + std::size_t(azimuth_) + viewer_.family.count; }
  Elevations elevations(const KnownRange& known) const;
  // Of the unknowns but theta_o all that floats of the slab may come from.
  std::array<RealInterval, 1 + max_parameters> unknowns(const KnownRange& known) const;
  // unknown[0] is theta_o.
  ViewerForms over(const std::array<AffineForm, 2 + max_parameters>& unknown, const KnownRange& known) const;

  bool sees_azimuth() const { return azimuth_; }
  // Of a KnownRange: where parameters begin.
  std::size_t first_parameter() const { return viewer_.frame.isotropic() ? 0 : 1; }
  std::vector<ViewerImage> images(const ExactSymmetry& keeps) const;
  // What the function is evaluated at (known_geometry).
  ShadingGeometry<AffineForm> for_caller(const ShadingGeometry<AffineForm>& g, const ViewerForms& v,
                                         ViewerImage image) const;
  // The domain with the widths of the members.
  DomainForms domain_of(const Domain& domain, const ViewerForms& v) const;

 private:
  KnownViewer known_of(const ShadingGeometry<AffineForm>& g, const ViewerForms& v, ViewerImage image) const;
  bool axis_is_coordinate() const;
  Vec3<AffineForm> from_axis(const Vec3<AffineForm>& w) const;
  HalfSlopes slopes_from_axis(HalfSlopes h) const;
  const PackedViewer& viewer_;
  bool azimuth_;
};

}  // namespace reflectree::detail
