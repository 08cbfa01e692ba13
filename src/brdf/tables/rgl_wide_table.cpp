// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/rgl_wide_table.hpp"

#include <algorithm>
#include <cassert>

#include "reflectree/brdf/tables/between_nodes.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "reflectree/math/prefetch.hpp"
#include "rgl_enclosure.hpp"
#include "rgl_parts.hpp"

namespace reflectree {

using namespace rgl_parts;

namespace {

float interpolate(const RglSquare& table, float u, float v) {
  const GridPosition x = locate(u, table.width), y = locate(v, table.height);
  const float* node = table.values.data() + y.node * table.width + x.node;
  return linear_mix(y.fraction, linear_mix(x.fraction, node[0], node[1]),
                    linear_mix(x.fraction, node[table.width], node[table.width + 1]));
}

float azimuth_to_v(float phi) { return phi * (0.5f / pi) + 0.5f; }

}  // namespace

RglWideTable::RglWideTable(const RglWideFields& fields)
    : name(fields.name),
      phi_o_(fields.phi_o),
      theta_o_(fields.theta_o),
      reduction_(fields.reduction),
      channels_(fields.channels),
      sigma_(fields.sigma),
      ndf_(fields.ndf),
      warp_width_(fields.warp_width),
      warp_height_(fields.warp_height),
      colour_width_(fields.colour_width),
      colour_height_(fields.colour_height),
      slices_(fields.phi_o.size() > 1 ? 4 : 2),
      warp_size_(std::size_t(warp_width_) * std::size_t(warp_height_)),
      rows_(std::size_t(warp_height_)),
      colour_size_(std::size_t(colour_width_) * std::size_t(colour_height_)),
      stride_(std::size_t(channels_ == 3 ? 4 : channels_)) {
  const std::size_t slices = phi_o_.size() * theta_o_.size(), channels = std::size_t(channels_);
  assert(theta_o_.size() > 1 && std::min(warp_width_, warp_height_) > 1);
  assert(std::min(colour_width_, colour_height_) > 1 && channels_ >= 1 && channels_ <= max_channels);
  assert(fields.vndf.size() == slices * warp_size_ &&
         fields.colours.size() == slices * channels * colour_size_);
  if (!fields.jacobian) {  // D / (4 sigma) = 1
    sigma_ = {2, 2, std::vector<float>(4, 0.25f)};
    ndf_ = {2, 2, std::vector<float>(4, 1.f)};
  }
  const auto tables = std::make_shared<Tables>();
  tables->warp.reserve(slices * warp_size_), tables->rows.reserve(slices * rows_);
  tables->colour.resize(slices * colour_size_ * stride_);
  for (std::size_t s = 0; s < slices; ++s) {
    const Slice slice = integrate(fields.vndf.data() + s * warp_size_, warp_width_, warp_height_);
    for (std::size_t i = 0; i < warp_size_; ++i)
      tables->warp.push_back({float(slice.cdf[i]), float(slice.pdf[i])});
    for (std::size_t y = 0; y < rows_; ++y)
      tables->rows.push_back({float(slice.row_cdf[y]), float(slice.row_mass[y])});
    const float* from = fields.colours.data() + s * channels * colour_size_;
    for (std::size_t c = 0; c < channels; ++c) {
      for (std::size_t i = 0; i < colour_size_; ++i)
        tables->colour[(s * colour_size_ + i) * stride_ + c] = from[c * colour_size_ + i];
    }
  }
  warp_ = tables->warp.data(), row_ = tables->rows.data(), colour_ = tables->colour.data();
  tables_ = tables;
}

RglWideTable::Known RglWideTable::known(const ShadingGeometry<float>& g) const {
  const float theta_o = polar_angle(sin2_theta(g.wo), g.cos_theta_o);
  const detail::BetweenNodes t = detail::between_nodes(theta_o_, theta_o);
  Known k{};
  if (slices_ == 2) {
    k.slice[0] = t.low, k.slice[1] = t.high;
    k.weight[0] = 1 - t.fraction, k.weight[1] = t.fraction;
    k.four_sigma = 4.f * interpolate(sigma_, elevation_to_u(theta_o), 0.5f);
    return k;
  }
  // Into the half or the quarter that begins at -pi.
  const float x = g.wo.x, y = g.wo.y;
  if (reduction_ == 4) k.flip_x = !(x < 0), k.flip_y = !(y < 0);
  if (reduction_ == 2) k.flip_x = k.flip_y = y > 0 || (y == 0 && !(x < 0));
  const float fx = k.flip_x ? -x : x, fy = k.flip_y ? -y : y;
  const bool normal = x == 0 && y == 0;
  const float phi_o = reduction_ == 1 ? angle_of(fy, fx) : normal ? -pi : -angle_of(abs(fy), fx);
  const detail::BetweenNodes p = detail::between_nodes(phi_o_, phi_o);
  const std::size_t row = theta_o_.size();
  const std::size_t slice[4] = {p.low * row + t.low, p.low * row + t.high, p.high * row + t.low,
                                p.high * row + t.high};
  const float low = 1 - p.fraction, weight[4] = {low * (1 - t.fraction), low * t.fraction,
                                                 p.fraction * (1 - t.fraction), p.fraction * t.fraction};
  for (std::size_t s = 0; s < 4; ++s) k.slice[s] = slice[s], k.weight[s] = weight[s];
  k.four_sigma = 4.f * interpolate(sigma_, elevation_to_u(theta_o), azimuth_to_v(phi_o));
  return k;
}

RglWideTable::InWarp RglWideTable::in_warp(const Known& known, const ShadingGeometry<float>& g) const {
  float hx = g.wh.x, hy = g.wh.y;
  if (slices_ == 2) {  // relative to wo; absolute where wo is the normal
    const bool normal = g.wo.x == 0 && g.wo.y == 0;
    const float ox = select(normal, 1.f, g.wo.x), oy = g.wo.y;
    hx = ox * g.wh.x + oy * g.wh.y, hy = ox * g.wh.y - oy * g.wh.x;
  } else {
    hx = known.flip_x ? -hx : hx, hy = known.flip_y ? -hy : hy;
  }
  const float v = azimuth_to_v(angle_of(hy, hx));
  const float u = elevation_to_u(polar_angle(sin2_theta(g.wh), g.cos_theta_h));
  const GridPosition x = locate(u, warp_width_), y = locate(v, warp_height_);
  return {std::size_t(y.node) * std::size_t(warp_width_) + std::size_t(x.node), std::size_t(y.node),
          x.fraction, y.fraction, max(interpolate(ndf_, u, v), 0.f)};
}

// V^-1: the cumulative masses of the bilinear density up to the half vector, along u, then along v.
RglWideTable::InColour RglWideTable::in_colour(const Known& known, const InWarp& at) const {
  const float x1 = at.x, y1 = at.y, y0 = 1 - y1;
  float cdf[2] = {0, 0}, p0[2] = {0, 0}, p1[2] = {0, 0}, row_cdf = 0, m0 = 0, m1 = 0;
  for (std::size_t s = 0; s < slices_; ++s) {
    const float w = known.weight[s];
    const WarpNode* lower = warp_ + known.slice[s] * warp_size_ + at.node;
    const WarpNode* nodes[2] = {lower, lower + warp_width_};
    for (std::size_t k = 0; k < 2; ++k) {
      cdf[k] += w * nodes[k][0].cdf;
      p0[k] += w * nodes[k][0].pdf, p1[k] += w * nodes[k][1].pdf;
    }
    const WarpRow* rows = row_ + known.slice[s] * rows_ + at.row;
    row_cdf += w * rows[0].cdf, m0 += w * rows[0].mass, m1 += w * rows[1].mass;
  }
  const auto along = [&](std::size_t k) { return cdf[k] + x1 * (p0[k] + 0.5f * x1 * (p1[k] - p0[k])); };
  const float mass = y0 * m0 + y1 * m1;
  const float sx = (y0 * along(0) + y1 * along(1)) / select(mass > 0.f, mass, 1.f);
  const float sy = row_cdf + y1 * (m0 + 0.5f * y1 * (m1 - m0));
  const GridPosition x = locate(sx, colour_width_), y = locate(sy, colour_height_);
  return {std::size_t(y.node) * std::size_t(colour_width_) + std::size_t(x.node), x.fraction, y.fraction};
}

// S, bilinear on the warped square, times D / (4 sigma cos_i).
void RglWideTable::colour(const Known& known, const InWarp& warp, const InColour& at, float cos_theta_i,
                          float* out) const {
  const float scale = warp.normals / (known.four_sigma * max(1e-6f, cos_theta_i));
  const std::size_t channels = std::size_t(channels_), row = std::size_t(colour_width_) * stride_;
  std::fill_n(out, channels, 0.f);
  for (std::size_t s = 0; s < slices_; ++s) {
    const float* node = colour_ + (known.slice[s] * colour_size_ + at.node) * stride_;
    const float w = scale * known.weight[s], lower = w * (1 - at.y), upper = w * at.y;
    const float w00 = lower * (1 - at.x), w10 = lower * at.x, w01 = upper * (1 - at.x), w11 = upper * at.x;
    for (std::size_t c = 0; c < channels; ++c)
      out[c] +=
          (w00 * node[c] + w10 * node[stride_ + c]) + (w01 * node[row + c] + w11 * node[row + stride_ + c]);
  }
}

Spectrum RglWideTable::unclipped(const ShadingGeometry<float>& g) const {
  Spectrum value(channels_);
  const Known of_wo = known(g);
  const InWarp at = in_warp(of_wo, g);
  colour(of_wo, at, in_colour(of_wo, at), g.cos_theta_i, value.data());
  return value;
}

Spectrum RglWideTable::operator()(const ShadingGeometry<float>& g) const {
  Spectrum value = unclipped(g);
  for (int c = 0; c < channels_; ++c) value[c] = max(value[c], 0.f);
  return value;
}

void RglWideTable::eval(std::span<const Direction> wo, std::span<const Direction> wi,
                        std::span<float> out) const {
  eval(shading_geometries(wo, wi), out);
}

void RglWideTable::eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
  const auto channels = std::size_t(channels_);
  const auto two_rows = [](const auto* node, std::size_t row) { prefetch(node), prefetch(node + row); };
  look_up<32>(
      geometry, [&](std::size_t i) { std::fill_n(out.data() + i * channels, channels, 0.f); },
      [&](const ShadingGeometry<float>& g) { return known(g); },
      [&](const Known& of_wo, const ShadingGeometry<float>& g) {
        const InWarp at = in_warp(of_wo, g);
        for (std::size_t s = 0; s < slices_; ++s) {
          two_rows(warp_ + of_wo.slice[s] * warp_size_ + at.node, std::size_t(warp_width_));
          prefetch(row_ + of_wo.slice[s] * rows_ + at.row);
        }
        return at;
      },
      [&](const Known& of_wo, const InWarp& warp) {
        const InColour at = in_colour(of_wo, warp);
        for (std::size_t s = 0; s < slices_; ++s) {
          two_rows(colour_ + (of_wo.slice[s] * colour_size_ + at.node) * stride_,
                   std::size_t(colour_width_) * stride_);
        }
        return at;
      },
      [&](std::size_t i, const Known& of_wo, const InWarp& warp, const InColour& at) {
        float* value = out.data() + i * channels;
        colour(of_wo, warp, at, geometry[i].cos_theta_i, value);
        for (std::size_t c = 0; c < channels; ++c) value[c] = max(value[c], 0.f);
      });
}

BrdfTraits RglWideTable::traits() const {
  BrdfTraits traits;
  traits.name = name;
  traits.channels = channels_;
  traits.isotropic = traits.isotropic_by_formula = slices_ == 2;
  traits.theta_o_knots = theta_o_;
  traits.enclosure = enclosure_of(*this);
  if (reduction_ == 4) traits.axis = 0.f;
  if (slices_ == 4) {  // the nodes, and what their half or quarter is repeated by
    AzimuthKnots all{pi / 2, {}};
    for (const float phi : phi_o_) {
      all.phi_o.push_back(phi);
      if (reduction_ > 1) all.phi_o.push_back(phi + pi);
      if (reduction_ > 2) all.phi_o.push_back(-phi), all.phi_o.push_back(pi - phi);
    }
    traits.phi_o_knots.push_back(std::move(all));
  }
  return traits;
}

}  // namespace reflectree
