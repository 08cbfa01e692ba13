// SPDX-License-Identifier: Apache-2.0
// Forms of functions that are quadratic between nodes, as integrals of linear densities are: like affine_grid.hpp,
// with what a curve has beyond its chord.
#pragma once

#include <array>

#include "reflectree/math/affine_grid.hpp"

namespace reflectree::bent_pieces {

// The parts into which nodes cut a range; beyond the first and the last node nothing changes.
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
    const double first = node(0), end = node(nodes - 1);
    if (x.lo < first) add({x.lo, std::min(x.hi, first), 0, first, node(1)});
    for (int i = 0; i + 1 < nodes; ++i) {
      const double from = node(i), to = node(i + 1);
      if (to <= x.lo && (i + 2 < nodes || to < x.lo)) continue;
      if (from >= x.hi && count_ > 0) break;
      add({std::max(from, x.lo), std::min(to, x.hi), i, from, to});
    }
    if (x.hi > end) add({std::max(x.lo, end), x.hi, nodes - 2, node(nodes - 2), end});
  }
  bool are_few() const { return few_; }
  const Part* begin() const { return parts_.data(); }
  const Part* end() const { return parts_.data() + count_; }
  std::size_t size() const { return count_; }

 private:
  void add(const Part& part) {
    if (count_ == most) {
      few_ = false;
    } else {
      parts_[count_++] = part;
    }
  }

  std::array<Part, most> parts_{};
  std::size_t count_ = 0;
  bool few_ = true;
};

// A function of n coordinates that is at most quadratic along one of them, and linear along each of the others, in each
// part: `bend` is its second difference there, for a whole cell. Less its chord it reaches an eighth of that, times
// the square of the part's width.
struct Bent {
  double value, bend, width;
};
// f(parts, places), not negative; the program errs by `share` of the largest.
template <std::size_t n, class F>
AffineForm enclosed(const std::array<const Parts*, n>& parts, const std::array<AffineForm, n>& at, const F& f,
                    double share) {
  constexpr std::size_t corners = std::size_t(1) << n;
  std::array<double, n> alpha{};
  for (std::size_t bits = 0; bits < corners; ++bits) {
    std::array<const Part*, n> part;
    std::array<double, n> place;
    for (std::size_t a = 0; a < n; ++a) {
      const bool high = (bits >> a & 1U) != 0;
      part[a] = high ? parts[a]->end() - 1 : parts[a]->begin();
      place[a] = high ? part[a]->hi : part[a]->lo;
    }
    const double v = f(part, place).value;
    for (std::size_t a = 0; a < n; ++a) {
      const double width = at[a].range.hi - at[a].range.lo;
      if (width > 0 && at[a].error < detail::infinity)
        alpha[a] += ((bits >> a & 1U) != 0 ? v : -v) / (0.5 * double(corners) * width);
    }
  }
  for (double& a : alpha) {
    if (!std::isfinite(a)) a = 0;
  }
  RealInterval offset{detail::infinity, -detail::infinity}, range = offset;
  std::array<const Part*, n> part;
  for (std::size_t a = 0; a < n; ++a) part[a] = parts[a]->begin();
  for (bool more = true; more;) {
    for (std::size_t bits = 0; bits < corners; ++bits) {
      std::array<double, n> place;
      double line = 0;
      for (std::size_t a = 0; a < n; ++a) {
        place[a] = (bits >> a & 1U) != 0 ? part[a]->hi : part[a]->lo;
        line += alpha[a] * place[a];
      }
      const Bent v = f(part, place);
      const double off = 0.125 * v.bend * v.width * v.width, rest = v.value - line;
      offset = hull(offset, {rest - std::max(off, 0.), rest + std::max(-off, 0.)});
      range = hull(range, {v.value - std::max(off, 0.), v.value + std::max(-off, 0.)});
    }
    more = false;
    for (std::size_t a = n; a-- > 0 && !more;) {
      more = ++part[a] != parts[a]->end();
      if (!more) part[a] = parts[a]->begin();
    }
  }
  double size = range.magnitude();
  for (std::size_t a = 0; a < n; ++a) size += std::abs(alpha[a]) * at[a].range.magnitude();
  const double of_values = range.magnitude() * (share + 0x1p-46), slack = of_values + size * 0x1p-46;
  return linear_enclosure(at, alpha, {offset.lo - slack, offset.hi + slack},
                          {std::max(range.lo - of_values, 0.), range.hi + of_values});
}

}  // namespace reflectree::bent_pieces
