// SPDX-License-Identifier: Apache-2.0
#include "microfacet.hpp"

#include <cmath>

#include "fresnel.hpp"
#include "reflectree/brdf/models/cook_torrance.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "visible_slope.hpp"

namespace reflectree::render {

namespace {

Direction visible_ggx(Direction v, float u1, float u2) {
  const float across = v.x * v.x + v.y * v.y;
  const Direction t1 = across > 0 ? (1 / std::sqrt(across)) * Direction{-v.y, v.x, 0} : Direction{1, 0, 0};
  const Direction t2 = cross(v, t1);
  const auto [x, y] = on_circle(u2);
  const float r = std::sqrt(u1), p1 = r * x, s = (1 + v.z) / 2;
  const float p2 = (1 - s) * std::sqrt(max(0.f, 1 - p1 * p1)) + s * r * y;
  return p1 * t1 + p2 * t2 + std::sqrt(max(0.f, 1 - p1 * p1 - p2 * p2)) * v;
}

// 2 / (1 + erf a + exp(-a^2) / (a sqrt pi)) of a = over / under; 1 where a > 5
REFLECTREE_INLINE float beckmann_masking(float over, float under) {
  const float a = over / under;
  if (over > 5 * under) return 1;
  return 2 / (2 + exp_of_negative(-a * a) * (inverse_root_pi * (under / over) - scaled_erfc(over, under)));
}

// With two widths.
[[gnu::noinline]] float distribution(const Roughness& r, Direction wh) {
  return r.kind == Roughness::Kind::ggx ? ggx_distribution(wh, r.alpha) : beckmann_distribution(wh, r.alpha);
}

// With two widths, `under` is the projected width times the sine.
[[gnu::noinline]] float masking(Roughness::Kind kind, float over, float under) {
  return kind == Roughness::Kind::ggx ? 2 / (1 + std::sqrt(1 + sqr(under / over)))
                                      : beckmann_masking(over, under);
}

}  // namespace

Microfacets::Microfacets(Roughness roughness) : roughness_(roughness) {
  roughness_.alpha = {max(roughness_.alpha.x, 1e-4f), max(roughness_.alpha.y, 1e-4f)};
}

float Microfacets::d(Direction wh) const {
  if (!(wh.z > 0)) return 0;
  const float alpha = roughness_.alpha.x;
  if (!roughness_.alpha.round()) return distribution(roughness_, wh);
  if (roughness_.kind == Roughness::Kind::ggx) return ggx_distribution(wh, alpha);
  if (sin2_theta(wh) > 80 * sqr(alpha * wh.z)) return 0;  // spares the underflow
  return beckmann_distribution(wh, alpha, exp_of_negative);
}

float Microfacets::g1(Direction w) const {
  if (!(w.z > 0)) return 0;
  const float alpha = roughness_.alpha.x;
  if (!roughness_.alpha.round())
    return masking(roughness_.kind, w.z, std::sqrt(sqr(alpha * w.x) + sqr(roughness_.alpha.y * w.y)));
  if (roughness_.kind == Roughness::Kind::ggx) return ggx_masking(w, alpha);
  return beckmann_masking(w.z, alpha * std::sqrt(sin2_theta(w)));
}

float Microfacets::pdf(Direction wo, Direction wh, float d, float g1_o) const {
  return roughness_.sample_visible ? d * g1_o * max(0.f, dot(wo, wh)) / wo.z : d * wh.z;
}

Direction Microfacets::sample(Direction wo, float u1, float u2) const {
  const auto [alpha_x, alpha_y] = roughness_.alpha;
  const bool ggx = roughness_.kind == Roughness::Kind::ggx;
  if (!roughness_.sample_visible) {
    const float tan2 = ggx ? u1 / (1 - u1) : -std::log(1 - u1), slope = std::sqrt(tan2);
    const auto [x, y] = on_circle(u2);
    return normalize(Direction{alpha_x * slope * x, alpha_y * slope * y, 1});
  }
  const Direction v{alpha_x * wo.x, alpha_y * wo.y, wo.z};
  if (ggx) {
    const Direction h = visible_ggx(normalize(v), u1, u2);
    return normalize(Direction{alpha_x * h.x, alpha_y * h.y, max(1e-9f, h.z)});
  }
  const float sine = std::sqrt(v.x * v.x + v.y * v.y);
  const float along = visible_slope(v.z, sine, u1);
  const float across = inverse_erf(2 * u2 - 1);  // a Gaussian of variance 1/2
  const float c = sine > 0 ? v.x / sine : 1, s = sine > 0 ? v.y / sine : 0;
  return normalize(Direction{-alpha_x * (c * along - s * across), -alpha_y * (s * along + c * across), 1});
}

namespace {

// The mean of `share(wo, wh)` over a grid of visible normals.
template <class Share>
float mean_over_normals(const Microfacets& normals, float cos_theta, int resolution, const Share& share) {
  const Direction wo{std::sqrt(max(0.f, 1 - cos_theta * cos_theta)), 0, cos_theta};
  double sum = 0;
  for (int i = 0; i < resolution; ++i) {
    for (int j = 0; j < resolution; ++j) {
      const Direction wh =
          normals.sample(wo, (float(i) + .5f) / float(resolution), (float(j) + .5f) / float(resolution));
      sum += double(share(wo, wh));
    }
  }
  return float(sum / (double(resolution) * resolution));
}

}  // namespace

float rough_reflectance(const Microfacets& normals, float cos_theta, float eta, int resolution) {
  return mean_over_normals(normals, cos_theta, resolution, [&](Direction wo, Direction wh) {
    return normals.g1(reflect(wo, wh)) * fresnel(dot(wo, wh), eta).reflectance;
  });
}

float rough_transmittance(const Microfacets& normals, float cos_theta, float eta, int resolution) {
  return mean_over_normals(normals, cos_theta, resolution, [&](Direction wo, Direction wh) {
    const Dielectric f = fresnel(dot(wo, wh), eta);
    const Direction wt = (dot(wo, wh) / f.eta + f.cos_theta_t) * wh - (1 / f.eta) * wo;
    return normals.g1(-wt) * (1 - f.reflectance);
  });
}

}  // namespace reflectree::render
