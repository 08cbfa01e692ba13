// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/specular_table.hpp"

#include <algorithm>

#include "enclosed_angles.hpp"
#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/math/affine_grid.hpp"
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

// An isotropic table over boxes.
template <class Value>
class SpecularEnclosure final : public BrdfEnclosure {
 public:
  explicit SpecularEnclosure(const SpecularTable<Value>& table) : table_(table) {}

  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    using namespace enclosed_angles;
    const SpecularAxes& axes = table_.axes;
    const bool plane = g.wo.y.range.magnitude() == 0 && g.wo.x.range.lo >= 0;
    const AffineForm sin_o = plane ? g.wo.x : sqrt(sin2_theta(g.wo));
    AffineForm along = g.wi.x, y = g.wi.y;
    if (!plane) {
      const AffineForm any = AffineForm::anything_in({-1.0001, 1.0001});
      const bool known = sin_o.range.lo > 1e-6;
      const AffineForm cosine = known ? g.wo.x / sin_o : any, sine = known ? g.wo.y / sin_o : any;
      along = cosine * g.wi.x + sine * g.wi.y, y = cosine * g.wi.y - sine * g.wi.x;
    }
    const AffineForm x = g.cos_theta_o * along + sin_o * g.wi.z, z = g.cos_theta_o * g.wi.z - sin_o * along;
    const AffineForm radial = angle_above(sqrt(sqr(x) + sqr(y)), z);
    using Pieces = GridPieces<3, 100>;
    const auto axis = [](const std::vector<float>& nodes) {
      return GridAxis{int(nodes.size()), false, nodes};
    };
    const Pieces pieces({axis(axes.theta_o), axis(axes.azimuth), axis(axes.radial)},
                        {polar_angle(sin_o, g.cos_theta_o), azimuth(y, x), radial});
    return {channel(pieces, 0), channel(pieces, 1), channel(pieces, 2)};
  }

 private:
  AffineForm azimuth(const AffineForm& y, const AffineForm& x) const {
    using namespace enclosed_angles;
    if (table_.axes.mirrored) return angle_above(abs(y), x);
    // Where no direction of the box lies where the angle leaps.
    const auto first = double(table_.axes.azimuth.front());
    AffineForm angle = AffineForm::anything_in({-pi_v<double>, pi_v<double>});
    if (y.range.lo >= 0) {
      angle = angle_above(y, x);
    } else if (y.range.hi <= 0) {
      angle = -angle_above(-y, x);
    } else if (x.range.lo > 0) {
      angle = widened(atan2(y, x), angle_share);
    }
    constexpr double off = 1e-5;
    const AffineForm slack = AffineForm::anything_in({-2e-6, 2e-6});
    if (angle.range.lo > first + off && angle.range.hi < first + 2 * pi_v<double> - off) return angle + slack;
    if (angle.range.hi < first - off && angle.range.lo > first - 2 * pi_v<double> + off)
      return angle + AffineForm(2 * pi_v<double>) + slack;
    return AffineForm::anything_in({first - off, first + 2 * pi_v<double> + off});
  }
  template <class Pieces>
  AffineForm channel(const Pieces& pieces, int c) const {
    const SpecularAxes& axes = table_.axes;
    const auto value = [&](const std::array<int, 3>& i) {
      const std::size_t row = std::size_t(i[0]) * axes.azimuth.size() + std::size_t(i[1]);
      return channel_value(table_.values[row * axes.radial.size() + std::size_t(i[2])], c);
    };
    constexpr double share = 0x1p-19;
    return max(pieces.interpolated_or_ranged(value, share), AffineForm(0.f));
  }

  SpecularTable<Value> table_;
};

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
  if (traits.isotropic) traits.enclosure = std::make_shared<SpecularEnclosure<Value>>(*this);
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
