// SPDX-License-Identifier: Apache-2.0
// Forms of functions that are nearly multilinear between nodes, as integrals of linear densities are: like
// affine_grid.hpp, with what a function has beyond that.
#pragma once

#include <array>

#include "reflectree/math/affine_grid.hpp"

namespace reflectree::bent_pieces {

// Where a range begins, passes nodes, and ends: node, the next one, and the share of that. Beyond the first and the last
// node nothing changes.
struct Cut {
  double at;
  int node;
  double share;
};
class Cuts {
 public:
  static constexpr std::size_t most = 140;
  // node(i): where node i lies.
  template <class Node>
  Cuts(RealInterval x, int nodes, const Node& node) {
    const auto add = [&](double at, int i) {
      const double from = node(i);
      cuts_[count_++] = {at, i, std::clamp((at - from) / (node(i + 1) - from), 0., 1.)};
    };
    int i = 0;
    while (i < nodes - 2 && node(i + 1) <= x.lo) ++i;
    add(x.lo, i);
    if (x.lo < node(0) && x.hi > node(0)) add(node(0), 0);
    for (++i; i < nodes && node(i) < x.hi; ++i) {
      if (node(i) <= x.lo) continue;
      if (count_ + 2 > most) {
        few_ = false;
        return;
      }
      add(node(i), std::min(i, nodes - 2));
    }
    if (x.hi > x.lo) add(x.hi, cuts_[count_ - 1].node);
  }
  bool are_few() const { return few_; }
  std::size_t size() const { return count_; }
  std::size_t parts() const { return count_ > 1 ? count_ - 1 : 1; }
  const Cut& operator[](std::size_t i) const { return cuts_[i]; }
  double width(std::size_t part) const { return count_ > 1 ? cuts_[part + 1].at - cuts_[part].at : 0; }

 private:
  std::array<Cut, most> cuts_;
  std::size_t count_ = 0;
  bool few_ = true;
};

template <std::size_t n>
using Index = std::array<std::size_t, n>;

// visit(index) of all below the counts.
template <std::size_t n, class Visit>
void for_each_index(const Index<n>& counts, const Visit& visit) {
  Index<n> i{};
  for (bool more = true; more;) {
    visit(i);
    more = false;
    for (std::size_t a = n; a-- > 0 && !more;) {
      more = ++i[a] < counts[a];
      if (!more) i[a] = 0;
    }
  }
}

// A function at a corner of a part. Along one axis it may be a quadratic, by `off` below its chord in the middle.
struct Bent {
  double value, off;
};
// In each part the function is within `apart` of what is multilinear between Bent numbers at its corners:
//   f(part, corner), apart(part): indices of parts and of cuts.
// The program errs by `share` of the largest number. Nothing is negative.
template <std::size_t n, class F, class Apart>
AffineForm enclosed(const std::array<const Cuts*, n>& cuts, const std::array<AffineForm, n>& at, const F& f,
                    const Apart& apart, double share) {
  constexpr std::size_t corners = std::size_t(1) << n;
  const auto corner_of = [&](const Index<n>& part, std::size_t bits) {
    Index<n> corner = part;
    for (std::size_t a = 0; a < n; ++a) corner[a] = std::min(part[a] + (bits >> a & 1U), cuts[a]->size() - 1);
    return corner;
  };
  std::array<double, n> alpha{};
  Index<n> counts, ends;
  for (std::size_t a = 0; a < n; ++a) counts[a] = cuts[a]->parts();
  for (std::size_t bits = 0; bits < corners; ++bits) {
    for (std::size_t a = 0; a < n; ++a) ends[a] = (bits >> a & 1U) != 0 ? counts[a] - 1 : 0;
    const double v = f(ends, corner_of(ends, bits)).value;
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
  for_each_index(counts, [&](const Index<n>& part) {
    const double more = apart(part);
    for (std::size_t bits = 0; bits < corners; ++bits) {
      const Index<n> corner = corner_of(part, bits);
      const Bent v = f(part, corner);
      const double low = v.value - std::max(v.off, 0.) - more, high = v.value + std::max(-v.off, 0.) + more;
      double line = 0;
      for (std::size_t a = 0; a < n; ++a) line += alpha[a] * (*cuts[a])[corner[a]].at;
      offset = hull(offset, {low - line, high - line}), range = hull(range, {low, high});
    }
  });
  double size = range.magnitude();
  for (std::size_t a = 0; a < n; ++a) size += std::abs(alpha[a]) * at[a].range.magnitude();
  const double of_values = range.magnitude() * (share + 0x1p-46), slack = of_values + size * 0x1p-46;
  return linear_enclosure(at, alpha, {offset.lo - slack, offset.hi + slack},
                          {std::max(range.lo - of_values, 0.), range.hi + of_values});
}

}  // namespace reflectree::bent_pieces
