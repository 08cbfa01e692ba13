// SPDX-License-Identifier: Apache-2.0
// Functions that are tabulated over a grid of one to three coordinates, as affine forms of these coordinates:
// piecewise multilinear and piecewise constant ones.
//
// Over a box a multilinear function less a linear one takes its extremes at the corners. So the values at the
// corners of the pieces, into which borders of cells cut the box, say how far the function is from a line: by
// the square of the width inside one cell, by the change of slope where the box holds a border.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "reflectree/math/affine_form.hpp"

namespace reflectree {

// The nodes of one coordinate.
struct GridAxis {
  int count = 1;
  bool periodic = false;               // node i + count is node i; places 0, 1, 2, ... only
  std::span<const float> places = {};  // where the nodes lie, ascending; empty: at 0, 1, 2, ...

  double place(int i) const { return places.empty() ? double(i) : double(places[std::size_t(i)]); }
  // Of nodes in a row, which may lie beyond the first and the last, those that are meant.
  int node(int i) const { return periodic ? (i % count + count) % count : std::clamp(i, 0, count - 1); }
  // The first node beyond x, -1 to count + 1 or so where nothing repeats.
  int beyond(double x) const;
};

// alpha . x + [offset], which hold a function of the coordinates x; `range`: all its values.
AffineForm linear_enclosure(std::span<const AffineForm> x, std::span<const double> alpha, RealInterval offset,
                            RealInterval range);

// The pieces into which the nodes cut a box of coordinates, to be used for all channels of a table. most: places
// along one axis.
template <std::size_t d, int most = 16>
class GridPieces {
 public:
  using Node = std::array<int, d>;

  // axes and `at` are kept by value; a span of places must outlive the pieces.
  GridPieces(const std::array<GridAxis, d>& axes, const std::array<AffineForm, d>& at)
      : axes_(axes), at_(at) {
    for (std::size_t a = 0; a < d; ++a) cut(a);
  }

  // The nodes that interpolation may touch, first to last along each axis, both included; beyond the count of
  // a periodic axis they go on from the beginning.
  const Node& first() const { return first_; }
  const Node& last() const { return last_; }
  // Whether there are so few pieces that each is looked at. Along an axis that has more, the range of the
  // nodes stands for each of them.
  bool are_few() const {
    return std::none_of(many_.begin(), many_.end(), [](bool many) { return many; });
  }

  // Whether, beyond that, few nodes are touched.
  bool touches_few() const {
    int volume = 1;
    for (std::size_t a = 0; a < d; ++a) volume *= last_[a] - first_[a] + 1;
    return are_few() && volume < 500;
  }

  // Of the function that is multilinear between the nodes and constant beyond them. nodes(first, last)
  // returns the RealInterval of the nodes of a box, most often of one. The program's interpolation may err by
  // `share` of the largest node that it touches.
  template <class Nodes>
  AffineForm interpolated_by_ranges(const Nodes& nodes, double share) const;
  // Of a scalar that many functions are reduced to, each of which is multilinear. In each piece it must lie between two
  // multilinear functions, of which value() tells the values at a corner:
  //   reduction.clear(), then reduction.add(node, weight) for the nodes about the corner, then reduction.value()
  // size(node): no less than what the scalar may change by where all functions change by what they are at the node.
  // For few pieces.
  template <class Reduction>
  AffineForm reduced(Reduction& reduction, double share) const {
    return by_corners(
        [&](const std::array<int, d>& at, double& largest) {
          reduction.clear();
          for_each_node(at, [&](const Node& node, const Node&, double weight) {
            reduction.add(node, weight);
            largest = std::max(largest, reduction.size(node));
          });
          return reduction.value();
        },
        share);
  }
  // The same for few pieces; value(node) returns a float.
  template <class Value>
  AffineForm interpolated(const Value& value, double share) const {
    return interpolated_by_ranges(
        [&](const Node& node, const Node&) {
          const double v = double(value(node));
          return RealInterval(v, v);
        },
        share);
  }
  // The same where there may be many, on axes that are not periodic: then the range of all nodes.
  template <class Value>
  AffineForm interpolated_or_ranged(const Value& value, double share) const {
    if (touches_few()) return interpolated(value, share);
    RealInterval range{detail::infinity, -detail::infinity};
    Node node = first_;
    for (bool more = true; more;) {
      const auto v = double(value(node));
      range = hull(range, RealInterval(v, v));
      more = false;
      for (std::size_t a = d; a-- > 0 && !more;) {
        more = ++node[a] <= last_[a];
        if (!more) node[a] = first_[a];
      }
    }
    const double slack = share * range.magnitude();
    return AffineForm::anything_in({range.lo - slack, range.hi + slack});
  }

 private:
  struct Place {
    double x, fraction;
    int low, high;
  };

