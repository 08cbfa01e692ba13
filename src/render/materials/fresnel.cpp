// SPDX-License-Identifier: Apache-2.0
#include "fresnel.hpp"

#include <cmath>

#include "reflectree/brdf/models/fresnel.hpp"

namespace reflectree::render {

Dielectric fresnel(float cos_theta, float eta) {
  const float relative = cos_theta >= 0 ? eta : 1 / eta, c = std::abs(cos_theta), n2 = relative * relative;
  const float root2 = n2 + c * c - 1;
  if (!(root2 > 0)) return {1, 0, relative};
  const float root = std::sqrt(root2), t = root / relative;
  return {fresnel_dielectric(c, root, n2), cos_theta >= 0 ? -t : t, relative};
}

Rgb fresnel_conductor(float cos_theta, Rgb eta, Rgb k) {
  if (eta == Rgb{} && k == Rgb{}) return {1, 1, 1};
  const auto of = [c = std::abs(cos_theta)](float n, float absorption) {
    return reflectree::fresnel_conductor(c, n, absorption);
  };
  return {of(eta.r, k.r), of(eta.g, k.g), of(eta.b, k.b)};
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
