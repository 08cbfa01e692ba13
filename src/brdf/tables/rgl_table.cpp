// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/rgl_table.hpp"

#include <algorithm>
#include <cassert>

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/math/prefetch.hpp"
#include "rgl_enclosure.hpp"
#include "rgl_parts.hpp"

namespace reflectree {

using namespace rgl_parts;

namespace {

Rgb clipped(Rgb f) { return {max(f.r, 0.f), max(f.g, 0.f), max(f.b, 0.f)}; }

}  // namespace

RglTable::RglTable(const RglFields& fields)
    : name(fields.name),
      theta_o_(fields.theta_o),
      sigma_(fields.sigma),
      ndf_(fields.ndf),
      warp_width_(fields.warp_width),
      warp_height_(fields.warp_height),
      colour_width_(fields.colour_width),
      colour_height_(fields.colour_height) {
  const std::size_t nodes = theta_o_.size(), pairs = nodes - 1;
  const auto warp_size = std::size_t(warp_width_) * std::size_t(warp_height_);
  const auto colour_size = std::size_t(colour_width_) * std::size_t(colour_height_);
  assert(nodes > 1 && sigma_.size() > 1 && ndf_.size() > 1 && std::min(warp_width_, warp_height_) > 1 &&
         std::min(colour_width_, colour_height_) > 1);
  assert(fields.vndf.size() == nodes * warp_size && fields.rgb.size() == nodes * 3 * colour_size);
  if (!fields.jacobian) {  // D / (4 sigma) = 1
    sigma_.assign(2, 0.25f);
    ndf_.assign(2, 1.f);
  }
  const auto tables = std::make_shared<Tables>();
  tables->warp.resize(pairs * warp_size);
  tables->rows.resize(pairs * std::size_t(warp_height_));
  tables->colour.resize(pairs * colour_size);
  for (std::size_t t = 0; t < nodes; ++t) {
    const Slice slice = integrate(fields.vndf.data() + t * warp_size, warp_width_, warp_height_);
    const float* rgb = fields.rgb.data() + t * 3 * colour_size;
    const auto store = [&](std::size_t pair, std::size_t side) {
      for (std::size_t i = 0; i < warp_size; ++i) {
        tables->warp[pair * warp_size + i].cdf[side] = float(slice.cdf[i]);
        tables->warp[pair * warp_size + i].pdf[side] = float(slice.pdf[i]);
      }
      for (std::size_t y = 0; y < slice.row_mass.size(); ++y) {
        tables->rows[pair * slice.row_mass.size() + y].cdf[side] = float(slice.row_cdf[y]);
        tables->rows[pair * slice.row_mass.size() + y].mass[side] = float(slice.row_mass[y]);
      }
      for (std::size_t i = 0; i < colour_size; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          tables->colour[pair * colour_size + i].rgb[side][c] = rgb[c * colour_size + i];
        }
      }
    };
    if (t < pairs) store(t, 0);  // the lower end of the pair that starts here
    if (t > 0) store(t - 1, 1);  // the upper end of the pair below
  }
  warp_ = tables->warp.data(), rows_ = tables->rows.data(), colour_ = tables->colour.data();
  tables_ = tables;
}

RglTable::Known RglTable::known(const ShadingGeometry<float>& g) const {
  const float theta_o = polar_angle(sin2_theta(g.wo), g.cos_theta_o);
  unsigned inner_nodes_passed = 0;  // counted without a branch: random directions would mispredict it
  for (std::size_t i = 1; i + 1 < theta_o_.size(); ++i)
    inner_nodes_passed += theta_o >= theta_o_[i] ? 1U : 0U;
  const std::size_t pair = inner_nodes_passed;
  const float below = theta_o_[pair], above = theta_o_[pair + 1];
  const float t1 = min(max(0.f, (theta_o - below) / (above - below)), 1.f);
  return {pair, t1, 4.f * interpolate(sigma_, elevation_to_u(theta_o))};
}

Rgb RglTable::operator()(const ShadingGeometry<float>& g) const { return clipped(unclipped(g)); }

Rgb RglTable::unclipped(const ShadingGeometry<float>& g) const {
  const Known of_wo = known(g);
  const InWarp at = in_warp(of_wo, g);
  return unclipped(of_wo, at.u, in_colour(of_wo, at), g.cos_theta_i);
}

void RglTable::eval(std::span<const Direction> wo, std::span<const Direction> wi,
                    std::span<float> out) const {
  eval(shading_geometries(wo, wi), out);
}

