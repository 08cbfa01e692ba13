// SPDX-License-Identifier: Apache-2.0
#include "rgl_enclosure.hpp"

#include <array>

#include "bent_pieces.hpp"
#include "enclosed_angles.hpp"
#include "reflectree/brdf/tables/enclosed_difference.hpp"
#include "reflectree/math/affine_grid.hpp"

namespace reflectree {

using namespace bent_pieces;
using namespace enclosed_angles;

namespace {

constexpr double u = 0x1p-24;
// Smaller ones count as this.
constexpr float least_cosine = 1e-6f;

AffineForm elevation_to_u(const AffineForm& theta) { return sqrt(theta * AffineForm(2.f / pi)); }
// A position on a grid over [0, 1], in cells.
AffineForm located(const AffineForm& x, int nodes) {
  return within(within(x, 0, 1) * AffineForm(float(nodes - 1)), 0, nodes - 1);
}

// The azimuth of wh relative to that of wo. In the plane of wo y = 0 the sign of wh.y is that of wi.y, and no map
// returns wi.y = 0 beyond the pole (the cosine of cos_sin_half is positive).
AffineForm relative_azimuth(const ShadingGeometry<AffineForm>& g) {
  const bool plane = g.wo.y.range.magnitude() == 0;
  if (const HalfAzimuth* known = known_azimuth(g)) return known->angle;
  AffineForm y = g.wh.y, x = g.wh.x;
  if (!plane) y = g.wo.x * g.wh.y - g.wo.y * g.wh.x, x = g.wo.x * g.wh.x + g.wo.y * g.wh.y;
  if (plane && g.wi.y.range.lo >= 0) return angle_above(within(y, 0, 2), x);
  if (plane && g.wi.y.range.hi <= 0) return -angle_above(within(-y, 0, 2), x);
  if (x.range.lo > 0) return atan2(y, x);
  return AffineForm::anything_in({-pi_v<double>, pi_v<double>});
}

// A table that is linear between nodes, at a position in cells.
AffineForm interpolated(const std::vector<float>& table, const AffineForm& x) {
  const int nodes = int(table.size());
  const GridPieces<1> pieces({GridAxis{nodes}}, {x});
  const auto value = [&](const std::array<int, 1>& i) { return table[std::size_t(i[0])]; };
  if (pieces.are_few()) return pieces.interpolated(value, 8 * u);
  RealInterval range{detail::infinity, -detail::infinity};
  for (int i = pieces.first()[0]; i <= pieces.last()[0]; ++i) {
    const auto v = double(table[std::size_t(i)]);
    range = hull(range, RealInterval(v, v));
  }
  return widened(AffineForm::anything_in(range), 8 * u);
}

}  // namespace

// Many cells, as where the azimuth of wh may be any. Between nodes of theta_o and y the place along x is a quotient
// of two means with the same weights, and so between the quotients at the nodes; all masses ascend.
Vec2<AffineForm> RglEnclosure::unwarped_range(const AffineForm& theta_o, RealInterval x,
                                              RealInterval y) const {
  const RglTable& table = table_;
  const int width = table.warp_width_, height = table.warp_height_, pairs = int(table.theta_o_.size()) - 1;
  const auto cell = [](double at, int cells) { return std::clamp(int(at), 0, cells - 1); };
  const int first_y = cell(y.lo, height - 1), last_y = cell(y.hi, height - 1);
  RealInterval sx{1, 0}, sy{1, 0};
  for (int pair = 0; pair < pairs; ++pair) {
    const double from = double(table.theta_o_[std::size_t(pair)]),
                 to = double(table.theta_o_[std::size_t(pair) + 1]);
    if ((to < theta_o.range.lo && pair + 1 < pairs) || (from > theta_o.range.hi && pair > 0)) continue;
    for (const std::size_t side : {0U, 1U}) {
      const std::size_t slice = std::size_t(pair) * std::size_t(height);
      const auto below = [&](double at) {
        const int j = cell(at, height - 1);
        const RglTable::WarpRow* r = table.rows_ + slice + std::size_t(j);
        const double b = at - j, m0 = double(r[0].mass[side]), m1 = double(r[1].mass[side]);
        return double(r[0].cdf[side]) + b * (m0 + 0.5 * b * (m1 - m0));
      };
      sy = hull(sy, {below(y.lo), below(y.hi)});
      for (int j = first_y; j <= last_y + 1; ++j) {
        const std::size_t row = slice + std::size_t(j);
        const auto mass = double(table.rows_[row].mass[side]);
        const auto along = [&](double at) {
          const int i = cell(at, width - 1);
          const RglTable::WarpNode* n = table.warp_ + row * std::size_t(width) + std::size_t(i);
          const double a = at - i, p0 = double(n[0].pdf[side]), p1 = double(n[1].pdf[side]);
          return double(n[0].cdf[side]) + a * (p0 + 0.5 * a * (p1 - p0));
        };
        if (!(mass > 0)) return {AffineForm::anything_in({0, 1}), AffineForm::anything_in({0, 1})};
        sx = hull(sx, {along(x.lo) / mass, along(x.hi) / mass});
      }
    }
  }
  constexpr double share = 64 * u;
  const auto rounded = [](RealInterval r) {
    return within(AffineForm::anything_in({r.lo * (1 - share), r.hi * (1 + share)}), 0, 2);
  };
  return {rounded(sx), rounded(sy)};
}

Vec2<AffineForm> RglEnclosure::unwarped(const AffineForm& theta_o, const AffineForm& x,
                                        const AffineForm& y) const {
  const RglTable& table = table_;
  const AffineForm any = AffineForm::anything_in({0, 1});
  const int width = table.warp_width_, height = table.warp_height_;
  const auto unit = [](int i) { return double(i); };
  const Parts of_theta(theta_o.range, int(table.theta_o_.size()),
                       [&](int i) { return double(table.theta_o_[std::size_t(i)]); });
  const Parts of_x(x.range, width, unit), of_y(y.range, height, unit);
  if (!of_theta.are_few() || !of_x.are_few() || !of_y.are_few()) {
    // Where wh may be the normal its azimuth may stay unknown however small the box is. Elsewhere halving helps, and
    // a range without slopes would mislead the choice of the axis.
    if (x.range.lo < 1) return unwarped_range(theta_o, x.range, y.range);
    return {any, any};
  }
  using Where = std::array<const Part*, 3>;
  using Places = std::array<double, 3>;
  constexpr double share = 32 * u;
  const auto mix = [](const float(&ends)[2], double t) {
    return (1 - t) * double(ends[0]) + t * double(ends[1]);
  };
  // Along a row up to x, on both rows of the cell.
  const auto along = [&](const Where& where, const Places& place) {
    const double t = where[0]->share(place[0]), a = where[1]->share(place[1]), b = where[2]->share(place[2]);
    const std::size_t row = std::size_t(where[0]->cell) * std::size_t(height) + std::size_t(where[2]->cell);
    const RglTable::WarpNode* node = table.warp_ + row * std::size_t(width) + std::size_t(where[1]->cell);
    Bent sum{0, 0, where[1]->hi - where[1]->lo};
    for (const bool upper : {false, true}) {
      const RglTable::WarpNode* n = node + (upper ? width : 0);
      const double p0 = mix(n[0].pdf, t), p1 = mix(n[1].pdf, t), w = upper ? b : 1 - b;
      sum.value += w * (mix(n[0].cdf, t) + a * (p0 + 0.5 * a * (p1 - p0)));
      sum.bend += w * (p1 - p0);
    }
    return sum;
  };
  const auto rows = [&](const Where& where) {
    return table.rows_ + std::size_t(where[0]->cell) * std::size_t(height) + std::size_t(where[2]->cell);
  };
  const auto mass = [&](const Where& where, const Places& place) {
    const double t = where[0]->share(place[0]), b = where[2]->share(place[2]);
    const RglTable::WarpRow* r = rows(where);
    return Bent{(1 - b) * mix(r[0].mass, t) + b * mix(r[1].mass, t), 0, 0};
  };
  const auto below = [&](const Where& where, const Places& place) {
    const double t = where[0]->share(place[0]), b = where[2]->share(place[2]);
    const RglTable::WarpRow* r = rows(where);
    const double m0 = mix(r[0].mass, t), m1 = mix(r[1].mass, t);
    return Bent{mix(r[0].cdf, t) + b * (m0 + 0.5 * b * (m1 - m0)), m1 - m0, where[2]->hi - where[2]->lo};
  };
  // Where x does not enter one part of it stands for all.
  const AffineForm nowhere(0);
  const Parts one(RealInterval(0, 0), 2, unit);
  const std::array<const Parts*, 3> flat{&of_theta, &one, &of_y};
  const AffineForm sy = enclosed(flat, {theta_o, nowhere, y}, below, share);
  const AffineForm m = enclosed(flat, {theta_o, nowhere, y}, mass, share);
  if (!(m.range.lo > 0)) return {any, within(sy, 0, 2)};
  return {enclosed({&of_theta, &of_x, &of_y}, {theta_o, x, y}, along, share) / m, sy};
}

RgbT<AffineForm> RglEnclosure::colour(const AffineForm& theta_o, const Vec2<AffineForm>& at) const {
  const int nodes = int(table_.theta_o_.size()), width = table_.colour_width_, height = table_.colour_height_;
  const GridAxis of_theta{nodes, false, table_.theta_o_};
  // Of a hundred places along an axis, if there are few along the others.
  using Pieces = GridPieces<3, 100>;
  const Pieces pieces({of_theta, GridAxis{width}, GridAxis{height}},
                      {theta_o, located(at.x, width), located(at.y, height)});
  using Node = Pieces::Node;
  const auto of = [&](int channel) {
    const auto value = [&, channel](const Node& n) {
      const int pair = std::min(n[0], nodes - 2);
      const std::size_t row = std::size_t(pair) * std::size_t(height) + std::size_t(n[2]);
      return table_.colour_[row * std::size_t(width) + std::size_t(n[1])].rgb[n[0] - pair][channel];
    };
    constexpr double share = 32 * u;
    return pieces.interpolated_or_ranged(value, share);
  };
  return {of(0), of(1), of(2)};
}

RgbT<AffineForm> RglEnclosure::operator()(const ShadingGeometry<AffineForm>& g) const {
  return value(g, AffineForm(1) / max(AffineForm(least_cosine), g.cos_theta_i));
}

std::optional<RgbT<AffineForm>> RglEnclosure::times_cosine(const ShadingGeometry<AffineForm>& g) const {
  const double lo = g.cos_theta_i.range.lo / double(least_cosine);
  return value(g, lo > 1 ? AffineForm(1) : AffineForm::anything_in({std::max(lo * (1 - 2 * u), 0.), 1}));
}

RgbT<AffineForm> RglEnclosure::value(const ShadingGeometry<AffineForm>& g, const AffineForm& factor) const {
  const AffineForm sin_o =
      g.wo.y.range.magnitude() == 0 && g.wo.x.range.lo >= 0 ? g.wo.x : sqrt(sin2_theta(g.wo));
  const AffineForm theta_o = polar_angle(sin_o, g.cos_theta_o);
  const AffineForm sigma =
      interpolated(table_.sigma_, located(elevation_to_u(theta_o), int(table_.sigma_.size())));
  const AffineForm theta_h = polar_angle(detail::half_frame(g).sin_theta_h, g.cos_theta_h);
  const AffineForm of_theta = elevation_to_u(theta_h);
  const AffineForm of_phi = relative_azimuth(g) * AffineForm(0.5f / pi) + AffineForm(0.5f);
  const Vec2<AffineForm> at =
      unwarped(theta_o, located(of_theta, table_.warp_width_), located(of_phi, table_.warp_height_));
  const AffineForm zero(0.f);
  const AffineForm normals = max(interpolated(table_.ndf_, located(of_theta, int(table_.ndf_.size()))), zero);
  const AffineForm scale = factor * (normals / (AffineForm(4.f) * sigma));
  const RgbT<AffineForm> f = colour(theta_o, at);
  return {max(scale * f.r, zero), max(scale * f.g, zero), max(scale * f.b, zero)};
}

}  // namespace reflectree
