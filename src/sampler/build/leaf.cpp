// SPDX-License-Identifier: Apache-2.0
#include "leaf.hpp"

#include <cmath>
#include <cstdlib>

namespace reflectree::detail {

GridPlace grid_place(std::span<const View> views, std::size_t index) {
  const std::size_t i = index % grid_size, j = index / grid_size % grid_size, k = index / grid_points;
  return {views[k].place, 0.5f * (1 + lobatto_nodes[i]), 0.5f * (1 + lobatto_nodes[j])};
}

float shape(const Leaf& leaf, const Box& box, Vec2<float> p) {
  const float s = clamp(2 * (p.x - box.x0) / box.width - 1, -1.f, 1.f);
  const float t = clamp(2 * (p.y - box.y0) / box.height - 1, -1.f, 1.f);
  return (1 + leaf.slope_x * s) * (1 + leaf.slope_y * t);
}

bool close_in_along_x(const Leaf& leaf) {
  if (abs(leaf.seen_at.y) < 0.3f / float(1U << leaf.cell.level_y)) return false;
  return leaf.cell.level_x <= leaf.cell.level_y;
}

namespace {

// Where one point towers over the grid, the cut closes in on it.
bool towers(const Leaf& leaf, float over) { return leaf.seen > 2 * over; }
using Values = float[grid_size][grid_size];  // [y][x]

// Mean and slopes of the best line along each axis: 3 E[v s] / E[v], in 1/128 as stored.
struct Fit {
  float mean, slope_x, slope_y;
};
Fit fit(const Values& v) {
  float mean = 0, mx = 0, my = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      const float w = lobatto_weights[j] * lobatto_weights[i] * v[j][i];
      mean += w;
      mx += w * lobatto_nodes[i];
      my += w * lobatto_nodes[j];
    }
  }
  const auto stored = [mean](float moment) {
    return mean > 0 ? std::round(clamp(3 * moment / mean, -0.96875f, 0.96875f) * 128) / 128 : 0.f;
  };
  return {mean, stored(mx), stored(my)};
}

// Whether lines along x miss the rows by more than lines along y miss the columns: the axis to split.
bool rows_are_rougher(const Values& v, const DyadicCell& cell) {
  float miss_x = 0, miss_y = 0;
  for (int a = 0; a < grid_size; ++a) {
    float row = 0, row1 = 0, column = 0, column1 = 0;
    for (int b = 0; b < grid_size; ++b) {
      const float w = lobatto_weights[b];
      row += w * v[a][b], row1 += 3 * w * v[a][b] * lobatto_nodes[b];
      column += w * v[b][a], column1 += 3 * w * v[b][a] * lobatto_nodes[b];
    }
    for (int b = 0; b < grid_size; ++b) {
      const float w = lobatto_weights[a] * lobatto_weights[b];
      miss_x += w * sqr(v[a][b] - row - row1 * lobatto_nodes[b]);
      miss_y += w * sqr(v[b][a] - column - column1 * lobatto_nodes[b]);
    }
  }
  return miss_x > miss_y || (miss_x == miss_y && cell.level_x <= cell.level_y);
}

// How many known coordinates the views spread over.
std::size_t axes_of(std::span<const View> views) {
  std::size_t axes = 1;
  for (std::size_t count = views_per_axis; count < views.size(); count *= views_per_axis) ++axes;
  return axes;
}

float grid_shape(float slope_x, float slope_y, int j, int i) {
  return (1 + slope_x * lobatto_nodes[i]) * (1 + slope_y * lobatto_nodes[j]);
}

// What a shape must be raised to.
float bound_of(const Values& envelope, float slope_x, float slope_y) {
  float bound = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i)
      bound = max(bound, envelope[j][i] / grid_shape(slope_x, slope_y, j, i));
  }
  return bound;
}

// Slopes of the lowest bound, from those that the leaf has. The logarithm of v / ((1 + g_x s)(1 + g_y t)) is
// convex in both slopes, and so is the largest of such: steps downhill end near the one minimum.
void lower(Leaf& leaf, const Values& envelope) {
  constexpr float steepest = 0.96875f;
  for (int step = 16; step > 0; step /= 2) {
    for (int moves = 0; moves < 4; ++moves) {
      const float from_x = leaf.slope_x, from_y = leaf.slope_y, before = leaf.height;
      for (int x = -step; x <= step; x += step) {
        for (int y = -step; y <= step; y += step) {
          const float gx = clamp(from_x + float(x) / 128, -steepest, steepest);
          const float gy = clamp(from_y + float(y) / 128, -steepest, steepest);
          const float bound = bound_of(envelope, gx, gy);
          if (bound < leaf.height) leaf.height = bound, leaf.slope_x = gx, leaf.slope_y = gy;
        }
      }
      if (!(leaf.height < before)) break;
    }
  }
}

