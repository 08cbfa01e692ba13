// SPDX-License-Identifier: Apache-2.0
// Incident light from all around, and what is left of it after an average over rotations.
//
// Let X = w L(R wi) be one sample of the reflected radiance, R a rotation uniform in SO(3): a surface of any
// orientation. For two independent samples the variance is (X - X')^2 / 2 in the mean, and the average over R
// can be taken in closed form:
//   <Var X> = E[ <L^2> (|w|^2 + |w'|^2) / 2 - w.w' C(angle(wi, wi')) ],
//   C(g) = <L(R a) L(R b)>, angle(a, b) = g.
// So a light needs only its mean square and its autocorrelation; a sun that no random rotation would ever hit
// is as easy as a sky.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "reflectree/math/direction.hpp"

namespace reflectree::study {

// Radiance in latitude and longitude: row 0 at the zenith +z, columns in azimuth; constant in a pixel.
struct LatLong {
  int width = 0, height = 0;
  std::vector<float> radiance;
  float at(Direction w) const;
};

struct Illumination {
  std::string name;
  LatLong map;
  double mean = 0, mean_square = 0;  // over the sphere
  // C(g) by linear interpolation in the chord 2 sin(g / 2), whose nodes grow geometrically.
  std::vector<double> correlation;
  double correlation_at(double cos_angle) const;
};

// Throws Error for a map that is empty, negative, not finite or black.
Illumination make_illumination(std::string name, LatLong map);

// A disk of 5 degrees in the dark; a clouded sky over grey ground, blurred at the horizon; the same sky with
// a sun of 0.27 degrees that gives four fifths of the light.
std::vector<Illumination> procedural_illuminations();

}  // namespace reflectree::study
