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

// A table over boxes; `known`: coordinates of wo that it knows, theta_o, and the rotation of anisotropic ones.
template <class Value, std::size_t known>
class SpecularEnclosure final : public BrdfEnclosure {
 public:
  explicit SpecularEnclosure(const SpecularTable<Value>& table) : table_(table) {}

  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    using namespace enclosed_angles;
    const AffineForm sin_o = sin_theta_o(g);
    const Vec2<AffineForm> wi = in_plane_of_wo(g, sin_o);
    const AffineForm x = g.cos_theta_o * wi.x + sin_o * g.wi.z, z = g.cos_theta_o * g.wi.z - sin_o * wi.x;
    const AffineForm theta_o = polar_angle(sin_o, g.cos_theta_o),
                     radial = angle_above(sqrt(sqr(x) + sqr(wi.y)), z);
    std::optional<RgbT<AffineForm>> out;
    const auto add = [&](const std::array<AffineForm, known + 2>& at) {
      const RgbT<AffineForm> one = value(at);
      out = out ? RgbT<AffineForm>{either(out->r, one.r), either(out->g, one.g), either(out->b, one.b)} : one;
    };
    for_each_azimuth(wi.y, x, [&](const AffineForm& azimuth) {
      if constexpr (known == 1) {
        add({theta_o, azimuth, radial});
      } else {
        const AffineForm rotation = shifted(-azimuth_of_wo(g), 0.5 * pi_v<double>);
        for_each_turn(table_.axes.rotation, rotation, [&](const AffineForm& branch) {
          add({branch, theta_o, azimuth, radial});
        });
      }
    });
    return *out;
  }

 private:
  using Pieces = GridPieces<known + 2, 100>;

  // x and y of wi where wo has no y.
  static Vec2<AffineForm> in_plane_of_wo(const ShadingGeometry<AffineForm>& g, const AffineForm& sin_o) {
    if (g.wo.y.range.magnitude() == 0 && g.wo.x.range.lo >= 0) return {g.wi.x, g.wi.y};
    if (g.viewer && g.viewer->wi) {
      const AffineForm slack = AffineForm::anything_in({-2e-6, 2e-6});  // turned there and back
      return {g.viewer->wi->x + slack, g.viewer->wi->y + slack};
    }
    const AffineForm any = AffineForm::anything_in({-1.0001, 1.0001});
    Vec2<AffineForm> azimuth{any, any};
    if (sin_o.range.lo > 1e-6) azimuth = {g.wo.x / sin_o, g.wo.y / sin_o};
    if (g.viewer) {
      const AffineForm slack = AffineForm::anything_in({-1e-6, 1e-6});
      azimuth = {cos(g.viewer->azimuth) + slack, sin(g.viewer->azimuth) + slack};
    }
    return {azimuth.x * g.wi.x + azimuth.y * g.wi.y, azimuth.x * g.wi.y - azimuth.y * g.wi.x};
  }
  // An angle that the program turns into the circle of nodes, of which the last is the first and a turn.
  template <class Visit>
  static void for_each_turn(const std::vector<float>& nodes, const AffineForm& angle, const Visit& visit) {
    using namespace enclosed_angles;
    constexpr double rounding = 3e-6;
    const auto first = double(nodes.front());
    const AffineForm rounded = widened(angle, angle_share) + AffineForm::anything_in({-rounding, rounding});
    for_each_branch(rounded, {first, first + 2 * pi_v<double>}, 0, visit);
  }
  template <class Visit>
  void for_each_azimuth(const AffineForm& y, const AffineForm& x, const Visit& visit) const {
    using namespace enclosed_angles;
    if (table_.axes.mirrored) return visit(angle_above(abs(y), x));
    const AffineForm angle = azimuth_of(y, x);
    if (angle.range.hi - angle.range.lo < 1.5 * pi_v<double>)
      return for_each_turn(table_.axes.azimuth, angle, visit);
    const auto first = double(table_.axes.azimuth.front());
    visit(AffineForm::anything_in({first, first + 2 * pi_v<double>}));
  }
  RgbT<AffineForm> value(const std::array<AffineForm, known + 2>& at) const {
    const SpecularAxes& axes = table_.axes;
    const auto axis = [](const std::vector<float>& nodes) {
      return GridAxis{int(nodes.size()), false, nodes};
    };
    std::array<GridAxis, known + 2> grid;
    if constexpr (known == 2) grid[0] = axis(axes.rotation);
    grid[known - 1] = axis(axes.theta_o), grid[known] = axis(axes.azimuth),
                 grid[known + 1] = axis(axes.radial);
    const Pieces pieces(grid, at);
    if constexpr (std::is_same_v<Value, float>) {
      const AffineForm grey = channel(pieces, 0);
      return {grey, grey, grey};
    } else {
      return {channel(pieces, 0), channel(pieces, 1), channel(pieces, 2)};
    }
  }
  AffineForm channel(const Pieces& pieces, int c) const {
    const SpecularAxes& axes = table_.axes;
    const auto entry = [&](const std::array<int, known + 2>& i) {
      const std::size_t slice =
          (known == 2 ? std::size_t(i[0]) * axes.theta_o.size() : 0) + std::size_t(i[known - 1]);
      const std::size_t row = slice * axes.azimuth.size() + std::size_t(i[known]);
      return channel_value(table_.values[row * axes.radial.size() + std::size_t(i[known + 1])], c);
    };
    constexpr double share = 0x1p-19;
    return max(pieces.interpolated_or_ranged(entry, share), AffineForm(0.f));
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
  if (traits.isotropic) {
    traits.enclosure = std::make_shared<SpecularEnclosure<Value, 1>>(*this);
  } else {
    traits.enclosure = std::make_shared<SpecularEnclosure<Value, 2>>(*this);
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
