// SPDX-License-Identifier: Apache-2.0
// V^-1 of RGL tables over boxes. Below a row of the warp, sy is linear in the coordinates of wo, and a quadratic
// of y between rows. Along the rows, sx is a quotient of two means,
//
//   sx(x) = sum w A(x) / sum w M,    A(x): mass of a row up to x, M: all of it,
//
// w the weights of the nodes about (wo, y). Both sums are linear in each of these coordinates between nodes. So
// between corners sx is a mean of what it is there, with the weights w M, which do not depend on x: its extremes are
// at corners. The mean by w alone is linear in each coordinate, and differs from this by no more than
//
//   D (sqrt r - 1) / (sqrt r + 1),    D: how far apart the corners are, r: the ratio of their masses,
//
// which falls with the square of the part's width. Along x a corner's value is a quadratic, and ascends.
#pragma once

#include <array>

#include "bent_pieces.hpp"
#include "rgl_places.hpp"

namespace reflectree {

// `known`: coordinates of wo that the table knows.
template <class Table, std::size_t known>
class RglUnwarp {
 public:
  using KnownForms = std::array<AffineForm, known>;

  explicit RglUnwarp(const Table& table) : slices_{table} {}

  // Each in [0, 1], from a place in cells of the warp.
  Vec2<AffineForm> operator()(const KnownForms& wo, const AffineForm& x, const AffineForm& y) const {
    const GridSize size = slices_.warp_size();
    const auto unit = [](int i) { return double(i); };
    const auto at_node = [](const std::vector<float>& nodes) {
      return [&nodes](int i) { return double(nodes[std::size_t(i)]); };
    };
    const Cuts of_theta(wo[0].range, int(slices_.theta_o().size()), at_node(slices_.theta_o()));
    const Cuts of_y(y.range, size.height, unit), of_x(x.range, size.width, unit);
    if constexpr (known == 1) {
      return enclosed({&of_theta, &of_y}, {wo[0], y}, of_x, x);
    } else {
      const Cuts of_phi(wo[1].range, int(slices_.phi_o().size()), at_node(slices_.phi_o()));
      return enclosed({&of_theta, &of_phi, &of_y}, {wo[0], wo[1], y}, of_x, x);
    }
  }

 private:
  using Cut = bent_pieces::Cut;
  using Cuts = bent_pieces::Cuts;
  using Bent = bent_pieces::Bent;
  static constexpr std::size_t n = known + 1;  // coordinates of wo, and y
  using Index = bent_pieces::Index<n>;
  using FullIndex = bent_pieces::Index<n + 1>;  // and x
  using LineCuts = std::array<const Cuts*, n>;
  static constexpr double u = 0x1p-24;

  // Lines go along x at corners of wo and y, and have a value of sx at each column.
  struct Line {
    double root_of_mass;
    double below, bend;  // sy; its second difference up to the next y
  };
  struct Lines {
    static constexpr std::size_t most = 800, most_values = 1600;
    std::array<const Cut*, Cuts::most> column;
    std::size_t columns = 0;
    std::array<Line, most> line;
    std::array<Bent, most_values> value;  // of columns, line by line
  };

  template <class Corner>
  static std::size_t line_at(const LineCuts& cuts, const Corner& corner) {
    std::size_t index = 0;
    for (std::size_t a = 0; a < n; ++a) index = index * cuts[a]->size() + corner[a];
    return index;
  }

  Vec2<AffineForm> enclosed(const LineCuts& cuts, const std::array<AffineForm, n>& at, const Cuts& of_x,
                            const AffineForm& x) const;
  void measure(const LineCuts& cuts, const Index& corner, const Lines& of, Line& line, Bent* values) const;
  // visit(slice, weight) of the nodes about a corner of wo.
  template <class Visit>
  void for_each_slice(const LineCuts& cuts, const Index& corner, const Visit& visit) const {
    for (std::size_t bits = 0; bits < (std::size_t(1) << known); ++bits) {
      double weight = 1;
      int slice = 0, stride = 1;
      for (std::size_t a = 0; a < known; ++a) {
        const Cut& cut = (*cuts[a])[corner[a]];
        const bool next = (bits >> a & 1U) != 0;
        weight *= next ? cut.share : 1 - cut.share;
        slice += stride * (cut.node + int(next)), stride *= int(slices_.theta_o().size());
      }
      if (weight != 0) visit(slice, weight);
    }
  }
  static AffineForm below(const LineCuts& cuts, const std::array<AffineForm, n>& at, const Lines& of);
  static AffineForm along(const LineCuts& cuts, const std::array<AffineForm, n>& at, const Cuts& of_x,
                          const AffineForm& x, const Lines& of);

