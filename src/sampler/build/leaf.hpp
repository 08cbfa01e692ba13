// SPDX-License-Identifier: Apache-2.0
// A leaf of a tree under construction: its cell of the square, the grid on which T is looked at, and what
// both modes conclude from it: the shape of bound or density, its cost, and the axis to split.
#pragma once

#include <cstdint>
#include <span>

#include "field.hpp"

namespace reflectree::detail {

// A dyadic cell of the square: x in [ix, ix + 1] / 2^level_x of the width, the same for y.
struct DyadicCell {
  std::uint32_t ix = 0, iy = 0;
  std::uint8_t level_x = 0, level_y = 0;
};
// No leaf keeps less than this share of the slab's mean density: none loses support.
inline constexpr float floor_share = 1e-3f;
inline constexpr int max_level = 15;  // locations pack into 16 bits per axis

struct Box {  // in square coordinates
  float x0, y0, width, height;
};
inline Box box_of(const DyadicCell& cell, const Domain& domain) {
  const SquareCell root = root_cell(domain.symmetry);
  const float wx = 2.f / float(1U << cell.level_x), wy = (root.y1 - root.y0) / float(1U << cell.level_y);
  return {-1 + float(cell.ix) * wx, root.y0 + float(cell.iy) * wy, wx, wy};
}
inline bool contains(const Box& box, Vec2<float> p) {
  return p.x >= box.x0 && p.x <= box.x0 + box.width && p.y >= box.y0 && p.y <= box.y0 + box.height;
}
inline float area_share(const DyadicCell& cell) {
  return 1.f / float(1U << cell.level_x) / float(1U << cell.level_y);
}

// Gauss-Lobatto nodes in x and y: edges included, since monotone functions peak there.
inline constexpr int grid_size = 4, grid_points = grid_size * grid_size;
inline constexpr float lobatto_nodes[grid_size] = {-0.9999f, -0.447213595f, 0.447213595f, 0.9999f};
inline constexpr float lobatto_weights[grid_size] = {1.f / 12, 5.f / 12, 5.f / 12, 1.f / 12};

// A viewer of a slab at which its leaves are looked at; the weights of all views sum to 1.
struct View {
  Shares place;
  std::array<std::size_t, known_slots> group;  // which of the places along each axis it is at
  float weight;
  Known known;
  Viewer viewer;
  float albedo;
};

inline constexpr std::size_t views_per_axis = 3;  // Simpson's

// The mean over the groups of views along an axis of each group's largest value.
template <class Value>
float mean_of_largest(std::span<const View> views, std::size_t axis, const Value& value) {
  float sum = 0;
  for (std::size_t g = 0; g < views_per_axis; ++g) {
    float weight = 0, largest = 0;
    for (std::size_t k = 0; k < views.size(); ++k) {
      if (views[k].group[axis] == g) weight += views[k].weight, largest = max(largest, value(k));
    }
    sum += weight * largest;
  }
  return sum;
}
// The mean square of the means of a value over the groups of views along an axis.
template <class Value>
float between(std::span<const View> views, std::size_t axis, const Value& value) {
  float sum = 0;
  for (std::size_t g = 0; g < views_per_axis; ++g) {
    float weight = 0, moment = 0, only = 0;
    std::size_t members = 0;
    for (std::size_t k = 0; k < views.size(); ++k) {
      if (views[k].group[axis] != g) continue;
      ++members, only = value(k), weight += views[k].weight, moment += views[k].weight * value(k);
    }
    sum += weight * sqr(members == 1 ? only : moment / weight);
  }
  return sum;
}

// Where a point of the grid lies: shares of slab and leaf, in [0, 1].
struct GridPlace {
  Shares known;
  float x, y;
};
GridPlace grid_place(std::span<const View> views, std::size_t index);

// T / albedo on the grid of a leaf: [view][y][x].
using Grid = std::span<const FieldValue>;

// Of one view, over a leaf: the means of T / albedo and of (T / albedo)^2 / q.
struct ViewMoments {
  float mean = 0, square = 0;
};
inline constexpr std::size_t views_of_two_angles = views_per_axis * views_per_axis;

struct Leaf {
  DyadicCell cell;
  float ideal = 0, cost = 0;
  Shares known_cost{};  // the part of the cost that slabs narrower along an axis save
  float height = 0;     // bound of T / (albedo q), or its root mean square
  bool split_x = false;
  // Exact: index in the grid of the largest T / (albedo q); and of the largest that is not beside it, where
  // shapes fit closely and so touch in several places.
  std::uint16_t peak = 0, far_peak = 0;
  float slope_x = 0, slope_y = 0;  // q = (1 + slope_x s)(1 + slope_y t)
  // The largest T / albedo seen and where; a child that holds the place inherits it, so that what a probe
  // has found once is not lost between the points of a finer grid.
  float seen = 0;
  Known seen_by{};
  // Along which known coordinates a landmark moves through the leaf faster than the slab's views can follow.
  std::array<bool, known_slots> crossed{};
  Vec2<float> seen_at{};
  // One-shot, where wo has two angles and nothing else is known.
  std::array<ViewMoments, views_of_two_angles> of_view{};

  // Remembers the largest T / albedo.
  void note(float value, const Known& by, Vec2<float> at) {
    if (value > seen) seen = value, seen_by = by, seen_at = at;
  }
  // To at least `bound`; the cost follows.
  void raise(float bound) {
    height = max(height, max(bound, floor_share));
    cost = area_share(cell) * height;
  }
  // A cost that slabs narrower along the crossed coordinates would save.
  void blame_crossing(float saved) {
    for (std::size_t a = 0; a < crossed.size(); ++a) known_cost[a] += crossed[a] ? saved : 0.f;
  }
};

// The cut that closes in on seen_at, whatever the grid says: towards the pole along the radius,
// elsewhere the longer side.
bool close_in_along_x(const Leaf& leaf);

// The shape q of a leaf at p.
float shape(const Leaf& leaf, const Box& box, Vec2<float> p);

void analyse_exact(Leaf& leaf, Grid grid, std::span<const View> views);
// The same with the lowest bound that any shape allows.
void analyse_exact_closely(Leaf& leaf, Grid grid, std::span<const View> views);
void analyse_one_shot(Leaf& leaf, Grid grid, std::span<const View> views);

}  // namespace reflectree::detail
