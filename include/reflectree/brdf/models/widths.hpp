// SPDX-License-Identifier: Apache-2.0
// Parameters that models of anisotropic surfaces share.
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"

namespace reflectree {

// Microfacet widths along x and y; one number stands for both. Numbers are floats, or, where the widths of a family
// vary over boxes (enclosure.hpp), forms: these are round where they are the same form.
template <class Number>
struct WidthsOf {
  Number x{}, y{};
  constexpr WidthsOf(Number both) : x(both), y(both) {}
  constexpr WidthsOf(Number along_x, Number along_y) : x(along_x), y(along_y) {}
  constexpr bool round() const { return x == y; }
};
using Widths = WidthsOf<float>;

// The azimuth, in degrees, of the x axis of a model's own frame in the surface's.
struct Azimuth {
  float degrees = 0;
  float cosine = 1, sine = 0;
  constexpr Azimuth() = default;
  Azimuth(float the_degrees)
      : degrees(the_degrees),
        cosine(the_degrees == 0 ? 1.f : float(std::cos(double(the_degrees) * pi_v<double> / 180))),
        sine(the_degrees == 0 ? 0.f : float(std::sin(double(the_degrees) * pi_v<double> / 180))) {}
};

// w in the frame of the model.
template <class T>
Vec3<T> in_frame_of(const Azimuth& azimuth, const Vec3<T>& w) {
  if (azimuth.degrees == 0) return w;
  const T c = T(azimuth.cosine), s = T(azimuth.sine);
  return {c * w.x + s * w.y, c * w.y - s * w.x, w.z};
}

// (x / alpha_x)^2 + (y / alpha_y)^2; of the half vector in the frame of the model. (Boxes know more of it:
// enclosure.hpp.)
template <class T, class N>
T sin2_by_widths(const Vec3<T>& w, const WidthsOf<N>& alpha) {
  return sqr(w.x / T(alpha.x)) + sqr(w.y / T(alpha.y));
}
template <class T, class N>
T sin2_by_widths(const ShadingGeometry<T>& g, const WidthsOf<N>& alpha, const Azimuth& phi) {
  const T sin2 = sin2_by_widths(in_frame_of(phi, g.wh), alpha);
  if constexpr (requires { g.slopes; }) {
    if (phi.degrees == 0) return sin2_of_slopes(g, T(alpha.x), T(alpha.y), sin2);
  }
  return sin2;
}

}  // namespace reflectree
