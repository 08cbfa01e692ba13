// SPDX-License-Identifier: Apache-2.0
// Growth of a forest: a partition of theta_o into slabs and, in each, a tree over the square. One engine
// serves both modes. A leaf has a cost (exact: area * maximum; one-shot: area * root mean square) and an
// ideal (area * mean); a slab is done when sum(cost) <= goal * sum(ideal). Rounds: every leaf of every
// slab that is to be split is evaluated in one batch.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "field.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::detail {

// A dyadic cell of the square: x in [ix, ix + 1] / 2^level_x of the width, the same for y.
struct DyadicCell {
  std::uint32_t ix = 0, iy = 0;
  std::uint8_t level_x = 0, level_y = 0;
};
// No leaf keeps less than this share of the slab's mean density: none loses support.
inline constexpr float floor_share = 1e-3f;
inline constexpr int max_level = 15;  // locations pack into 16 bits an axis

struct Box {  // in square coordinates
  float x0, y0, width, height;
};
inline Box box_of(const DyadicCell& cell, const Domain& domain) {
  const float y_min = domain.half ? 0.f : -1.f, y_size = domain.half ? 1.f : 2.f;
  const float wx = 2.f / float(1U << cell.level_x), wy = y_size / float(1U << cell.level_y);
  return {-1 + float(cell.ix) * wx, y_min + float(cell.iy) * wy, wx, wy};
}
inline bool contains(const Box& box, Vec2<float> p) {
  return p.x >= box.x0 && p.x <= box.x0 + box.width && p.y >= box.y0 && p.y <= box.y0 + box.height;
}
inline float area_share(const DyadicCell& cell) {
  return 1.f / float(1U << cell.level_x) / float(1U << cell.level_y);
}

// Gauss-Lobatto nodes in x and y (edges included: monotone functions peak there), Simpson's in theta_o.
inline constexpr int grid_size = 4, theta_nodes = 3, grid_points = theta_nodes * grid_size * grid_size;
inline constexpr float lobatto_nodes[grid_size] = {-0.9999f, -0.447213595f, 0.447213595f, 0.9999f};
inline constexpr float lobatto_weights[grid_size] = {1.f / 12, 5.f / 12, 5.f / 12, 1.f / 12};
inline constexpr float theta_weights[theta_nodes] = {1.f / 6, 4.f / 6, 1.f / 6};

// Where a point of the grid lies: shares of slab and leaf, in [0, 1].
struct GridPlace {
  float theta, x, y;
};
GridPlace grid_place(std::size_t index);

// T / albedo on the grid of a leaf: [theta][y][x].
using Grid = std::array<FieldValue, grid_points>;

struct Leaf {
  DyadicCell cell;
  float ideal = 0, cost = 0, theta_cost = 0;  // theta_cost: the part of the cost that narrower slabs save
  float share = 0;                            // per unit area: bound of T / (albedo q), or root mean square
  bool split_x = false;
  std::uint8_t peak = 0;           // exact: index in the grid of the largest T / (albedo q)
  float slope_x = 0, slope_y = 0;  // q = (1 + slope_x s)(1 + slope_y t)
  // The largest T / albedo seen and where; a child that holds the place inherits it, so that what a probe
  // has found once is not lost between the points of a finer grid.
  float seen = 0, seen_theta = 0;
  bool crossed = false;  // a landmark moves through the leaf faster than the slab's three thetas can follow
  Vec2<float> seen_at{};
};

struct Node {
  Split split = Split::leaf;
  std::uint32_t child = 0;  // first of two
  Leaf leaf;
};

struct Slab {
  float theta_lo, theta_hi;
  std::array<float, theta_nodes> cos_theta_o, albedo;
  // Landmarks along the slab: they move with theta_o.
  struct Landmark {
    FieldPoint point;
    float albedo, theta;
    float travel;  // how far it moves along the slab
  };
  std::vector<Landmark> landmarks;
  std::vector<Node> nodes;  // nodes[0] is the root
};

struct GrowthRules {
  float goal;         // sum(cost) / sum(ideal)
  float theta_share;  // a slab whose theta cost exceeds this share of (goal - 1) is halved
  std::size_t max_leaves = 60000;
  bool split_slabs = true;
  bool bounds = true;  // shares bound what was seen (exact), or fit it (one-shot)
  std::function<void(Leaf&, const Grid&)> analyse;
  // T / albedo integrates to 1 in every slab. Where a tree that met its goal sees more or less than that, a
  // lobe runs between the points of its grids, and the coarsest leaves are halved until it is met.
  float mass_error = 0.004f;
  float progress = 0;  // told to the host every round, a sign of life
};

// Fills cosines and albedo of a slab with an unsplit root.
Slab make_slab(float theta_lo, float theta_hi, const AlbedoTable& albedo, const Domain& domain);
// Leaves of a slab in preorder (indices into nodes).
std::vector<std::uint32_t> leaves_in_order(const Slab& slab);
// Grows until every slab meets the goal; slabs stay ordered by theta_o.
void grow(std::vector<Slab>& slabs, const Field& field, const AlbedoTable& albedo, const GrowthRules& rules,
          const Host& host, std::uint64_t* evaluations);

// The cut that closes in on seen_at, whatever the grid says: towards the pole along the radius, elsewhere the
// longer side.
bool close_in_along_x(const Leaf& leaf);

// The shape q of a leaf at p.
float shape(const Leaf& leaf, const Box& box, Vec2<float> p);

void analyse_exact(Leaf& leaf, const Grid& grid);
void analyse_one_shot(Leaf& leaf, const Grid& grid);

}  // namespace reflectree::detail
