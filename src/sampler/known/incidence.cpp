// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/incidence.hpp"

#include "reflectree/math/lanes.hpp"

namespace reflectree::detail {

void find_folded(const PackedViewer& viewer, Incidence& in, float sin2_theta) {
  const FoldedFrame<float> f =
      folded_frame(viewer, folded_by(viewer, in.known.x, in.known.y), min(in.known.z, 1.f), sin2_theta);
  in.wo = f.wo, in.cos_phi = f.cos_phi, in.sin_phi = f.sin_phi, in.azimuth = f.azimuth, in.side = f.side;
}

void find_albedo(const PackedViewer& viewer, Incidence& in) {
  if (!viewer.frame.isotropic()) {
    float x = in.wo.x, y = in.wo.y;
    if (viewer.turns) {
      const FoldedViewer<float> f = folded_by(viewer, in.known.x, in.known.y);
      x = f.x, y = f.y;
    }
    // In lanes, which choose by masks where floats would branch; the bits are the same.
    in.phi_o = azimuth_of(viewer.frame.symmetry, Lanes(x), Lanes(y))[0];
    in.phi_o = viewer.albedo.on_side(in.phi_o, in.azimuth);
  }
  in.albedo = viewer.family.count == 0 ? viewer.albedo.at(in.wo.z, in.phi_o)
                                       : viewer.albedo.at(in.wo.z, in.phi_o, in.coordinates);
}

}  // namespace reflectree::detail