void RglTable::eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
  const auto both_ends = [](const auto* node) {
    prefetch(node), prefetch(reinterpret_cast<const char*>(node + 2) - 1);
  };
  const auto warp_stride = std::size_t(warp_width_), colour_stride = std::size_t(colour_width_);
  look_up<64>(
      geometry, [&](std::size_t i) { out[3 * i] = out[3 * i + 1] = out[3 * i + 2] = 0; },
      [&](const ShadingGeometry<float>& g) { return known(g); },
      [&](const Known& of_wo, const ShadingGeometry<float>& g) {
        const InWarp at = in_warp(of_wo, g);
        both_ends(at.node), both_ends(at.node + warp_stride), both_ends(at.rows);
        return at;
      },
      [&](const Known& of_wo, const InWarp& warp) {
        const InColour at = in_colour(of_wo, warp);
        both_ends(at.node), both_ends(at.node + colour_stride);
        return at;
      },
      [&](std::size_t i, const Known& of_wo, const InWarp& warp, const InColour& colour) {
        const Rgb v = clipped(unclipped(of_wo, warp.u, colour, geometry[i].cos_theta_i));
        out[3 * i] = v.r, out[3 * i + 1] = v.g, out[3 * i + 2] = v.b;
      });
}

RglTable::InWarp RglTable::in_warp(const Known& of_wo, const ShadingGeometry<float>& g) const {
  // The half vector on the square, its azimuth relative to that of wo (absolute where wo is the normal).
  const bool normal = g.wo.x == 0 && g.wo.y == 0;
  const float ox = select(normal, 1.f, g.wo.x), oy = g.wo.y;
  const float phi = angle_of(ox * g.wh.y - oy * g.wh.x, ox * g.wh.x + oy * g.wh.y);
  const float u = elevation_to_u(polar_angle(sin2_theta(g.wh), g.cos_theta_h));
  const GridPosition px = locate(u, warp_width_), py = locate(phi * (0.5f / pi) + 0.5f, warp_height_);
  const std::size_t row = of_wo.pair * std::size_t(warp_height_) + std::size_t(py.node);
  return {warp_ + row * std::size_t(warp_width_) + std::size_t(px.node), rows_ + row, px.fraction,
          py.fraction, u};
}

// V^-1: the cumulative masses of the bilinear density up to the half vector, along u, then along v.
RglTable::InColour RglTable::in_colour(const Known& of_wo, const InWarp& at) const {
  const float t1 = of_wo.t1, t0 = 1 - t1, x1 = at.x, y1 = at.y, y0 = 1 - y1;
  const WarpNode *lower = at.node, *upper = lower + warp_width_;
  const auto along = [&](const WarpNode* n) {
    const float cdf = t0 * n[0].cdf[0] + t1 * n[0].cdf[1];
    const float p0 = t0 * n[0].pdf[0] + t1 * n[0].pdf[1], p1 = t0 * n[1].pdf[0] + t1 * n[1].pdf[1];
    return cdf + x1 * (p0 + 0.5f * x1 * (p1 - p0));
  };
  const WarpRow* rows = at.rows;
  const float m0 = t0 * rows[0].mass[0] + t1 * rows[0].mass[1];
  const float m1 = t0 * rows[1].mass[0] + t1 * rows[1].mass[1];
  const float mass = y0 * m0 + y1 * m1;
  const float sx = (y0 * along(lower) + y1 * along(upper)) / select(mass > 0.f, mass, 1.f);
  const float sy = t0 * rows[0].cdf[0] + t1 * rows[0].cdf[1] + y1 * (m0 + 0.5f * y1 * (m1 - m0));

  const GridPosition qx = locate(sx, colour_width_), qy = locate(sy, colour_height_);
  const std::size_t row = of_wo.pair * std::size_t(colour_height_) + std::size_t(qy.node);
  return {colour_ + row * std::size_t(colour_width_) + std::size_t(qx.node), qx.fraction, qy.fraction};
}

// S, bilinear on the warped square.
Rgb RglTable::unclipped(const Known& of_wo, float u, const InColour& at, float cos_theta_i) const {
  const auto colour_stride = std::size_t(colour_width_);
  const ColourNode* n00 = at.node;
  const float t1 = of_wo.t1, t0 = 1 - t1, a1 = at.x, a0 = 1 - a1, b1 = at.y, b0 = 1 - b1;
  const float normals = max(interpolate(ndf_, u), 0.f);
  const float scale = normals / (of_wo.four_sigma * max(1e-6f, cos_theta_i));
  float out[4] = {0, 0, 0, 0};
  const auto add = [&out](const ColourNode& n, float w0, float w1) {
    for (int c = 0; c < 4; ++c) out[c] += w0 * n.rgb[0][c] + w1 * n.rgb[1][c];
  };
  add(n00[0], a0 * b0 * t0, a0 * b0 * t1);
  add(n00[1], a1 * b0 * t0, a1 * b0 * t1);
  add(n00[colour_stride], a0 * b1 * t0, a0 * b1 * t1);
  add(n00[colour_stride + 1], a1 * b1 * t0, a1 * b1 * t1);
  return scale * Rgb{out[0], out[1], out[2]};
}

BrdfTraits RglTable::traits() const {
  BrdfTraits traits;
  traits.isotropic_by_formula = true;
  traits.name = name;
  traits.theta_o_knots = theta_o_;
  traits.enclosure = enclosure_of(*this);
  // 1 / sigma is piecewise linear in u, in steps of less than a degree.
  traits.theta_o_factor = [sigma = sigma_](double theta_o) {
    return 1 / double(interpolate(sigma, elevation_to_u(float(theta_o))));
  };
  return traits;
}

}  // namespace reflectree