  void cut(std::size_t a) {
    const GridAxis& axis = axes_[a];
    const RealInterval x = at_[a].range;
    const auto give_up = [&](int first, int last) {
      if (axis.periodic && last - first >= axis.count) first = 0, last = axis.count - 1;
      first_[a] = first, last_[a] = last;
      many_[a] = true, count_[a] = 1;
      place_[a][0] = {0, 0, first, first};
    };
    if (!(x.lo >= -1e6 && x.hi <= 1e6)) return give_up(0, axis.count - 1);  // nothing is known of it
    const int begin = axis.beyond(x.lo);
    const int first = axis.periodic ? begin - 1 : axis.node(begin - 1);
    const int end = axis.beyond(x.hi);
    if (end - begin > most - 2) return give_up(first, axis.periodic ? end : axis.node(end));
    int i = begin;
    add(a, x.lo, i);
    for (; (axis.periodic || i < axis.count) && axis.place(i) < x.hi; ++i)
      place_[a][std::size_t(count_[a]++)] = {axis.place(i), 0, axis.node(i), axis.node(i)};
    if (x.hi > x.lo) add(a, x.hi, i);
    first_[a] = first, last_[a] = axis.periodic ? i : axis.node(i);
    if (axis.periodic && i - first >= axis.count) first_[a] = 0, last_[a] = axis.count - 1;
  }
  // A place between nodes i - 1 and i.
  void add(std::size_t a, double x, int i) {
    const GridAxis& axis = axes_[a];
    const int low = axis.node(i - 1), high = axis.node(i);
    const bool between = low != high;
    const double from = !between ? x : axis.periodic ? double(i - 1) : axis.place(low);
    const double to = axis.periodic ? double(i) : axis.place(high);
    place_[a][std::size_t(count_[a]++)] = {x, between ? (x - from) / (to - from) : 0, low, high};
  }

  // visit(first, last, weight) of the nodes, or ranges of nodes, about the place where places at[a] meet.
  template <class Visit>
  void for_each_node(const std::array<int, d>& at, const Visit& visit) const {
    for (std::size_t bits = 0; bits < (std::size_t(1) << d); ++bits) {
      double weight = 1;
      Node first{}, last{};
      for (std::size_t a = 0; a < d; ++a) {
        const Place& p = place_[a][std::size_t(at[a])];
        const bool high = (bits >> a & 1U) != 0;
        weight *= high ? p.fraction : 1 - p.fraction;
        first[a] = high ? p.high : p.low;
        last[a] = many_[a] ? last_[a] : first[a];
      }
      if (weight != 0) visit(first, last, weight);
    }
  }
  // The function between what corner(at, largest) tells where places at[a] meet; `largest` grows to what rounds.
  template <class Corner>
  AffineForm by_corners(const Corner& corner, double share) const;

  std::array<GridAxis, d> axes_;
  std::array<AffineForm, d> at_;
  std::array<std::array<Place, most>, d> place_;
  std::array<int, d> count_{};
  Node first_{}, last_{};
  std::array<bool, d> many_{};
};

template <std::size_t d, int most>
template <class Nodes>
AffineForm GridPieces<d, most>::interpolated_by_ranges(const Nodes& nodes, double share) const {
  return by_corners(
      [&](const std::array<int, d>& at, double& largest) {
        double lo = 0, hi = 0;
        for_each_node(at, [&](const Node& first, const Node& last, double weight) {
          const RealInterval v = nodes(first, last);
          largest = std::max(largest, v.magnitude());
          lo += weight * v.lo, hi += weight * v.hi;
        });
        return RealInterval(lo, hi);
      },
      share);
}

template <std::size_t d, int most>
template <class Corner>
AffineForm GridPieces<d, most>::by_corners(const Corner& corner, double share) const {
  constexpr std::size_t corners = std::size_t(1) << d;
  double largest = 0;
  // Slopes: along each axis the mean rise of the box's edges.
  std::array<double, d> alpha{};
  std::array<RealInterval, corners> outer;
  for (std::size_t bits = 0; bits < corners; ++bits) {
    std::array<int, d> at{};
    for (std::size_t a = 0; a < d; ++a) at[a] = (bits >> a & 1U) != 0 ? count_[a] - 1 : 0;
    outer[bits] = corner(at, largest);
    const double v = outer[bits].middle();
    for (std::size_t a = 0; a < d; ++a) {
      const double width = at_[a].range.hi - at_[a].range.lo;
      if (width > 0 && !many_[a] && at_[a].error < detail::infinity)
        alpha[a] += ((bits >> a & 1U) != 0 ? v : -v) / (width * 0.5 * double(corners));
    }
  }
  for (double& s : alpha) {
    if (!std::isfinite(s)) s = 0;
  }
  RealInterval offset{detail::infinity, -detail::infinity}, range = offset;
  std::array<int, d> at{};
  for (bool more = true; more;) {
    std::size_t bits = 0;
    bool is_outer = true;
    double line = 0;
    for (std::size_t a = 0; a < d; ++a) {
      line += alpha[a] * place_[a][std::size_t(at[a])].x;
      if (at[a] > 0) bits |= std::size_t(1) << a, is_outer = is_outer && at[a] == count_[a] - 1;
    }
    const RealInterval v = is_outer ? outer[bits] : corner(at, largest);
    offset = hull(offset, RealInterval(v.lo - line, v.hi - line)), range = hull(range, v);
    more = false;
    for (std::size_t a = 0; a < d && !more; ++a) {
      more = ++at[a] < count_[a];
      if (!more) at[a] = 0;
    }
  }
  // The doubles here err by less than 2^-46 of the largest term.
  double size = largest;
  for (std::size_t a = 0; a < d; ++a) {
    if (alpha[a] != 0) size += std::abs(alpha[a]) * at_[a].range.magnitude();
  }
  const double slack = share * largest + size * 0x1p-46,
               slack_of_values = share * largest + largest * 0x1p-46;
  return linear_enclosure(at_, alpha, {offset.lo - slack, offset.hi + slack},
                          {range.lo - slack_of_values, range.hi + slack_of_values});
}

// The cells that hold a coordinate, of `count` cells as wide as 1, of which the outermost go on for ever.
struct CellRange {
  int first, last;
};
inline CellRange cells_of(RealInterval x, int count) {
  const double most = double(count - 1);
  return {int(std::clamp(std::floor(std::max(x.lo, 0.)), 0., most)),
          int(std::clamp(std::floor(std::max(x.hi, 0.)), 0., most))};
}

// Minima and maxima over boxes of nodes: small boxes node by node, larger ones by a pyramid of blocks, some
// of which reach beyond the box. value(node) as in GridPieces; it is kept.
template <std::size_t d, class Value>
class GridRanges {
 public:
  using Node = std::array<int, d>;

