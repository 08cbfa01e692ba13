// SPDX-License-Identifier: Apache-2.0
// One-shot mode: no rejection; two uniforms in, a direction out; the density is the tree's own,
// product-linear in each leaf, and never evaluates f. Always unbiased; the weight f_cos / pdf varies a little
// instead. Two ways in: an alias table (fastest, not monotone), and a monotone descent for QMC points, with
// its inverse.
#pragma once

#include <memory>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/sampler/direction_sample.hpp"
#include "reflectree/sampler/domain_map.hpp"
#include "reflectree/sampler/incidence.hpp"

namespace reflectree {

namespace detail {

// The inverse of the CDF of the density (1 + g s) / 2 on [-1, 1], returned as (s + 1) / 2 in [0, 1].
inline float sample_linear(float slope, float u) {
  const float a = 1 - slope, b = 1 + slope;
  return min(2 * u / (a + sqrt(lerp(u, a * a, b * b))), 1.f);
}
inline float linear_cdf(float slope, float t) { return t * (1 - slope * (1 - t)); }

// A point of the square with the density there, per share of the square.
struct DensityPoint {
  Vec2<float> p;
  float density;
};

inline DensityPoint place(const OneShotSlab& slab, const OneShotLeaf& leaf, bool half, float ux, float uy) {
  const UnpackedCell cell = unpack(leaf.cell, half);
  const float gx = float(leaf.slope_x) / 128, gy = float(leaf.slope_y) / 128;
  const float tx = sample_linear(gx, ux), ty = sample_linear(gy, uy);
  return {
      {cell.x0 + cell.width * tx, cell.y0 + cell.height * ty},
      slab.unit * float(leaf.mass) * cell.inverse_area * (1 + gx * (2 * tx - 1)) * (1 + gy * (2 * ty - 1))};
}

// The leaf that holds p, and p's place in it.
struct Located {
  const OneShotLeaf* leaf;
  float tx, ty;  // in [0, 1] across the leaf
  float density;
  double u1, u2;  // the uniforms that the monotone descent takes to p
};
Located locate(const PackedSampler& packed, const OneShotSlab& slab, Vec2<float> p);

}  // namespace detail

template <Brdf F>
class OneShotSampler {
 public:
  using Value = ValueOf<F>;

  OneShotSampler(F f, std::shared_ptr<const PackedSampler> packed)
      : f_(std::move(f)), packed_(std::move(packed)) {}

  const F& brdf() const { return f_; }
  const PackedSampler& packed() const { return *packed_; }

  // By alias table, from 128 random bits.
  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    Incidence in;
    if (!find_incidence(*packed_, wo, in)) return std::nullopt;
    const OneShotSlab& slab = packed_->one_shot[packed_->one_shot_lookup(in.wo.z)];
    const OneShotLeaf& leaf =
        detail::choose_leaf(slab, packed_->one_shot_leaves.data() + slab.first, detail::bits64(u));
    const std::uint32_t ux = u(), uy = u();
    return finish(in, detail::place(slab, leaf, packed_->domain.half, to_unit_float(ux), to_unit_float(uy)),
                  packed_->domain.half && (ux & 1U));
  }

  // By monotone descent from two uniforms in [0, 1): stratified and QMC points stay stratified.
  std::optional<DirectionSample<Value>> sample(Direction wo, double u1, double u2) const {
    Incidence in;
    if (!find_incidence(*packed_, wo, in)) return std::nullopt;
    const OneShotSlab& slab = packed_->one_shot[packed_->one_shot_lookup(in.wo.z)];
    const bool half = packed_->domain.half, below = half && u2 < 0.5;
    if (half) u2 = below ? 1 - 2 * u2 : 2 * u2 - 1;  // continuous across the plane of incidence
    const DescentNode* nodes = packed_->one_shot_nodes.data() + slab.first_node;
    std::uint32_t i = 0;
    while (nodes[i].split != Split::leaf) {
      double& u = nodes[i].split == Split::x ? u1 : u2;
      const double lower = nodes[i].lower;
      const bool up = u >= lower;
      u = up ? (u - lower) / (1 - lower) : u / lower;
      i = nodes[i].child + up;
    }
    const OneShotLeaf& leaf = packed_->one_shot_leaves[slab.first + nodes[i].child];
    return finish(in, detail::place(slab, leaf, half, min(float(u1), 1.f), min(float(u2), 1.f)), below);
  }

  // The uniforms that `sample(wo, u1, u2)` takes to wi, up to rounding; nullopt below the horizon.
  std::optional<Vec2<double>> invert(Direction wo, Direction wi) const {
    Incidence in;
    if (!(wi.z > 0) || !find_incidence(*packed_, wo, in)) return std::nullopt;
    const bool half = packed_->domain.half;
    Direction local = to_incidence(in, wi);
    const bool below = half && local.y < 0;
    if (half) local.y = abs(local.y);
    const OneShotSlab& slab = packed_->one_shot[packed_->one_shot_lookup(in.wo.z)];
    const detail::Located at = detail::locate(*packed_, slab, lower(packed_->domain, in.wo, local));
    return Vec2<double>{at.u1, !half ? at.u2 : below ? 0.5 * (1 - at.u2) : 0.5 * (1 + at.u2)};
  }

  // Per solid angle, sr^-1; by point location, without evaluating f.
  float pdf(Direction wo, Direction wi) const { return pdf_disk(wo, wi) * max(wi.z, 0.f); }
  // Per projected solid angle.
  float pdf_disk(Direction wo, Direction wi) const {
    Incidence in;
    if (!(wi.z > 0) || !find_incidence(*packed_, wo, in)) return 0;
    Direction local = to_incidence(in, wi);
    if (packed_->domain.half) local.y = abs(local.y);
    const OneShotSlab& slab = packed_->one_shot[packed_->one_shot_lookup(in.wo.z)];
    const Vec2<float> p = lower(packed_->domain, in.wo, local);
    const float projected_area = lift(packed_->domain, in.wo, p).projected_area;
    return projected_area > 0 ? detail::locate(*packed_, slab, p).density / projected_area : 0.f;
  }

 private:
  std::optional<DirectionSample<Value>> finish(const Incidence& in, const detail::DensityPoint& at,
                                               bool mirrored) const {
    DomainPoint point = lift(packed_->domain, in.wo, at.p);
    if (!(point.projected_area > 0)) return std::nullopt;  // rounding at the very rim
    if (mirrored) {
      point.geometry.wi.y = -point.geometry.wi.y;
      point.geometry.wh.y = -point.geometry.wh.y;
    }
    const float pdf_disk = at.density / point.projected_area;
    return DirectionSample<Value>{from_incidence(in, point.geometry.wi),
                                  pdf_disk * point.geometry.cos_theta_i,
                                  scaled(eval(f_, point.geometry), 1 / pdf_disk), sample_reflection};
  }

  F f_;
  std::shared_ptr<const PackedSampler> packed_;
};

}  // namespace reflectree
