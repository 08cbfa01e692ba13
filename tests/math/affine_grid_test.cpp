// SPDX-License-Identifier: Apache-2.0
// Forms of tabulated functions hold what a look-up returns: random grids, random boxes, points inside.
#include "reflectree/math/affine_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

template <std::size_t d>
struct Grid {
  std::array<GridAxis, d> axes;
  std::array<std::vector<float>, d> places;
  std::vector<float> values;

  float operator()(const std::array<int, d>& node) const {
    std::size_t at = 0;
    for (std::size_t a = 0; a < d; ++a) at = at * std::size_t(axes[a].count) + std::size_t(node[a]);
    return values.at(at);
  }
};

template <std::size_t d>
Grid<d> random_grid(Pcg32& u) {
  Grid<d> grid;
  std::size_t size = 1;
  for (std::size_t a = 0; a < d; ++a) {
    GridAxis& axis = grid.axes[a];
    axis.count = 1 + int(u() % (u() % 3 == 0 ? 40 : 9));
    const auto kind = u() % 3;
    axis.periodic = kind == 1;
    if (kind == 2) {
      float x = 5 * to_unit_float(u()) - 3;
      for (int i = 0; i < axis.count; ++i) grid.places[a].push_back(x += 0.1f + to_unit_float(u()));
      axis.places = grid.places[a];
    }
    size *= std::size_t(axis.count);
  }
  for (std::size_t i = 0; i < size; ++i) grid.values.push_back(20 * to_unit_float(u()) - 5);
  return grid;
}

// The look-up of a program in float, written by itself.
template <std::size_t d>
float look_up(const Grid<d>& grid, std::array<float, d> x) {
  std::array<int, d> low{}, high{};
  std::array<float, d> t{};
  for (std::size_t a = 0; a < d; ++a) {
    const GridAxis& axis = grid.axes[a];
    const int count = axis.count;
    if (axis.periodic) {
      const float base = std::floor(x[a]);
      t[a] = x[a] - base;
      low[a] = ((int(base) % count) + count) % count, high[a] = (low[a] + 1) % count;
      continue;
    }
    int i = 0;
    while (i + 2 < count && x[a] >= float(axis.place(i + 1))) ++i;
    low[a] = i, high[a] = std::min(i + 1, count - 1);
    const float from = float(axis.place(low[a])), to = float(axis.place(high[a]));
    t[a] = to > from ? clamp((x[a] - from) / (to - from), 0.f, 1.f) : 0.f;
  }
  float sum = 0;
  for (std::size_t bits = 0; bits < (std::size_t(1) << d); ++bits) {
    float weight = 1;
    std::array<int, d> node{};
    for (std::size_t a = 0; a < d; ++a) {
      const bool up = (bits >> a & 1U) != 0;
      weight *= up ? t[a] : 1 - t[a], node[a] = up ? high[a] : low[a];
    }
    sum += weight * grid(node);
  }
  return sum;
}

// Coordinates that depend on all variables of a box, and where the float program has them.
struct Coordinate {
  float base, by[2];
  template <class T>
  T operator()(const T& x, const T& y) const {
    return T(base) + (T(by[0]) * x + T(by[1]) * y);
  }
};

constexpr double share = 16 * 0x1p-24;

bool holds(const AffineForm& form, std::array<double, 2> e, double value) {
  if (!form.range.contains(value)) return false;
  if (form.error == detail::infinity) return true;
  return std::abs(value - (form.middle + form.slope[0] * e[0] + form.slope[1] * e[1])) <=
         form.error * (1 + 1e-12);
}

struct Count {
  std::size_t missed = 0, with_slopes = 0, by_ranges = 0;
};
// Of values at points the forms that do not hold them.
template <std::size_t d, class Tamper>
Count look_ups(int boxes, const Tamper& tamper) {
  Pcg32 u(d + 31);
  Count count;
  for (int i = 0; i < boxes; ++i) {
    const Grid<d> grid = random_grid<d>(u);
    const float width = std::exp2(3 - 13 * to_unit_float(u()));
    const AffineForm x = AffineForm::variable(0, 0, double(width)),
                     y = AffineForm::variable(1, 0, double(width));
    std::array<Coordinate, d> coordinate;
    std::array<AffineForm, d> at;
    for (std::size_t a = 0; a < d; ++a) {
      const bool exact = u() % 4 == 0;  // boxes that begin at a node
      const float base = 12 * to_unit_float(u()) - 3;
      coordinate[a] = {exact ? std::floor(base) : base,
                       {4 * to_unit_float(u()) - 2, exact ? 0.f : 4 * to_unit_float(u()) - 2}};
      at[a] = coordinate[a](x, y);
    }
    const GridPieces<d> pieces(grid.axes, at);
    std::array<int, d> counts{};
    for (std::size_t a = 0; a < d; ++a) counts[a] = grid.axes[a].count;
    const GridRanges<d, Grid<d>> ranges(counts, grid);
    AffineForm form = AffineForm::anything_in(ranges.over(pieces.first(), pieces.last()));
    form.range = {form.range.lo - 15 * share, form.range.hi + 15 * share};
    const auto nodes = [&](const std::array<int, d>& first, const std::array<int, d>& last) {
      return ranges.over(first, last);
    };
    const AffineForm own = pieces.interpolated_by_ranges(nodes, share);
    EXPECT_LE(own.range.hi, form.range.hi + 1e-3);
    EXPECT_GE(own.range.lo, form.range.lo - 1e-3);
    if (pieces.are_few()) {
      EXPECT_EQ(pieces.interpolated(grid, share).range, own.range);
    } else {
      ++count.by_ranges;
    }
    form = own;
    // Every other time by the way that looks at all nodes where there are many.
    const bool wraps = std::any_of(grid.axes.begin(), grid.axes.end(), [](const GridAxis& a) { return a.periodic; });
    if (!wraps && i % 2 == 1) form = pieces.interpolated_or_ranged(grid, share);
    count.with_slopes += form.slope[0] != 0;
    form = tamper(form);
    for (int k = 0; k < 8; ++k) {
      const float s = width * (k < 4 ? to_unit_float(u()) : float(u() & 1U));
      const float t = width * (k < 4 ? to_unit_float(u()) : float(u() & 1U));
      std::array<float, d> place{};
      for (std::size_t a = 0; a < d; ++a) place[a] = coordinate[a](s, t);
      const double half = 0.5 * double(width);
      count.missed +=
          !holds(form, {double(s) / half - 1, double(t) / half - 1}, double(look_up(grid, place)));
    }
  }
  return count;
}