  GridRanges(const Node& counts, Value value) : value_(std::move(value)), counts_(counts) {
    Node size = counts;
    const auto largest = [](const Node& n) { return *std::max_element(n.begin(), n.end()); };
    while (largest(size) > 1) {
      Level next;
      for (std::size_t a = 0; a < d; ++a) next.size[a] = (size[a] + 1) / 2;
      next.blocks.resize(std::size_t(volume({}, minus_one(next.size))), Block{});
      for_each({}, minus_one(size), [&](const Node& i) {
        Node half = i;
        for (int& v : half) v /= 2;
        Block& block = next.blocks[index(next.size, half)];
        const Block own = levels_.empty() ? of(i) : levels_.back().blocks[index(size, i)];
        block = {std::min(block.lo, own.lo), std::max(block.hi, own.hi)};
      });
      size = next.size;
      levels_.push_back(std::move(next));
    }
  }

  // Of the nodes from first to last, both included. Beyond the count they go on from the beginning.
  RealInterval over(Node first, Node last) const {
    for (std::size_t a = 0; a < d; ++a) {
      const int n = counts_[a];
      if (last[a] - first[a] + 1 >= n) first[a] = 0, last[a] = n - 1;
      const int turn = (first[a] % n + n) % n - first[a];
      first[a] += turn, last[a] += turn;
      if (last[a] < n) continue;
      Node end = last, begin = first;
      end[a] = n - 1, begin[a] = 0, last[a] -= n;
      return hull(over(first, end), over(begin, last));
    }
    constexpr std::int64_t most = 256;  // nodes or blocks to look at
    std::size_t level = 0;
    while (volume(first, last) > most && level < levels_.size()) {
      ++level;
      for (std::size_t a = 0; a < d; ++a) first[a] /= 2, last[a] /= 2;
    }
    RealInterval range{detail::infinity, -detail::infinity};
    for_each(first, last, [&](const Node& i) {
      const Block b = level == 0 ? of(i) : levels_[level - 1].blocks[index(levels_[level - 1].size, i)];
      range = hull(range, RealInterval(double(b.lo), double(b.hi)));
    });
    return range;
  }

 private:
  using Number = std::invoke_result_t<const Value&, const Node&>;
  struct Block {
    Number lo = std::numeric_limits<Number>::infinity(), hi = -lo;
  };
  struct Level {
    Node size;
    std::vector<Block> blocks;
  };

  Block of(const Node& i) const {
    const Number v = value_(i);
    return {v, v};
  }
  static Node minus_one(Node n) {
    for (int& v : n) --v;
    return n;
  }
  static std::int64_t volume(const Node& first, const Node& last) {
    std::int64_t product = 1;
    for (std::size_t a = 0; a < d; ++a) product *= last[a] - first[a] + 1;
    return product;
  }
  static std::size_t index(const Node& size, const Node& i) {
    std::size_t at = 0;
    for (std::size_t a = 0; a < d; ++a) at = at * std::size_t(size[a]) + std::size_t(i[a]);
    return at;
  }
  template <class Visit>
  static void for_each(const Node& first, const Node& last, const Visit& visit) {
    Node i = first;
    for (bool more = true; more;) {
      visit(i);
      more = false;
      for (std::size_t a = d; a-- > 0 && !more;) {
        more = ++i[a] <= last[a];
        if (!more) i[a] = first[a];
      }
    }
  }

  Value value_;
  Node counts_;
  std::vector<Level> levels_;
};

}  // namespace reflectree
