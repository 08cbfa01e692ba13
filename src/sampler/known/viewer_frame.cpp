// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/viewer_frame.hpp"

namespace reflectree {

const char* name_of(ViewerSymmetry symmetry) {
  switch (symmetry) {
    case ViewerSymmetry::isotropic:
      return "isotropic";
    case ViewerSymmetry::two_planes:
      return "two mirror planes";
    case ViewerSymmetry::one_plane:
      return "one mirror plane";
    case ViewerSymmetry::half_turn:
      return "half turn";
    case ViewerSymmetry::none:
      return "no symmetry";
  }
  return "unknown";
}

float azimuth_span(ViewerSymmetry symmetry) {
  switch (symmetry) {
    case ViewerSymmetry::isotropic:
      return 0;
    case ViewerSymmetry::two_planes:
      return 0.5f * pi;
    case ViewerSymmetry::one_plane:
    case ViewerSymmetry::half_turn:
      return pi;
    case ViewerSymmetry::none:
      break;
  }
  return 2 * pi;
}

}  // namespace reflectree
