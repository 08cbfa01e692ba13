// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "reflectree/brdf/brdf.hpp"

namespace reflectree {

// The parameters of one colour channel.
struct SgdChannel {
  float kd = 0, ks = 0;                             // diffuse and specular weight
  float alpha = 0.1f, p = 1, kappa = 1;             // distribution of normals: width, tail, scale
  float f0 = 1, f1 = 0;                             // Fresnel
  float lambda = 0, log_c = 0, k = 1, theta_0 = 0;  // masking; log_c = ln c: c itself overflows a float
};

// Masking vanishes towards grazing like the cosine that it is divided by: a float angle near pi/2 has steps
// of 1e-7, which at 89.999 deg are jumps of 1 % in f. (Boxes: enclosed_fits.hpp.)
template <class T>
struct SgdElevation {
  using Angle = T;
};
template <>
struct SgdElevation<float> {
  using Angle = double;
};
template <class T>
typename SgdElevation<T>::Angle sgd_elevation(Vec3<T> w) {
  using Angle = typename SgdElevation<T>::Angle;
  const Angle x(w.x), y(w.y);
  return atan2(sqrt(x * x + y * y), Angle(w.z));
}

// e^x for x kept within [-80, 80]: results below are as good as 0, and subnormal floats are slow.
template <class T>
T sgd_exp(T x) {
  return exp(clamp(x, T(-80.f), T(80.f)));
}

// Before it is cut to [0, 1]: 1 + lambda (1 - exp(c max(theta - theta_0, 0)^k)), the power taken as an
// exponential; beyond exp(4.4) = 81 the outer one has long brought G to 0 and would soon overflow.
template <class T>
T sgd_uncut_masking(const SgdChannel& c, T theta) {
  const T x = max(theta - T(c.theta_0), T(1e-30f));
  const T power = sgd_exp(min(T(c.log_c) + T(c.k) * log(x), T(4.4f)));
  return T(1) + T(c.lambda) * (T(1) - exp(power));
}
template <class T>
T sgd_masking(const SgdChannel& c, T theta) {
  return clamp(sgd_uncut_masking(c, theta), T(0), T(1));
}

// Shifted Gamma distribution: f = (kd + ks F D G(theta_o) G(theta_i) / (cos_o cos_i)) / pi per channel.
// Bagher, Soler, Holzschuch 2012, "Accurate fitting of measured reflectances using a Shifted Gamma
// micro-facet distribution", eqs. 8-12. The fitted Fresnel term may turn negative; f is cut at 0,
// the term is not.
struct Sgd {
  std::string name = "sgd";
  SgdChannel channels[3];

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const RgbT<T> f = unclipped(g);
    return {max(f.r, T(0)), max(f.g, T(0)), max(f.b, T(0))};
  }
  // The same before it is cut at 0.
  template <class T>
  RgbT<T> unclipped(const ShadingGeometry<T>& g) const {
    const T cos2_h = max(sqr(g.cos_theta_h), T(1e-12f));
    const Angle<T> theta_o = sgd_elevation(g.wo), theta_i = sgd_elevation(g.wi);
    const Common<T> common{sin2_theta(g.wh) / cos2_h,
                           T(-2) * log(cos2_h),
                           power5(T(1) - g.cos_theta_d),
                           g.cos_theta_d,
                           theta_o,
                           theta_i,
                           T(1) / (g.cos_theta_o * g.cos_theta_i)};
    return {value(channels[0], common), value(channels[1], common), value(channels[2], common)};
  }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.isotropic_by_formula = true;
    traits.name = name;
    return traits;
  }

 private:
  template <class T>
  using Angle = typename SgdElevation<T>::Angle;
  template <class T>
  struct Common {
    T tan2_h, log_inverse_cos4_h, fresnel_power, cos_theta_d;
    Angle<T> theta_o, theta_i;
    T inverse_cosines;
  };
  template <class T>
  static T power5(T x) {
    return sqr(sqr(x)) * x;
  }
  // D = kappa exp(-x) / (pi x^p cos^4 theta_h), x = alpha + tan^2 theta_h / alpha.
  template <class T>
  static T distribution(const SgdChannel& c, const Common<T>& common) {
    const T x = T(c.alpha) + common.tan2_h / T(c.alpha);
    return T(c.kappa) / pi_v<T> * sgd_exp(common.log_inverse_cos4_h - x - T(c.p) * log(x));
  }
  template <class T>
  static T value(const SgdChannel& c, const Common<T>& common) {
    const T fresnel = T(c.f0) - common.cos_theta_d * T(c.f1) + (T(1) - T(c.f0)) * common.fresnel_power;
    const T facets = fresnel * distribution(c, common) * T(sgd_masking(c, common.theta_o)) *
                     T(sgd_masking(c, common.theta_i)) * common.inverse_cosines;
    return (T(c.kd) + T(c.ks) * facets) / pi_v<T>;
  }
};

}  // namespace reflectree
