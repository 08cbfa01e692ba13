// SPDX-License-Identifier: Apache-2.0
// What is known of many viewers, one after another. Of an anisotropic function they are folded, and its albedo is
// found, some lanes at a time; the bits are those of find_incidence.
#pragma once

#include <algorithm>
#include <span>

#include "reflectree/math/lanes.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree::detail {

// Four lines through the places around a viewer's azimuth, weighed.
REFLECTREE_INLINE Lanes albedo_at(const PackedAlbedo& albedo, Lanes cos_theta_o, Lanes phi_o, Lanes azimuth) {
  float c[lane_count], phi[lane_count], key[lane_count], t[lane_count], base[4][lane_count],
      slope[4][lane_count];
  cos_theta_o.store(c), phi_o.store(phi), azimuth.store(key);
  for (std::size_t i = 0; i < lane_count; ++i) {
    const PackedAlbedo::Row row = albedo.row_at(albedo.on_side(phi[i], key[i]));
    const AlbedoPiece* piece = albedo.pieces_at(c[i]) + row.index;
    t[i] = row.t;
    for (std::size_t k = 0; k < 4; ++k) base[k][i] = piece[k].base, slope[k][i] = piece[k].slope;
  }
  const std::array<Lanes, 4> weights = cubic_weights(Lanes::load(t));
  Lanes sum(0);
  for (std::size_t k = 0; k < 4; ++k)
    sum = sum + weights[k] * (Lanes::load(base[k]) + Lanes::load(slope[k]) * cos_theta_o);
  return max(sum, Lanes(0));
}

// Of an anisotropic function.
class ViewerStream {
 public:
  ViewerStream(const PackedSampler& packed, std::span<const Direction> wo, bool needs_albedo)
      : viewer_(packed.viewer), wo_(wo), needs_albedo_(needs_albedo || !spares_albedo(packed.viewer)) {}

  // Of wo[i], i ascending; false is "no sample".
  REFLECTREE_INLINE bool find(std::size_t i, Incidence& in) {
    if (i - first_ >= most) fold_from(i);
    const std::size_t k = i - first_;
    in.known = wo_[i];
    in.wo = {x_[k], y_[k], z_[k]};
    in.cos_phi = cos_phi_[k], in.sin_phi = sin_phi_[k];
    in.azimuth = azimuth_[k], in.side = side_[k];
    in.albedo = albedo_[k];
    return in.albedo > 0;
  }
  bool needs_albedo() const { return needs_albedo_; }

 private:
  static constexpr std::size_t most = 16;
  static_assert(most % lane_count == 0);

  REFLECTREE_NOINLINE void fold_from(std::size_t i) {
    first_ = i;
    const std::size_t last = wo_.size() - 1;
    for (std::size_t k = 0; k < most; ++k) {
      const Direction w = wo_[std::min(i + k, last)];
      x_[k] = w.x, y_[k] = w.y, z_[k] = w.z;
    }
    for (std::size_t k = 0; k < most; k += lane_count) fold_lanes(k);
  }
  REFLECTREE_INLINE void fold_lanes(std::size_t k) {
    const Lanes x = Lanes::load(x_ + k), y = Lanes::load(y_ + k), z = Lanes::load(z_ + k);
    const Lanes sin2_theta = x * x + y * y;
    const LaneMask valid = is_viewer(z, sin2_theta);
    // What is none is looked up at the normal.
    const Lanes cos_theta = min(select(valid, z, Lanes(1)), Lanes(1));
    const FoldedViewer<Lanes> folded =
        folded_by(viewer_, select(valid, x, Lanes(0)), select(valid, y, Lanes(0)));
    const FoldedFrame<Lanes> f = folded_frame(viewer_, folded, cos_theta, sin2_theta);
    f.wo.x.store(x_ + k), f.wo.y.store(y_ + k), f.wo.z.store(z_ + k);
    f.cos_phi.store(cos_phi_ + k), f.sin_phi.store(sin_phi_ + k);
    f.azimuth.store(azimuth_ + k), f.side.store(side_ + k);
    Lanes albedo(1);
    if (needs_albedo_) {
      const Lanes phi_o = azimuth_of(viewer_.frame.symmetry, folded.x, folded.y);
      albedo = albedo_at(viewer_.albedo, cos_theta, phi_o, f.azimuth);
    }
    select(valid, albedo, Lanes(0)).store(albedo_ + k);
  }

  const PackedViewer& viewer_;
  std::span<const Direction> wo_;
  bool needs_albedo_;
  std::size_t first_ = std::size_t(0) - most;  // of wo_; none yet
  float x_[most], y_[most], z_[most], cos_phi_[most], sin_phi_[most], azimuth_[most], side_[most],
      albedo_[most];
};

// fill(find): find(i, incidence) is find_incidence_of wo[i], i ascending; which way is chosen once.
template <class F, class Fill>
REFLECTREE_INLINE void with_viewers(const F& f, const PackedSampler& packed, std::span<const Direction> wo,
                                    ViewerStream& viewers, const Fill& fill) {
  if constexpr (!is_member_v<F>) {
    if (!packed.viewer.frame.isotropic()) {
      return fill([&](std::size_t i, Incidence& in) REFLECTREE_INLINE_LAMBDA { return viewers.find(i, in); });
    }
  }
  fill([&](std::size_t i, Incidence& in) REFLECTREE_INLINE_LAMBDA {
    return find_incidence_of(f, packed, wo[i], in, viewers.needs_albedo());
  });
}

}  // namespace reflectree::detail
