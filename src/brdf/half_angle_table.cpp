// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/half_angle_table.hpp"

#include <algorithm>

#include "reflectree/brdf/difference_vector.hpp"
#include "reflectree/brdf/fast_trigonometry.hpp"

namespace reflectree {
namespace {

// A position between the centres of two cells; max(0, x) turns a NaN into 0.
struct Between {
  int low, high;
  float fraction;
};
Between clamped_between(float x, int size) {
  const float y = min(max(0.f, x - 0.5f), float(size - 1));
  const int low = std::min(int(y), size - 1);
  return {low, std::min(low + 1, size - 1), y - float(low)};
}
Between wrapped_between(float x, int size) {
  const float y = min(max(0.f, x < 0.5f ? x - 0.5f + float(size) : x - 0.5f), float(size));
  const int low = std::min(int(y), size - 1);
  return {low, low + 1 == size ? 0 : low + 1, y - float(low)};
}

}  // namespace

Rgb HalfAngleTable::operator()(const ShadingGeometry<float>& g) const {
  const auto [sin_h, difference] = detail::difference_vector(g);
  const float theta_h = detail::first_quadrant_angle(sin_h, max(g.cos_theta_h, 0.f));
  const float theta_d = detail::polar_angle(sin2_theta(difference), g.cos_theta_d);
  const float phi_d = detail::angle(difference.y, difference.x);

  const float x = float(n_h) * sqrt(theta_h * (2.f / pi));
  const float y = float(n_d) * theta_d * (2.f / pi);
  const float period = reciprocal ? pi : 2 * pi;
  const float z = float(n_p) * (phi_d < 0 ? phi_d + period : phi_d) / period;
  const auto cell = [this](int h, int d, int p) {
    return rgb.data() +
           ((std::size_t(h) * std::size_t(n_d) + std::size_t(d)) * std::size_t(n_p) + std::size_t(p)) * 3;
  };
  if (lookup == TableLookup::nearest) {
    const auto index = [](float v, int size) {
      return std::min(int(min(max(0.f, v), float(size))), size - 1);
    };
    const float* v = cell(index(x, n_h), index(y, n_d), index(z, n_p));
    return {v[0], v[1], v[2]};
  }
  const Between h = clamped_between(x, n_h), d = clamped_between(y, n_d), p = wrapped_between(z, n_p);
  Rgb sum;
  const auto add = [&](int ih, int id, float weight) {
    const float *a = cell(ih, id, p.low), *b = cell(ih, id, p.high);
    const auto mix = [&](int c) { return weight * lerp(p.fraction, a[c], b[c]); };
    sum = sum + Rgb{mix(0), mix(1), mix(2)};
  };
  add(h.low, d.low, (1 - h.fraction) * (1 - d.fraction));
  add(h.low, d.high, (1 - h.fraction) * d.fraction);
  add(h.high, d.low, h.fraction * (1 - d.fraction));
  add(h.high, d.high, h.fraction * d.fraction);
  return sum;
}

BrdfTraits HalfAngleTable::traits() const {
  BrdfTraits traits;
  traits.isotropic_by_formula = true;
  traits.name = name;
  for (int d = 0; d < n_d && lookup == TableLookup::linear; ++d) {
    traits.theta_d_knots.push_back(0.5f * pi * (float(d) + 0.5f) / float(n_d));
  }
  return traits;
}

DirectionPair<float> cell_centre(const HalfAngleTable& table, int h, int d, int p) {
  const auto centre = [](int i, int size) { return (double(i) + 0.5) / double(size); };
  constexpr double right_angle = 0.5 * pi_v<double>;
  const double theta_h = right_angle * sqr(centre(h, table.n_h));
  const double phi_d = (table.reciprocal ? 1 : 2) * pi_v<double> * centre(p, table.n_p);
  // The lower direction is cos theta_h cos theta_d - sin theta_h sin theta_d |cos phi_d| above the horizon.
  const double horizon = atan2(cos(theta_h), sin(theta_h) * abs(cos(phi_d)));
  const double theta_d = min(right_angle * centre(d, table.n_d), 0.99 * horizon);
  const auto pair = from_half_angle(HalfAngle<double>{theta_h, 0, theta_d, phi_d});
  const auto narrow = [](Vec3<double> w) { return Direction{float(w.x), float(w.y), float(w.z)}; };
  return {narrow(pair.wo), narrow(pair.wi)};
}

}  // namespace reflectree