  RglSlices<Table> slices_;
};

template <class Table, std::size_t known>
Vec2<AffineForm> RglUnwarp<Table, known>::enclosed(const LineCuts& cuts, const std::array<AffineForm, n>& at,
                                                   const Cuts& of_x, const AffineForm& x) const {
  Index sizes;
  std::size_t count = 1;
  bool few = of_x.are_few();
  for (std::size_t a = 0; a < n; ++a) {
    few = few && cuts[a]->are_few();
    sizes[a] = cuts[a]->size(), count *= sizes[a];
  }
  if (!few || count > Lines::most) {
    const AffineForm any = AffineForm::anything_in({0, 1});
    return {any, any};
  }
  // Of many columns the first and the last, which tell the range.
  Lines of;
  const bool all = count * of_x.size() <= Lines::most_values;
  for (std::size_t k = 0; k < of_x.size(); ++k) {
    if (all || k == 0 || k + 1 == of_x.size()) of.column[of.columns++] = &of_x[k];
  }
  RealInterval range{detail::infinity, -detail::infinity};
  std::size_t next = 0;
  bent_pieces::for_each_index(sizes, [&](const Index& corner) {
    Bent* const values = &of.value[next * of.columns];
    measure(cuts, corner, of, of.line[next++], values);
    range = hull(range, {values[0].value, values[of.columns - 1].value});
  });
  constexpr double share = 72 * u;
  const RealInterval rounded{std::max(range.lo * (1 - share), 0.), range.hi * (1 + share)};
  AffineForm sx = all ? along(cuts, at, of_x, x, of) : AffineForm::anything_in(rounded);
  sx.range = intersection(sx.range, rounded);
  return {rgl_places::within(sx, 0, 2), rgl_places::within(below(cuts, at, of), 0, 2)};
}

template <class Table, std::size_t known>
void RglUnwarp<Table, known>::measure(const LineCuts& cuts, const Index& corner, const Lines& of, Line& line,
                                      Bent* values) const {
  const Cut& y = (*cuts[known])[corner[known]];
  const double b = y.share;
  double mass = 0;
  line.below = line.bend = 0;
  for (std::size_t k = 0; k < of.columns; ++k) values[k] = {0, 0};
  for_each_slice(cuts, corner, [&](int slice, double weight) {
    const WarpLine row = slices_.row(slice, y.node);
    const double m0 = row.mass, m1 = slices_.row(slice, y.node + 1).mass;
    line.below += weight * (row.cdf + b * (m0 + 0.5 * b * (m1 - m0))), line.bend += weight * (m1 - m0);
    mass += weight * ((1 - b) * m0 + b * m1);
    for (const int next : {0, 1}) {
      const double w = weight * (next ? b : 1 - b);
      if (w == 0) continue;
      for (std::size_t k = 0; k < of.columns; ++k) {
        const Cut& x = *of.column[k];
        const WarpPoint node = slices_.warp(slice, y.node + next, x.node);
        const double a = x.share, p0 = node.pdf, p1 = slices_.warp(slice, y.node + next, x.node + 1).pdf;
        values[k].value += w * (node.cdf + a * (p0 + 0.5 * a * (p1 - p0))), values[k].off += w * (p1 - p0);
      }
    }
  });
  line.root_of_mass = std::sqrt(mass);
  // Where nothing is visible V^-1 leads to 0.
  const double by_mass = mass > 0 ? 1 / mass : 0;
  for (std::size_t k = 0; k < of.columns; ++k) {
    const double width = k + 1 < of.columns ? of.column[k + 1]->at - of.column[k]->at : 0;
    values[k].value *= by_mass, values[k].off *= 0.125 * width * width * by_mass;
  }
}

template <class Table, std::size_t known>
AffineForm RglUnwarp<Table, known>::below(const LineCuts& cuts, const std::array<AffineForm, n>& at,
                                          const Lines& of) {
  const auto f = [&](const Index& part, const Index& corner) {
    Index start = corner;
    start[known] = part[known];
    const double width = cuts[known]->width(part[known]);
    return Bent{of.line[line_at(cuts, corner)].below,
                0.125 * width * width * of.line[line_at(cuts, start)].bend};
  };
  return bent_pieces::enclosed<n>(
      cuts, at, f, [](const Index&) { return 0.; }, 32 * u);
}

template <class Table, std::size_t known>
AffineForm RglUnwarp<Table, known>::along(const LineCuts& cuts, const std::array<AffineForm, n>& at,
                                          const Cuts& of_x, const AffineForm& x, const Lines& of) {
  const auto value = [&](const FullIndex& corner, std::size_t column) -> const Bent& {
    return of.value[line_at(cuts, corner) * of.columns + std::min(column, of.columns - 1)];
  };
  const auto f = [&](const FullIndex& part, const FullIndex& corner) {
    return Bent{value(corner, corner[n]).value, value(corner, part[n]).off};
  };
  const auto apart = [&](const FullIndex& part) {
    RealInterval root{detail::infinity, -detail::infinity}, first = root, last = root, off = root;
    for (std::size_t bits = 0; bits < (std::size_t(1) << n); ++bits) {
      FullIndex corner = part;
      for (std::size_t a = 0; a < n; ++a)
        corner[a] = std::min(part[a] + (bits >> a & 1U), cuts[a]->size() - 1);
      const Bent &from = value(corner, part[n]), &to = value(corner, part[n] + 1);
      const double r = of.line[line_at(cuts, corner)].root_of_mass;
      root = hull(root, {r, r}), off = hull(off, {from.off, from.off});
      first = hull(first, {from.value, from.value}), last = hull(last, {to.value, to.value});
    }
    const double farthest = std::max(first.hi - first.lo, last.hi - last.lo) + off.hi - off.lo;
    return root.hi > root.lo ? farthest * (root.hi - root.lo) / (root.hi + root.lo) : 0;
  };
  std::array<const Cuts*, n + 1> all;
  std::array<AffineForm, n + 1> forms;
  std::copy(cuts.begin(), cuts.end(), all.begin()), std::copy(at.begin(), at.end(), forms.begin());
  all[n] = &of_x, forms[n] = x;
  return bent_pieces::enclosed<n + 1>(all, forms, f, apart, 72 * u);
}

}  // namespace reflectree
