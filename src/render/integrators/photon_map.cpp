// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/photon_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace reflectree::render {

// Cells are two radii wide: what is near a point lies in eight of them at most.
PhotonMap::Cell PhotonMap::cell_of(Point at, float shift) const {
  const auto axis = [&](float x) {
    return std::int32_t(std::clamp(std::floor(x / (2 * radius_) + shift), -2e9f, 2e9f));
  };
  return {axis(at.x), axis(at.y), axis(at.z)};
}

// Teschner et al. 2003; buckets are a power of two.
std::size_t PhotonMap::bucket_of(Cell c) const {
  const std::uint32_t h =
      std::uint32_t(c.x) * 73856093U ^ std::uint32_t(c.y) * 19349663U ^ std::uint32_t(c.z) * 83492791U;
  return (h ^ (h >> 15U)) & (first_.size() - 2);
}

// A counting sort, which keeps the order in a bucket: sums do not depend on how the photons were made.
PhotonMap::PhotonMap(std::vector<Photon> photons, float radius) : radius_(radius) {
  first_.assign(std::bit_ceil(photons.size() + 1) + 1, 0);
  std::vector<std::uint32_t> bucket(photons.size());
  for (std::size_t i = 0; i < photons.size(); ++i) {
    bucket[i] = std::uint32_t(bucket_of(cell_of(photons[i].at, 0)));
    ++first_[bucket[i] + 1];
  }
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  photons_.resize(photons.size());
  for (std::size_t i = 0; i < photons.size(); ++i) photons_[next[bucket[i]]++] = photons[i];
}

template <class Visit>
void PhotonMap::near(Point at, const Visit& visit) const {
  if (photons_.empty()) return;
  const Cell low = cell_of(at, -.5f);
  const float inverse = 1 / (radius_ * radius_);
  for (std::int32_t k = 0; k < 8; ++k) {
    const Cell cell{low.x + (k & 1), low.y + ((k >> 1) & 1), low.z + (k >> 2)};
    const std::size_t bucket = bucket_of(cell);
    for (std::uint32_t i = first_[bucket]; i < first_[bucket + 1]; ++i) {
      const Photon& p = photons_[i];
      const Point off = p.at - at;
      const float share = dot(off, off) * inverse;
      if (share < 1 && cell_of(p.at, 0) == cell) visit(p, share);  // a bucket holds other cells too
    }
  }
}

Rgb PhotonMap::reflected(const PathVertex& at, int fewest, int most) const {
  Rgb sum;
  near(at.on.at, [&](const Photon& p, float share) {
    if (p.edges < fewest || p.edges > most) return;
    const Rgb f_cos = at.f_cos(to_local(at.frame, p.wi));
    sum = sum + (1 - share) * (f_cos * p.etendue);
  });
  return (2 / (pi * radius_ * radius_)) * sum;
}

}  // namespace reflectree::render
