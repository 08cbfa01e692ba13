// SPDX-License-Identifier: Apache-2.0
#include "microfacet.hpp"

#include <cmath>

#include "fresnel.hpp"

namespace reflectree::render {

namespace {

constexpr float inverse_root_pi = .564189584f;

// A visible slope along wo, in units of alpha: its density goes as max(0, cos - x sin) exp(-x^2). The
// integral up to x, (1 + erf x) / 2 cos + exp(-x^2) sin / (2 sqrt pi), grows up to x = cot theta; Newton's
// steps are kept inside a bracket.
float visible_slope(float cosine, float sine, float u) {
  const auto integral = [&](float x) {
    return .5f * (1 + std::erf(x)) * cosine + .5f * inverse_root_pi * std::exp(-x * x) * sine;
  };
  float low = -5, high = sine > 0 ? min(5.f, cosine / sine) : 5;
  if (high <= low) return low;
  const float base = integral(low), goal = base + u * (integral(high) - base);
  float x = (low + high) / 2;
  for (int i = 0; i < 24; ++i) {
    const float error = integral(x) - goal;
    (error > 0 ? high : low) = x;
    const float slope = (cosine - x * sine) * inverse_root_pi * std::exp(-x * x);
    const float next = x - error / slope;
    const float safe = next > low && next < high ? next : (low + high) / 2;
    if (std::abs(safe - x) < 1e-6f) return safe;
    x = safe;
  }
  return x;
}

Direction visible_ggx(Direction v, float u1, float u2) {
  const float across = v.x * v.x + v.y * v.y;
  const Direction t1 = across > 0 ? (1 / std::sqrt(across)) * Direction{-v.y, v.x, 0} : Direction{1, 0, 0};
  const Direction t2 = cross(v, t1);
  const float r = std::sqrt(u1), phi = 2 * pi * u2, p1 = r * std::cos(phi), s = (1 + v.z) / 2;
  const float p2 = (1 - s) * std::sqrt(max(0.f, 1 - p1 * p1)) + s * r * std::sin(phi);
  return p1 * t1 + p2 * t2 + std::sqrt(max(0.f, 1 - p1 * p1 - p2 * p2)) * v;
}

}  // namespace

Microfacets::Microfacets(Roughness roughness) : roughness_(roughness) {
  roughness_.alpha = max(roughness_.alpha, 1e-4f);
}

float Microfacets::d(Direction wh) const {
  if (!(wh.z > 0)) return 0;
  const float a2 = roughness_.alpha * roughness_.alpha, c2 = wh.z * wh.z;
  const float tan2 = (wh.x * wh.x + wh.y * wh.y) / c2;
  if (roughness_.kind == Roughness::Kind::beckmann) return std::exp(-tan2 / a2) / (pi * a2 * c2 * c2);
  return 1 / (pi * a2 * c2 * c2 * (1 + tan2 / a2) * (1 + tan2 / a2));
}

float Microfacets::g1(Direction w) const {
  if (!(w.z > 0)) return 0;
  const float tangent = std::sqrt(w.x * w.x + w.y * w.y) / w.z;
  if (roughness_.kind == Roughness::Kind::ggx) {
    return 2 / (1 + std::sqrt(1 + roughness_.alpha * roughness_.alpha * tangent * tangent));
  }
  if (!(tangent > 1e-7f)) return 1;
  const float a = 1 / (roughness_.alpha * tangent);
  return a > 5 ? 1 : 2 / (1 + std::erf(a) + inverse_root_pi * std::exp(-a * a) / a);
}

float Microfacets::pdf(Direction wo, Direction wh) const {
  if (!roughness_.sample_visible) return d(wh) * wh.z;
  return d(wh) * g1(wo) * max(0.f, dot(wo, wh)) / wo.z;
}

Direction Microfacets::sample(Direction wo, float u1, float u2) const {
  const float alpha = roughness_.alpha;
  const bool ggx = roughness_.kind == Roughness::Kind::ggx;
  if (!roughness_.sample_visible) {
    const float tan2 = alpha * alpha * (ggx ? u1 / (1 - u1) : -std::log(1 - u1));
    const float c = 1 / std::sqrt(1 + tan2), s = std::sqrt(max(0.f, 1 - c * c)), phi = 2 * pi * u2;
    return {s * std::cos(phi), s * std::sin(phi), c};
  }
  const Direction v = normalize(Direction{alpha * wo.x, alpha * wo.y, wo.z});
  if (ggx) {
    const Direction h = visible_ggx(v, u1, u2);
    return normalize(Direction{alpha * h.x, alpha * h.y, max(1e-9f, h.z)});
  }
  const float sine = std::sqrt(max(0.f, 1 - v.z * v.z));
  const float along = visible_slope(v.z, sine, u1);
  // The other slope: a Gaussian of variance 1/2, by bisection of erf, monotone in u2.
  float low = -5, high = 5;
  for (int i = 0; i < 30; ++i) {
    const float middle = (low + high) / 2;
    (.5f * (1 + std::erf(middle)) < u2 ? low : high) = middle;
  }
  const float across = (low + high) / 2;
  const float c = sine > 0 ? v.x / sine : 1, s = sine > 0 ? v.y / sine : 0;
  return normalize(Direction{-alpha * (c * along - s * across), -alpha * (s * along + c * across), 1});
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