TEST(AffineGrid, HoldsWhatIsInterpolated) {
  const auto as_it_is = [](const AffineForm& f) { return f; };
  const Count one = look_ups<1>(6000, as_it_is), two = look_ups<2>(6000, as_it_is),
              three = look_ups<3>(4000, as_it_is);
  EXPECT_EQ(one.missed, 0U);
  EXPECT_EQ(two.missed, 0U);
  EXPECT_EQ(three.missed, 0U);
  EXPECT_GT(three.with_slopes, 2000U);
  EXPECT_GT(three.by_ranges, 50U);
}

TEST(AffineGridTwin, WrongFormsAreFound) {
  const auto by_line = [](AffineForm f) {
    f.range = RealInterval::whole();
    return f;
  };
  EXPECT_GT(look_ups<2>(2000,
                        [&](AffineForm f) {
                          f.error *= 0.5;
                          return by_line(f);
                        })
                .missed,
            0U);
  EXPECT_GT(look_ups<2>(2000,
                        [&](AffineForm f) {
                          f.slope[0] = -f.slope[0];
                          return by_line(f);
                        })
                .missed,
            0U);
  EXPECT_GT(look_ups<2>(2000,
                        [](AffineForm f) {
                          f.range.hi -= 1e-3 * (f.range.hi - f.range.lo), f.error = detail::infinity;
                          return f;
                        })
                .missed,
            0U);
}

// Inside one cell the tube closes in with the square of the width; across a border with the width.
TEST(AffineGrid, TubesCloseIn) {
  Grid<2> grid;
  grid.axes[0].count = grid.axes[1].count = 3;
  grid.values = {1, 2, 4, 3, 5, 4, 2, 7, 1};
  const auto error_at = [&](double middle, double width) {
    const AffineForm x = AffineForm::variable(0, middle - width, middle + width);
    const AffineForm y = AffineForm::variable(1, middle - width, middle + width);
    return GridPieces<2>(grid.axes, {x, y}).interpolated(grid, 0).error;
  };
  EXPECT_LT(error_at(0.5, 0.01), 0.26 * error_at(0.5, 0.02));
  EXPECT_LT(error_at(1, 0.01), 0.51 * error_at(1, 0.02));
}

// Small boxes exactly, large ones by blocks that reach a little further; around the seam.
TEST(AffineGrid, RangesOfBoxesOfNodes) {
  Pcg32 u(5);
  const std::array<int, 3> counts{19, 30, 23};
  std::vector<float> values(19 * 30 * 23);
  for (float& v : values) v = to_unit_float(u());
  const auto value = [&](const std::array<int, 3>& i) {
    return values[std::size_t((i[0] * 30 + i[1]) * 23 + i[2])];
  };
  const GridRanges<3, decltype(value)> ranges(counts, value);
  EXPECT_EQ(ranges.over({0, 0, 0}, {18, 29, 22}),
            RealInterval(double(*std::min_element(values.begin(), values.end())),
                         double(*std::max_element(values.begin(), values.end()))));
  int exact = 0;
  for (int k = 0; k < 300; ++k) {
    std::array<int, 3> first{}, last{};
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = int(u() % unsigned(counts[a])) - (a == 2 ? 10 : 0);
      last[a] = first[a] + int(u() % 9);
      if (a < 2) last[a] = std::min(last[a], counts[a] - 1);
    }
    RealInterval wanted{2, -2};
    for (int i = first[0]; i <= last[0]; ++i) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int p = first[2]; p <= last[2]; ++p) {
          const double v = double(value({i, j, (p + 23) % 23}));
          wanted = hull(wanted, {v, v});
        }
      }
    }
    const RealInterval found = ranges.over(first, last);
    EXPECT_TRUE(found.contains(wanted));
    exact += found == wanted;
  }
  EXPECT_GT(exact, 100);
}

TEST(AffineGrid, CellsThatHoldACoordinate) {
  const auto is = [](RealInterval x, int first, int last) {
    const CellRange cells = cells_of(x, 5);
    return cells.first == first && cells.last == last;
  };
  EXPECT_TRUE(is({0.5, 0.7}, 0, 0));
  EXPECT_TRUE(is({0.5, 3}, 0, 3));
  EXPECT_TRUE(is({-7, 70}, 0, 4));
  EXPECT_TRUE(is(RealInterval::whole(), 0, 4));
}

}  // namespace
}  // namespace reflectree
