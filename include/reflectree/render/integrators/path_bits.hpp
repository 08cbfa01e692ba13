// SPDX-License-Identifier: Apache-2.0
// The random bits of one path. Each decision (a pixel's point, a light, a surface's direction) is a block of
// four coordinates of a point set; what a decision asks beyond its block comes from pcg32. All of it depends
// on seed, pixel and sample alone.
//   independent  every word from pcg32
//   stratified   jittered cells: `columns * rows` samples in a row visit each cell of each pair of
//                coordinates once, in random orders (Mitchell 1996; Shirley 1991)
//   sobol        Owen-scrambled Sobol' points, a scramble per pixel (math/low_discrepancy.hpp)
#pragma once

#include "reflectree/math/uniform_bits.hpp"

namespace reflectree::render {

struct PointSet {
  enum class Kind : std::uint8_t { independent, stratified, sobol } kind = Kind::independent;
  std::uint32_t columns = 4, rows = 4;  // of stratified points
  friend bool operator==(const PointSet&, const PointSet&) = default;
};

enum class Decision : std::uint32_t { light, surface, survival, count };

class PathBits {
 public:
  explicit PathBits(Pcg32 rest = Pcg32()) : rest_(rest) {}
  // Begins with the pixel's own block: two words for the film, two for a lens.
  PathBits(PointSet set, std::uint64_t seed, std::uint64_t pixel, std::uint32_t sample);

  // The next words are for this decision at a path's `vertex`, 1 what the camera sees.
  void begin(int vertex, Decision decision) {
    if (set_.kind == PointSet::Kind::independent) return;
    dimension_ =
        4 * (1 + std::uint32_t(Decision::count) * std::uint32_t(vertex - 1) + std::uint32_t(decision));
    left_ = 4, placed_ = false;
  }
  std::uint32_t operator()() { return left_ == 0 ? rest_() : coordinate(); }

  // For a sampler that takes two chosen words: lend() them and take_back() what is left.
  UniformBits lend() {
    if (left_ < 2) return UniformBits(rest_);
    const std::uint32_t a = coordinate(), b = coordinate();
    left_ = 0;
    return {{a, b}, rest_};
  }
  void take_back(const UniformBits& bits) { rest_ = bits.rest(); }

  // Where a path splits into n: the bits of its k-th branch. Branches of all samples are one point set.
  PathBits branch(std::uint32_t k, std::uint32_t n);

 private:
  std::uint32_t coordinate();

  PointSet set_;
  std::uint32_t index_ = 0, dimension_ = 0, left_ = 0, scramble_ = 0;
  std::uint32_t in_block_ = 0;  // the block's point of the Sobol' sequence, once `placed_`
  bool placed_ = false;
  Pcg32 rest_;
};

}  // namespace reflectree::render
