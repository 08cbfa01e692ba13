// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/specular_table.hpp"

#include <algorithm>

#include "specular_albedo.hpp"

namespace reflectree {
namespace {

using detail::between_nodes;
using detail::BetweenNodes;
using detail::wrapped;

// The sixteen entries around a pair.
struct Corners {
  BetweenNodes rotation, theta_o, azimuth, radial;
};
Corners corners(const SpecularAxes& axes, const ShadingGeometry<float>& g) {
  const float sin_o = sqrt(sin2_theta(g.wo)), inverse = 1.f / max(sin_o, 1e-30f);
  const float cos_phi = select(sin_o > 0.f, g.wo.x * inverse, 1.f), sin_phi = g.wo.y * inverse;
  // wi in the frame e, n x e, n; then about the mirror direction.
  const float along = cos_phi * g.wi.x + sin_phi * g.wi.y, y = cos_phi * g.wi.y - sin_phi * g.wi.x;
  const float x = g.cos_theta_o * along + sin_o * g.wi.z, z = g.cos_theta_o * g.wi.z - sin_o * along;
  const float azimuth = angle_of(y, x);
  Corners c;
  c.rotation = detail::rotation_of(axes, cos_phi, sin_phi);
  c.theta_o = between_nodes(axes.theta_o, polar_angle(sin2_theta(g.wo), g.cos_theta_o));
  c.azimuth =
      between_nodes(axes.azimuth, axes.mirrored ? abs(azimuth) : wrapped(azimuth, axes.azimuth.front()));
  c.radial = between_nodes(axes.radial, angle_of(sqrt(x * x + y * y), z));
  return c;
}

// The mean of the entries, weighted by how near they are.
template <class Entry>
auto mix(const SpecularAxes& axes, const Corners& c, const std::vector<Entry>& entries) {
  using Sum = decltype(1.f * entries[0]);
  Sum sum{};
  for (const bool high_r : {false, true}) {
    for (const bool high_t : {false, true}) {
      for (const bool high_a : {false, true}) {
        const auto share = [](const BetweenNodes& b, bool high) {
          return high ? b.fraction : 1 - b.fraction;
        };
        const auto index = [](const BetweenNodes& b, bool high) { return high ? b.high : b.low; };
        const float weight = share(c.rotation, high_r) * share(c.theta_o, high_t) * share(c.azimuth, high_a);
        const std::size_t slice = index(c.rotation, high_r) * axes.theta_o.size() + index(c.theta_o, high_t);
        const std::size_t row = slice * axes.azimuth.size() + index(c.azimuth, high_a);
        const Entry* entry = entries.data() + row * axes.radial.size();
        sum = sum + (weight * (1 - c.radial.fraction)) * entry[c.radial.low] +
              (weight * c.radial.fraction) * entry[c.radial.high];
      }
    }
  }
  return sum;
}

float clipped(float v) { return max(v, 0.f); }
Rgb clipped(const Rgb& v) { return {max(v.r, 0.f), max(v.g, 0.f), max(v.b, 0.f)}; }

}  // namespace

template <class Value>
Value SpecularTable<Value>::operator()(const ShadingGeometry<float>& g) const {
  return clipped(unclipped(g));
}

template <class Value>
Value SpecularTable<Value>::unclipped(const ShadingGeometry<float>& g) const {
  return mix(axes, corners(axes, g), values);
}

template <class Value>
float SpecularTable<Value>::unmeasured(const ShadingGeometry<float>& g) const {
  return stand_in.empty() ? 0 : mix(axes, corners(axes, g), stand_in);
}

template <class Value>
BrdfTraits SpecularTable<Value>::traits() const {
  BrdfTraits traits;
  traits.name = name;
  traits.isotropic = traits.isotropic_by_formula = axes.rotation.size() == 1;
  traits.theta_o_knots = axes.theta_o;
  if (!traits.isotropic) {
    AzimuthKnots all{pi / 2, {}};
    for (const float rotation : axes.rotation) all.phi_o.push_back(pi / 2 - rotation);
    traits.phi_o_knots.push_back(std::move(all));
    // Where entries are not negative f is nowhere cut, and its integral is linear in them.
    if constexpr (std::is_same_v<Value, float>) {
      if (std::none_of(values.begin(), values.end(), [](float v) { return v < 0; }))
        traits.albedo = detail::specular_albedo(axes, values);
    }
  }
  return traits;
}

template struct SpecularTable<float>;
template struct SpecularTable<Rgb>;

}  // namespace reflectree
