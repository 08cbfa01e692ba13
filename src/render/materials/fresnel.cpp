// SPDX-License-Identifier: Apache-2.0
#include "fresnel.hpp"

#include <cmath>

#include "reflectree/math/scalar.hpp"

namespace reflectree::render {

Dielectric fresnel(float cos_theta, float eta) {
  const float relative = cos_theta >= 0 ? eta : 1 / eta, c = std::abs(cos_theta);
  const float sin2_t = (1 - c * c) / (relative * relative);
  if (sin2_t >= 1) return {1, 0, relative};
  const float t = std::sqrt(1 - sin2_t);
  const float s = (c - relative * t) / (c + relative * t), p = (relative * c - t) / (relative * c + t);
  return {(s * s + p * p) / 2, cos_theta >= 0 ? -t : t, relative};
}

namespace {

float conductor(float c, float eta, float k) {
  const float c2 = c * c, s2 = 1 - c2, t0 = eta * eta - k * k - s2;
  const float a2b2 = std::sqrt(t0 * t0 + 4 * eta * eta * k * k);
  const float a = std::sqrt(max(0.f, (a2b2 + t0) / 2));
  const float s = (a2b2 + c2 - 2 * a * c) / (a2b2 + c2 + 2 * a * c);
  const float p = s * (c2 * a2b2 + s2 * s2 - 2 * a * c * s2) / (c2 * a2b2 + s2 * s2 + 2 * a * c * s2);
  return (s + p) / 2;
}

}  // namespace

Rgb fresnel_conductor(float cos_theta, Rgb eta, Rgb k) {
  if (eta == Rgb{} && k == Rgb{}) return {1, 1, 1};
  const float c = std::abs(cos_theta);
  return {conductor(c, eta.r, k.r), conductor(c, eta.g, k.g), conductor(c, eta.b, k.b)};
}

float fresnel_diffuse(float eta) {
  constexpr int n = 4096;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double mu = (i + .5) / n;
    sum += 2 * mu * double(fresnel(float(mu), eta).reflectance) / n;
  }
  return float(sum);
}

}  // namespace reflectree::render