void analyse_bound(Leaf& leaf, Grid grid, std::span<const View> views, bool closely) {
  const auto at = [&](std::size_t k, int j, int i) {
    return grid[k * grid_points + std::size_t(j * grid_size + i)];
  };
  Values envelope;
  float mean = 0, highest = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      envelope[j][i] = 0;
      for (std::size_t k = 0; k < views.size(); ++k) {
        envelope[j][i] = max(envelope[j][i], at(k, j, i).upper);
        mean += views[k].weight * lobatto_weights[j] * lobatto_weights[i] * at(k, j, i).mean;
      }
      highest = max(highest, envelope[j][i]);
    }
  }
  // Of a few shapes, the one that the envelope needs to be raised least: the best lines, milder ones, flat.
  const Fit line = fit(envelope);
  leaf.height = 1e30f;
  for (const float part_x : {0.f, 0.75f, 1.f}) {
    for (const float part_y : {0.f, 0.75f, 1.f}) {
      const float gx = std::round(part_x * line.slope_x * 128) / 128,
                  gy = std::round(part_y * line.slope_y * 128) / 128;
      const float bound = bound_of(envelope, gx, gy);
      if (bound < leaf.height) leaf.height = bound, leaf.slope_x = gx, leaf.slope_y = gy;
    }
  }
  if (closely) lower(leaf, envelope);
  std::vector<float> bounds(views.size());
  float peak = -1;
  for (std::size_t k = 0; k < views.size(); ++k) {
    float bound = 0;
    for (int j = 0; j < grid_size; ++j) {
      for (int i = 0; i < grid_size; ++i) {
        const float ratio = at(k, j, i).upper / grid_shape(leaf.slope_x, leaf.slope_y, j, i);
        bound = max(bound, ratio);
        if (ratio > peak)
          peak = ratio, leaf.peak = std::uint16_t(k * grid_points + std::size_t(j * grid_size + i));
      }
    }
    bounds[k] = bound;
  }
  leaf.far_peak = leaf.peak;
  float far_peak = -1;
  for (std::size_t p = 0; closely && p < grid.size(); ++p) {
    const int i = int(p % grid_size), j = int(p / grid_size % grid_size);
    if (std::abs(i - leaf.peak % grid_size) <= 1 && std::abs(j - leaf.peak / grid_size % grid_size) <= 1)
      continue;
    const float ratio = grid[p].upper / grid_shape(leaf.slope_x, leaf.slope_y, j, i);
    if (ratio > far_peak) far_peak = ratio, leaf.far_peak = std::uint16_t(p);
  }
  const float area = area_share(leaf.cell);
  leaf.ideal = area * mean;
  // What slabs would cost that are thin along one coordinate.
  leaf.known_cost = {};
  for (std::size_t axis = 0; axis < axes_of(views); ++axis) {
    const float thin = mean_of_largest(views, axis, [&](std::size_t k) { return bounds[k]; });
    leaf.known_cost[axis] = area * (leaf.height - thin);
  }
  leaf.split_x = rows_are_rougher(envelope, leaf.cell);
  if (towers(leaf, highest)) leaf.split_x = close_in_along_x(leaf);
  leaf.height = max(leaf.height, floor_share);
  leaf.cost = area * leaf.height;
}

}  // namespace

void analyse_exact(Leaf& leaf, Grid grid, std::span<const View> views) {
  analyse_bound(leaf, grid, views, false);
}
void analyse_exact_closely(Leaf& leaf, Grid grid, std::span<const View> views) {
  analyse_bound(leaf, grid, views, true);
}

void analyse_one_shot(Leaf& leaf, Grid grid, std::span<const View> views) {
  Values m, s, d;  // over the views: mean, mean square, and that of the difference to the mirror image
  float highest = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      m[j][i] = s[j][i] = d[j][i] = 0;
      for (std::size_t k = 0; k < views.size(); ++k) {
        const FieldValue v = grid[k * grid_points + std::size_t(j * grid_size + i)];
        m[j][i] += views[k].weight * v.mean;
        s[j][i] += views[k].weight * sqr(v.mean);
        d[j][i] += views[k].weight * sqr(v.upper - v.mean);
        highest = max(highest, v.upper);
      }
    }
  }
  const Fit line = fit(m);
  leaf.slope_x = line.slope_x, leaf.slope_y = line.slope_y;
  const std::size_t axes = axes_of(views);
  float square = 0, difference = 0;
  Shares steady{};  // the square that is left where slabs are thin along a coordinate
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      const float w = lobatto_weights[j] * lobatto_weights[i] / grid_shape(leaf.slope_x, leaf.slope_y, j, i);
      square += w * s[j][i];
      const auto value = [&](std::size_t k) {
        return grid[k * grid_points + std::size_t(j * grid_size + i)].mean;
      };
      for (std::size_t axis = 0; axis < axes; ++axis) {
        steady[axis] += w * (sqr(m[j][i]) + (s[j][i] - between(views, axis, value)));
      }
      difference += w * d[j][i];
    }
  }
  leaf.of_view = {};
  if (views.size() == views_of_two_angles) {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const int row = int(i / grid_size % grid_size), column = int(i % grid_size);
      const float w = lobatto_weights[row] * lobatto_weights[column];
      ViewMoments& view = leaf.of_view[i / grid_points];
      view.mean += w * grid[i].mean;
      view.square += w * sqr(grid[i].mean) / grid_shape(leaf.slope_x, leaf.slope_y, row, column);
    }
  }
  const float area = area_share(leaf.cell);
  // What mirror images differ by belongs to the best density, but no splitting saves it: it is no cost.
  leaf.height = max(sqrt(square + difference), floor_share);
  leaf.ideal = area * line.mean;
  leaf.cost = max(area * sqrt(square), leaf.ideal);
  leaf.known_cost = {};
  for (std::size_t axis = 0; axis < axes; ++axis)
    leaf.known_cost[axis] = area * (sqrt(square) - sqrt(max(steady[axis], 0.f)));
  leaf.split_x = rows_are_rougher(m, leaf.cell);
  // A needle between the points of the grid: pretend that it fills 1/16 of the leaf, until the grid sees it.
  if (towers(leaf, highest)) {
    const float cost = area * sqrt(square + sqr(leaf.seen) / 16);
    leaf.blame_crossing(cost - leaf.cost);
    leaf.cost = cost;
    leaf.split_x = close_in_along_x(leaf);
  }
}

}  // namespace reflectree::detail
