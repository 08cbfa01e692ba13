// SPDX-License-Identifier: Apache-2.0
// Forms of functions that are quadratic between nodes, as integrals of linear densities are: like affine_grid.hpp,
// with what a curve has beyond its chord.
#pragma once

#include <array>

#include "reflectree/math/affine_grid.hpp"

namespace reflectree::bent_pieces {

// The parts into which nodes cut a range.
struct Part {
  double lo, hi;
  int cell;
  double from, to;  // the cell's nodes
  double share(double x) const { return std::clamp((x - from) / (to - from), 0., 1.); }
};
class Parts {
 public:
  static constexpr std::size_t most = 12;
  // node(i): where node i lies.
  template <class Node>
  Parts(RealInterval x, int nodes, const Node& node) {
    for (int i = 0; i + 1 < nodes; ++i) {
      const double from = node(i), to = node(i + 1);
      if ((to <= x.lo && i + 2 < nodes) || (from >= x.hi && i > 0 && count_ > 0)) continue;
      if (count_ == most) {
        few_ = false;
        return;
      }
      const bool last = i + 2 >= nodes;
      parts_[count_++] = {std::max(from, x.lo), last ? std::max(x.hi, from) : std::min(to, x.hi), i, from,
                          to};
    }
  }
  bool are_few() const { return few_; }
  const Part* begin() const { return parts_.data(); }
  const Part* end() const { return parts_.data() + count_; }
  std::size_t size() const { return count_; }

 private:
  std::array<Part, most> parts_{};
  std::size_t count_ = 0;
  bool few_ = true;
};

// A function of theta_o, x and y that is linear in theta_o, and at most quadratic along one of the others, in each
// part: `bend` is its second difference there, for a whole cell. Less its chord it reaches an eighth of that, times
// the square of the part's width.
struct Bent {
  double value, bend, width;
};
// f(theta_o part, place, x part, place, y part, place), not negative; the program errs by `share` of the largest.
template <class F>
AffineForm enclosed(const std::array<const Parts*, 3>& parts, const std::array<AffineForm, 3>& at, const F& f,
                    double share) {
  std::array<double, 3> alpha{};
  for (std::size_t bits = 0; bits < 8; ++bits) {
    std::array<const Part*, 3> part;
    std::array<double, 3> place;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool high = (bits >> a & 1U) != 0;
      part[a] = high ? parts[a]->end() - 1 : parts[a]->begin();
      place[a] = high ? part[a]->hi : part[a]->lo;
    }
    const double v = f(part, place).value;
    for (std::size_t a = 0; a < 3; ++a) {
      const double width = at[a].range.hi - at[a].range.lo;
      if (width > 0 && at[a].error < detail::infinity)
        alpha[a] += ((bits >> a & 1U) != 0 ? v : -v) / (4 * width);
    }
  }
  for (double& a : alpha) {
    if (!std::isfinite(a)) a = 0;
  }
  RealInterval offset{detail::infinity, -detail::infinity}, range = offset;
  for (const Part& t : *parts[0]) {
    for (const Part& x : *parts[1]) {
      for (const Part& y : *parts[2]) {
        for (std::size_t bits = 0; bits < 8; ++bits) {
          const std::array<double, 3> place{(bits & 1U) != 0 ? t.hi : t.lo, (bits & 2U) != 0 ? x.hi : x.lo,
                                            (bits & 4U) != 0 ? y.hi : y.lo};
          const Bent v = f({&t, &x, &y}, place);
          const double off = 0.125 * v.bend * v.width * v.width;
          const double rest = v.value - (alpha[0] * place[0] + alpha[1] * place[1] + alpha[2] * place[2]);
          offset = hull(offset, {rest - std::max(off, 0.), rest + std::max(-off, 0.)});
          range = hull(range, {v.value - std::max(off, 0.), v.value + std::max(-off, 0.)});
        }
      }
    }
  }
  double size = range.magnitude();
  for (std::size_t a = 0; a < 3; ++a) size += std::abs(alpha[a]) * at[a].range.magnitude();
  const double of_values = range.magnitude() * (share + 0x1p-46), slack = of_values + size * 0x1p-46;
  return linear_enclosure(at, alpha, {offset.lo - slack, offset.hi + slack},
                          {std::max(range.lo - of_values, 0.), range.hi + of_values});
}

}  // namespace reflectree::bent_pieces
