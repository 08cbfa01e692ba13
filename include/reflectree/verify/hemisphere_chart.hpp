// SPDX-License-Identifier: Apache-2.0
// The referee's own coordinates of the hemisphere, related to no sampler's: elevation and azimuth, both
// graded logarithmically around a centre, so that a lobe of any width and aspect there fills a good part
// of the rectangle. The azimuth opposite to the centre is graded too: a chart about the mirror direction
// serves retro-reflection as well.
//   x in [0, 4]: quarters of the azimuth; 0 and 4 at the centre, 2 opposite
//   y in [0, 2]: elevation; 0 at the normal, 1 at the centre, 2 at the horizon
// Of functions that are constant over patches: the projected disk in polar coordinates, not graded, where
// patches are rectangles and t cos_i d(solid angle) is constant in each: x from azimuth 0, y = 2 sin^2 theta_i.
#pragma once

#include "reflectree/math/cubature.hpp"
#include "reflectree/math/direction.hpp"

namespace reflectree {

class HemisphereChart {
 public:
  // centre: a unit vector above the surface.
  explicit HemisphereChart(Vec3<double> centre);
  static HemisphereChart projected_disk();

  static constexpr CubatureBox domain{0, 4, 0, 2};

  struct Point {
    Vec3<double> w;
    double jacobian;  // d(solid angle) / (dx dy)
  };
  Point direction(Vec2<double> p) const;
  Vec2<double> coordinates(Vec3<double> w) const;

 private:
  bool disk_ = false;
  Vec2<double> azimuth_;                    // unit vector of the centre in the x-y plane
  double theta_;                            // elevation of the centre
  double grade_phi_, grade_lo_, grade_hi_;  // e-folds of the three gradings
};

}  // namespace reflectree
