// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/half_angle_table.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "reflectree/brdf/tables/difference_vector.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "reflectree/math/prefetch.hpp"

namespace reflectree {
namespace {

// A position between the centres of two cells; max(0, x) turns a NaN into 0.
struct Between {
  int low, high;
  float fraction;
};
REFLECTREE_INLINE Between clamped_between(float x, int size) {
  const float y = min(max(0.f, x - 0.5f), float(size - 1));
  const int low = std::min(int(y), size - 1);
  return {low, std::min(low + 1, size - 1), y - float(low)};
}
REFLECTREE_INLINE Between wrapped_between(float x, int size) {
  const float y = min(max(0.f, x < 0.5f ? x - 0.5f + float(size) : x - 0.5f), float(size));
  const int low = std::min(int(y), size - 1);
  return {low, low + 1 == size ? 0 : low + 1, y - float(low)};
}

// Of a pair, in units of the cells.
struct Position {
  float h, d, p;
};
REFLECTREE_INLINE Position position(const HalfAngleTable& table, const ShadingGeometry<float>& g) {
  const auto [sin_h, difference] = detail::difference_vector(g);
  const float theta_h = first_quadrant_angle(sin_h, max(g.cos_theta_h, 0.f));
  const float theta_d = polar_angle(sin2_theta(difference), g.cos_theta_d);
  const float phi_d = angle_of(difference.y, difference.x);
  const float period = table.reciprocal ? pi : 2 * pi;
  return {float(table.n_h) * sqrt(theta_h * (2.f / pi)), float(table.n_d) * theta_d * (2.f / pi),
          float(table.n_p) * (phi_d < 0 ? phi_d + period : phi_d) / period};
}

REFLECTREE_INLINE const float* cell(const HalfAngleTable& table, int h, int d, int p) {
  return table.rgb.data() +
         ((std::size_t(h) * std::size_t(table.n_d) + std::size_t(d)) * std::size_t(table.n_p) +
          std::size_t(p)) *
             3;
}

const float* nearest_cell(const HalfAngleTable& table, const Position& at) {
  const auto index = [](float v, int size) { return std::min(int(min(max(0.f, v), float(size))), size - 1); };
  return cell(table, index(at.h, table.n_h), index(at.d, table.n_d), index(at.p, table.n_p));
}

// The eight centres around a pair.
struct Corners {
  Between h, d, p;
};
REFLECTREE_INLINE Corners corners(const HalfAngleTable& table, const Position& at) {
  return {clamped_between(at.h, table.n_h), clamped_between(at.d, table.n_d),
          wrapped_between(at.p, table.n_p)};
}

// Of a channel: the weights of the measured corners and of the others, and the sum of weighted values.
struct Measured {
  float weight = 0, missing = 0, sum = 0;
};
Measured measured(const HalfAngleTable& table, const Corners& at, int channel) {
  Measured m;
  for (const bool high_h : {false, true}) {
    for (const bool high_d : {false, true}) {
      for (const bool high_p : {false, true}) {
        const auto share = [](const Between& b, bool high) { return high ? b.fraction : 1 - b.fraction; };
        const auto index = [](const Between& b, bool high) { return high ? b.high : b.low; };
        const float v = cell(table, index(at.h, high_h), index(at.d, high_d), index(at.p, high_p))[channel];
        const float weight = share(at.h, high_h) * share(at.d, high_d) * share(at.p, high_p);
        if (v >= 0) {
          m.weight += weight, m.sum += weight * v;
        } else {
          m.missing += weight;
        }
      }
    }
  }
  return m;
}

// The measured corners alone, where one is missing.
Rgb bridged(const HalfAngleTable& table, const Corners& c, Rgb sum) {
  const auto mean = [&](int k) {
    const Measured m = measured(table, c, k);
    if (!(m.missing > 0)) return channel_value(sum, k);
    return m.weight > 0 ? m.sum / m.weight : 0;
  };
  return {mean(0), mean(1), mean(2)};
}

REFLECTREE_INLINE Rgb value_of(const float* nearest) {
  return {max(nearest[0], 0.f), max(nearest[1], 0.f), max(nearest[2], 0.f)};
}

REFLECTREE_INLINE Rgb value_of(const HalfAngleTable& table, const Corners& c) {
  Rgb sum;
  std::uint32_t bits = 0;  // the sign bit is set where a corner was not measured
  const auto add = [&](int ih, int id, float weight) {
    const float *a = cell(table, ih, id, c.p.low), *b = cell(table, ih, id, c.p.high);
    const auto mix = [&](int k) {
      bits |= std::bit_cast<std::uint32_t>(a[k]) | std::bit_cast<std::uint32_t>(b[k]);
      return weight * linear_mix(c.p.fraction, a[k], b[k]);
    };
    sum = sum + Rgb{mix(0), mix(1), mix(2)};
  };
  add(c.h.low, c.d.low, (1 - c.h.fraction) * (1 - c.d.fraction));
  add(c.h.low, c.d.high, (1 - c.h.fraction) * c.d.fraction);
  add(c.h.high, c.d.low, c.h.fraction * (1 - c.d.fraction));
  add(c.h.high, c.d.high, c.h.fraction * c.d.fraction);
  return bits >> 31U == 0 ? sum : bridged(table, c, sum);
}

}  // namespace

Rgb HalfAngleTable::operator()(const ShadingGeometry<float>& g) const {
  const Position at = position(*this, g);
  if (lookup == TableLookup::nearest) return value_of(nearest_cell(*this, at));
  return value_of(*this, corners(*this, at));
}

void HalfAngleTable::eval(std::span<const Direction> wo, std::span<const Direction> wi,
                          std::span<float> out) const {
  std::vector<ShadingGeometry<float>> geometry;
  geometry.reserve(wo.size());
  for (std::size_t i = 0; i < wo.size(); ++i) geometry.push_back(shading_geometry(wo[i], wi[i]));
  eval(geometry, out);
}

void HalfAngleTable::eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
  constexpr std::size_t block = 16;
  for (std::size_t begin = 0; begin < geometry.size(); begin += block) {
    const std::size_t end = std::min(begin + block, geometry.size());
    Corners corner[block];
    const float* nearest[block];
    bool above[block];
    for (std::size_t i = begin; i < end; ++i) {
      const ShadingGeometry<float>& g = geometry[i];
      const std::size_t k = i - begin;
      above[k] = g.cos_theta_o > 0 && g.cos_theta_i > 0;
      if (!above[k]) continue;
      const Position at = position(*this, g);
      if (lookup == TableLookup::nearest) {
        prefetch(nearest[k] = nearest_cell(*this, at));
        continue;
      }
      const Corners& c = corner[k] = corners(*this, at);
      for (const int h : {c.h.low, c.h.high})
        prefetch(cell(*this, h, c.d.low, c.p.low)), prefetch(cell(*this, h, c.d.high, c.p.low));
    }
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t k = i - begin;
      Rgb value;
      if (above[k])
        value = lookup == TableLookup::nearest ? value_of(nearest[k]) : value_of(*this, corner[k]);
      out[3 * i] = value.r, out[3 * i + 1] = value.g, out[3 * i + 2] = value.b;
    }
  }
}

Rgb HalfAngleTable::unmeasured(const ShadingGeometry<float>& g) const {
  const Position at = position(*this, g);
  if (lookup == TableLookup::nearest) {
    const float* v = nearest_cell(*this, at);
    return {v[0] < 0 ? 1.f : 0.f, v[1] < 0 ? 1.f : 0.f, v[2] < 0 ? 1.f : 0.f};
  }
  const Corners c = corners(*this, at);
  const auto share = [&](int k) {
    const Measured m = measured(*this, c, k);
    return m.missing / (m.missing + m.weight);
  };
  return {share(0), share(1), share(2)};
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
