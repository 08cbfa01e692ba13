// SPDX-License-Identifier: Apache-2.0
// Functions that are constant in wi over patches (BrdfTraits::patches), on the square of projected_disk, where
// patches are rectangles and T is constant over each: what a leaf holds is known from the patches that it
// touches. A bound that is their maximum is never exceeded; between the points of a grid a narrow bright patch
// may hide.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflectree/math/direction.hpp"

namespace reflectree::detail {

struct Field;
struct Leaf;
struct Slab;
struct View;
struct Viewer;

// A rectangle of the square that lies in one patch.
struct PatchCell {
  float x0, x1, y0, y1;
};

// The patches of f on the square; none unless f is anisotropic and tells of them, and the domain is
// projected_disk on a whole square.
std::vector<PatchCell> patch_cells(const Field& field);
// Throws Error where f changes within a patch, which no bound over patches would notice.
void check_patches(const Field& field, std::uint64_t seed);
// So close to a border of patches that rounding decides on which side p is.
bool on_patch_border(std::span<const PatchCell> cells, Vec2<float> p);

// The integrals of T over the square.
std::vector<double> integrals_over_patches(const Field& field, std::span<const Viewer> viewers);

// T / albedo of a patch, over the views of a slab.
struct PatchSeen {
  float mean = 0, square = 0, largest = 0;
};
struct SlabPatches {
  std::vector<PatchSeen> seen;
  std::vector<float> values;  // [patch][view]
};
SlabPatches patches_of(const Field& field, std::span<const View> views);
// What analyse_exact (`bounds`) or analyse_one_shot conclude from a grid, from the patches.
void analyse_patches(Leaf& leaf, const Slab& slab, const Field& field, bool bounds);

}  // namespace reflectree::detail
