// SPDX-License-Identifier: Apache-2.0
// A block of trials, field by field: chosen one by one, computed in lanes.
#pragma once

#include "reflectree/math/lanes.hpp"
#include "reflectree/sampler/known/incidence.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree::detail {

inline constexpr std::size_t block_size = 64;
static_assert(block_size % lane_count == 0);

struct alignas(64) TrialBlock {
  enum Field {
    wo_x,
    cos_theta_o,
    wo_y,  // of domains that follow the surface
    cos_phi,
    sin_phi,
    side,
    albedo,  // Incidence
    x,
    y,
    width,
    length,
    slope_x,
    slope_y,
    height,  // LeafCell
    across_x,
    across_y,  // uniforms or places across the leaf
    turn,      // sign bit: of the coin of half domains
    uniform,   // of the acceptance
    known_x,
    known_y,
    known_z,        // wo as the caller gave it, where keep_known
    chosen_fields,  // above: chosen; below: computed
    wi_x = chosen_fields,
    wi_y,
    wi_z,
    projected_area,
    majorant,
    target,
    pdf,
    scale,
    field_count
  };
  float at[field_count][block_size];
  std::uint32_t index[block_size];  // in the batch
  std::size_t count = 0;
  bool keep_known;   // f is evaluated in the caller's frame (known_geometry in incidence.hpp)
  bool anisotropic;  // viewers are folded, and the domain may lie in the frame of the surface

  TrialBlock(bool evaluates_turned, bool is_anisotropic)
      : keep_known(!evaluates_turned), anisotropic(is_anisotropic) {}

  bool full() const { return count == block_size; }
  Lanes lanes(Field field, std::size_t k) const { return Lanes::load(at[field] + k); }
  void set(Field field, std::size_t k, Lanes v) { v.store(at[field] + k); }

  // The next trial; across_x, across_y, turn and uniform are still to be set.
  REFLECTREE_INLINE std::size_t add(std::size_t i, const Incidence& in, const PackedLeaf& leaf, bool half) {
    const std::size_t k = count++;
    index[k] = std::uint32_t(i);
    at[wo_x][k] = in.wo.x;
    at[cos_theta_o][k] = in.wo.z;
    at[cos_phi][k] = in.cos_phi;
    at[sin_phi][k] = in.sin_phi;
    if (anisotropic) at[wo_y][k] = in.wo.y, at[side][k] = in.side;
    at[albedo][k] = in.albedo;
    if (keep_known) at[known_x][k] = in.known.x, at[known_y][k] = in.known.y, at[known_z][k] = in.known.z;
    const LeafCell<float> cell = unpack(leaf, half);
    at[x][k] = cell.x;
    at[y][k] = cell.y;
    at[width][k] = cell.width;
    at[length][k] = cell.length;
    at[slope_x][k] = cell.slope_x;
    at[slope_y][k] = cell.slope_y;
    at[height][k] = cell.height;
    return k;
  }
  // From random bits, as place() in packed_leaf.hpp: x is mixed here, y is left to the lanes.
  template <RandomBits U>
  REFLECTREE_INLINE std::size_t add(std::size_t i, const Incidence& in, const ChosenLeaf& chosen, bool half,
                                    U& u) {
    const std::uint32_t first = u(), second = u();
    const std::size_t k = add(i, in, chosen.leaf, half);
    at[across_x][k] = mix_linear(chosen.leaf.slope_x, first, std::uint32_t(chosen.spare >> 32U));
    at[across_y][k] = to_unit_float(second);
    at[turn][k] = std::bit_cast<float>((second & std::uint32_t(half)) << 31U);
    return k;
  }
  // Fills the last lanes with copies of the last trial.
  void pad() {
    for (std::size_t k = count; k % lane_count != 0; ++k) {
      for (auto& field : at) field[k] = field[count - 1];
    }
  }
};

// Whether across_x is a uniform still to be taken through the inverse CDF, or the place itself.
enum class AcrossX { uniform, place };

// Computes points, directions and what f says there (block_values.hpp). The kind of the domain is looked at
// once per block: around the whole of a batch it would make six copies of all that chooses.
template <AcrossX across_x, class Values>
REFLECTREE_INLINE void compute_points(const Domain& any_domain, TrialBlock& b, Values& values) {
  using Field = TrialBlock::Field;
  b.pad();
  with_known_kind(any_domain, [&](const Domain& domain) REFLECTREE_INLINE_LAMBDA {
    for (std::size_t k = 0; k < b.count; k += lane_count) {
      const auto lanes = [&b, k](Field field) { return b.lanes(field, k); };
      const LeafCell<Lanes> cell{lanes(Field::x),      lanes(Field::y),       lanes(Field::width),
                                 lanes(Field::length), lanes(Field::slope_x), lanes(Field::slope_y),
                                 lanes(Field::height)};
      Lanes tx = lanes(Field::across_x);
      if constexpr (across_x == AcrossX::uniform) tx = sample_linear(cell.slope_x, tx);
      const PointInLeafT<Lanes> at = point_at(cell, tx, sample_linear(cell.slope_y, lanes(Field::across_y)));
      const bool surface = b.anisotropic && domain.follows_surface();
      const Vec3<Lanes> wo{lanes(Field::wo_x), surface ? lanes(Field::wo_y) : Lanes(0),
                           lanes(Field::cos_theta_o)};
      const DomainPointT<Lanes> point =
          lift_point(domain, wo, Vec2<Lanes>{at.p.x, flip_sign(at.p.y, lanes(Field::turn))});
      const Vec3<Lanes>& wi = point.geometry.wi;
      const Lanes cos_phi = lanes(Field::cos_phi), sin_phi = lanes(Field::sin_phi);
      const auto turn_back = [&](const Vec3<Lanes>& w) {
        const Lanes y = b.anisotropic ? flip_sign(w.y, lanes(Field::side)) : w.y;
        return Vec3<Lanes>{w.x * cos_phi - y * sin_phi, w.x * sin_phi + y * cos_phi, w.z};
      };
      const Vec3<Lanes> drawn = turn_back(wi);
      b.set(Field::wi_x, k, drawn.x);
      b.set(Field::wi_y, k, drawn.y);
      b.set(Field::wi_z, k, drawn.z);
      b.set(Field::projected_area, k, point.projected_area);
      b.set(Field::majorant, k, at.height);
      if (b.keep_known) {
        ShadingGeometry<Lanes> g = point.geometry;
        g.wo = {lanes(Field::known_x), lanes(Field::known_y), lanes(Field::known_z)};
        g.wi = drawn, g.wh = turn_back(g.wh);
        values.evaluate(k, g);
      } else {
        values.evaluate(k, point.geometry);
      }
    }
  });
  values.finish(b.count);
}

}  // namespace reflectree::detail
