// SPDX-License-Identifier: Apache-2.0
// Samplers known to be right by a page of algebra: what the checks must pass, and their twins start from.
#pragma once

#include <thread>
#include <vector>

#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/low_smooth.hpp"
#include "reflectree/host.hpp"
#include "reflectree/math/square_maps.hpp"
#include "reflectree/verify/erased.hpp"

namespace reflectree {

inline Direction direction_at(double theta_deg, double phi_deg = 0) {
  const double theta = theta_deg * pi_v<double> / 180, phi = phi_deg * pi_v<double> / 180;
  const double s = std::sin(theta);
  return {float(s * std::cos(phi)), float(s * std::sin(phi)), float(std::sin(pi_v<double> / 2 - theta))};
}

// pdf = cos_i / pi, for any function: exact for Lambert, one-shot with varying weight for others.
template <Brdf F>
struct CosineSampler {
  using Value = ValueOf<F>;
  F f;
  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    const double r = std::sqrt(to_unit_double(u())), phi = 2 * pi_v<double> * to_unit_double(u());
    const Direction wi =
        disk_to_hemisphere_projected(Vec2<float>{float(r * std::cos(phi)), float(r * std::sin(phi))});
    if (!(wi.z > 0)) return std::nullopt;
    return DirectionSample<Value>{wi, wi.z / pi, scaled_value(eval(f, wo, wi), pi), sample_reflection};
  }
  float pdf(Direction, Direction wi) const { return max(wi.z, 0.f) / pi; }
};

// Exact for LowSmooth with c = 1 and f0 = 1: around the centre -wo the lobe 1 / (1 + b d^2) has the CDF
// log(1 + b d^2) in d; points outside the unit disk are drawn again. The albedo is known in closed form.
struct LowSmoothSampler {
  using Value = Rgb;
  LowSmooth f;
  template <RandomBits U>
  std::optional<DirectionSample<Rgb>> sample(Direction wo, U& u) const {
    const double b = double(f.b);
    for (;;) {
      const double d = std::sqrt(std::expm1(to_unit_double(u()) * std::log1p(4 * b)) / b);
      const double phi = 2 * pi_v<double> * to_unit_double(u());
      const double x = d * std::cos(phi) - double(wo.x), y = d * std::sin(phi) - double(wo.y);
      const double z2 = 1 - x * x - y * y;
      if (!(z2 > 1e-12)) continue;
      const Direction wi{float(x), float(y), float(std::sqrt(z2))};
      const double lobe = 1 / (1 + b * d * d);
      const double p = lobe / low_smooth_albedo(1, b, double(wo.z)) * std::sqrt(z2);
      return DirectionSample<Rgb>{wi, float(p), scaled_value(f.a, float(lobe * std::sqrt(z2) / p)),
                                  sample_reflection};
    }
  }
  float pdf(Direction wo, Direction wi) const {
    if (!(wi.z > 0)) return 0;
    const double d2 = sqr(double(wo.x) + double(wi.x)) + sqr(double(wo.y) + double(wi.y));
    return float(double(wi.z) / (1 + double(f.b) * d2) / low_smooth_albedo(1, double(f.b), double(wo.z)));
  }
};

inline LowSmooth low_smooth(float b) { return {{1.f, 0.5f, 0.25f}, b, 1, {1.f, 1.f, 1.f}}; }

// A host with three threads, in an order of its own.
inline Host threaded_host() {
  Host host;
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::vector<std::thread> threads;
    for (std::size_t t = 3; t-- > 0;) threads.emplace_back([&, t] { body(n * t / 3, n * (t + 1) / 3); });
    for (auto& thread : threads) thread.join();
  };
  return host;
}

}  // namespace reflectree
