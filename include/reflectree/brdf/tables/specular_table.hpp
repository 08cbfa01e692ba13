// SPDX-License-Identifier: Apache-2.0
// A BRDF tabulated over angles about the mirror direction of wo, isotropic or not: the layout of Zemax's
// .bsdf files. What those leave open is decided in docs/decisions/0040-zemax.md.
//
// In the frame e, n x e, n, with e the direction in the surface towards the side of wo and n the normal, the
// mirror direction is s = (-sin theta_o, 0, cos theta_o). Of wi the table knows two angles about s:
//   radial   the angle between wi and s
//   azimuth  about s, 0 where wi lies from s towards n, growing from there towards n x e: counter-clockwise
//            for somebody whom s points at
// and of wo its elevation theta_o and the rotation that the sample was turned by, counter-clockwise, under a
// plane of incidence that stood still: phi_o = pi/2 - rotation. So the normal of the plane of incidence,
// wo x n, is the surface's x axis at rotation 0.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reflectree/brdf/brdf.hpp"

namespace reflectree {

// Nodes in radians, ascending. Several rotations go round: the last is the first and a turn. So do azimuths,
// unless they are mirrored in the plane of incidence.
struct SpecularAxes {
  std::vector<float> rotation, theta_o, azimuth, radial;
  bool mirrored = false;

  std::size_t size() const { return rotation.size() * theta_o.size() * azimuth.size() * radial.size(); }
  friend bool operator==(const SpecularAxes&, const SpecularAxes&) = default;
};

// f(wo, wi) in sr^-1: multilinear between nodes, and beyond the first and last node what stands there. Noise
// may leave negative entries: they are interpolated as they are and f is cut at 0. Value: float or Rgb.
template <class Value>
struct SpecularTable {
  std::string name = "table";
  SpecularAxes axes;
  std::vector<Value> values;           // [rotation][theta_o][azimuth][radial]
  std::vector<std::uint8_t> stand_in;  // as many or none: 1 where the value was not measured

  Value operator()(const ShadingGeometry<float>& g) const;
  // The same before it is cut at 0.
  Value unclipped(const ShadingGeometry<float>& g) const;
  // The share of f(wo, wi) that comes from entries which were not measured, 0 to 1.
  float unmeasured(const ShadingGeometry<float>& g) const;
  BrdfTraits traits() const;
};
extern template struct SpecularTable<float>;
extern template struct SpecularTable<Rgb>;

}  // namespace reflectree
