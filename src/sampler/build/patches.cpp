// SPDX-License-Identifier: Apache-2.0
#include "patches.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"
#include "refuse.hpp"
#include "slab.hpp"

namespace reflectree::detail {

namespace {

constexpr float rounding = 1e-6f;  // of coordinates of the square, many times
// The table of the albedo, by which T is divided, interpolates between its rows.
constexpr float margin = 2e-4f;

// Azimuths of a band in [-pi, pi], ascending, with 0 and both ends, where the square has its edges.
std::vector<float> edges_of(const PatchBand& band, float axis) {
  std::vector<float> edges{-pi, 0, pi};
  for (const float phi : band.phi_i) edges.push_back(std::remainder(phi - axis, 2 * pi));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end(), [](float a, float b) { return b - a < rounding; }),
              edges.end());
  edges.back() = pi;
  return edges;
}

// The share of a box that lies in a patch; 0 where it does up to rounding.
float share_of(const Box& box, const PatchCell& patch) {
  const float x = min(patch.x1, box.x0 + box.width) - max(patch.x0, box.x0);
  const float y = min(patch.y1, box.y0 + box.height) - max(patch.y0, box.y0);
  return x > rounding && y > rounding ? x * y / (box.width * box.height) : 0;
}

// Whether places of a box may round into a patch: borders of leaves and of patches have places in common, where
// the map of the square decides by its last bits. At both ends of x the sides of y meet, and all azimuths at y = 0.
bool meets(const Box& box, const PatchCell& patch) {
  const auto meet = [](float a0, float a1, float b0, float b1) {
    return min(a1, b1) - max(a0, b0) > -rounding;
  };
  const float x1 = box.x0 + box.width, y1 = box.y0 + box.height;
  if (meet(patch.y0, patch.y1, box.y0, y1) && meet(patch.x0, patch.x1, box.x0, x1)) return true;
  if (meet(patch.y0, patch.y1, 0, 0) && meet(box.y0, y1, 0, 0)) return true;
  const bool ends = (meet(patch.x0, patch.x1, 1, 1) && meet(box.x0, x1, 1, 1)) ||
                    (meet(patch.x0, patch.x1, -1, -1) && meet(box.x0, x1, -1, -1));
  return ends && meet(patch.y0, patch.y1, -y1, -box.y0);
}

// The patches that a leaf touches, and what they hold.
struct Touched {
  PatchCell cell;
  PatchSeen seen;
  const float* values;  // of the views
};
std::vector<Touched> touched_by(const Box& box, const Slab& slab, const Field& field) {
  std::vector<Touched> all;
  const std::size_t views = slab.views.size();
  for (std::size_t i = 0; i < field.patches.size(); ++i) {
    const PatchCell& c = field.patches[i];
    if (meets(box, c)) all.push_back({c, slab.patches.seen[i], &slab.patches.values[i * views]});
  }
  return all;
}

struct Halves {
  DyadicCell lower, upper;
};
Halves halves(DyadicCell cell, bool along_x) {
  std::uint32_t& position = along_x ? cell.ix : cell.iy;
  ++(along_x ? cell.level_x : cell.level_y), position *= 2;
  DyadicCell upper = cell;
  ++(along_x ? upper.ix : upper.iy);
  return {cell, upper};
}

// What a cell costs now, after a cut, and after the best two in a row.
class Prices {
 public:
  Prices(const std::vector<Touched>& touched, const Domain& domain, bool bounds)
      : touched_(touched), domain_(domain), bounds_(bounds) {}
  float now(const DyadicCell& cell) const {
    const Box box = box_of(cell, domain_);
    float largest = 0, square = 0;
    for (const Touched& patch : touched_) {
      const float share = share_of(box, patch.cell);
      if (meets(box, patch.cell)) largest = max(largest, patch.seen.largest);
      square += share * patch.seen.square;
    }
    return area_share(cell) * (bounds_ ? largest : sqrt(square));
  }
  float cut(const DyadicCell& cell, bool along_x) const {
    const Halves half = halves(cell, along_x);
    return now(half.lower) + now(half.upper);
  }
  // One cut ahead: both halves of a leaf may touch the same bright patch.
  float after(const DyadicCell& cell, bool along_x) const {
    const Halves half = halves(cell, along_x);
    float sum = cut(cell, along_x);
    for (const DyadicCell& c : {half.lower, half.upper}) sum += min(cut(c, true), cut(c, false));
    return sum;
  }

 private:
  const std::vector<Touched>& touched_;
  const Domain& domain_;
  bool bounds_;
};

}  // namespace

std::vector<PatchCell> patch_cells(const Field& field) {
  const std::vector<PatchBand> bands = field.f.traits().patches;
  std::vector<PatchCell> cells;
  const Domain whole_disk{DomainKind::projected_disk, Symmetry::none};
  if (bands.empty() || field.family || field.frame.isotropic() || !(field.domain == whole_disk)) return cells;
  float inner = 0;
  for (const PatchBand& band : bands) {
    const float outer = &band == &bands.back() ? 1.f : float(sqr(std::sin(double(band.theta_i_end))));
    const std::vector<float> edges = edges_of(band, field.frame.axis);
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
      const float a = 1 - 2 * abs(edges[k]) / pi, b = 1 - 2 * abs(edges[k + 1]) / pi;
      if (edges[k] >= 0) {
        cells.push_back({b, a, inner, outer});
      } else {
        cells.push_back({a, b, -outer, -inner});
      }
    }
    inner = outer;
  }
  return cells;
}

void check_patches(const Field& field, std::uint64_t seed) {
  if (field.patches.empty()) return;
  constexpr std::size_t viewers = 256;
  constexpr float allowed = 1e-4f;
  Pcg32 u(seed, 29);
  const KnownBox whole = field.whole();
  std::vector<FieldPoint> points;  // the middle of a patch, and a point inside it
  for (std::size_t i = 0; i < viewers; ++i) {
    const Viewer viewer = viewer_at(whole.at({to_unit_float(u()), to_unit_float(u())}));
    for (const PatchCell& c : field.patches) {
      const float x = linear_mix(to_unit_float(u()), 0.01f, 0.99f),
                  y = linear_mix(to_unit_float(u()), 0.01f, 0.99f);
      points.push_back(field_point(viewer, {linear_mix(0.5f, c.x0, c.x1), linear_mix(0.5f, c.y0, c.y1)}));
      points.push_back(field_point(viewer, {linear_mix(x, c.x0, c.x1), linear_mix(y, c.y0, c.y1)}));
    }
  }
  std::vector<FieldValue> values(points.size());
  field.eval(points, values);
  for (std::size_t i = 0; i < points.size(); i += 2) {
    const float a = values[i].mean, b = values[i + 1].mean;
    if (abs(a - b) <= allowed * max(a, b)) continue;
    const FieldPoint& p = points[i + 1];
    throw Error("the function says that it is constant over patches, and changes within one",
                field.f.traits().name + " at " +
                    describe(field.to_caller(p.wo), field.to_caller(field.direction_at(p))),
                "mend the patches of its traits, or leave them out");
  }
}

bool on_patch_border(std::span<const PatchCell> cells, Vec2<float> p) {
  for (const PatchCell& cell : cells) {
    const float inside = min(min(p.x - cell.x0, cell.x1 - p.x), min(p.y - cell.y0, cell.y1 - p.y));
    if (inside > rounding) return false;
  }
  return !cells.empty();
}

std::vector<double> integrals_over_patches(const Field& field, std::span<const Viewer> viewers) {
  const Box root = box_of({}, field.domain);
  std::vector<double> integrals;
  for (const Viewer& viewer : viewers) {
    std::vector<FieldPoint> middles;
    for (const PatchCell& c : field.patches)
      middles.push_back(field_point(viewer, {linear_mix(0.5f, c.x0, c.x1), linear_mix(0.5f, c.y0, c.y1)}));
    std::vector<FieldValue> values(middles.size());
    field.eval(middles, values);
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      sum += double(share_of(root, field.patches[i])) * double(values[i].mean);
    integrals.push_back(sum);
  }
  return integrals;
}

SlabPatches patches_of(const Field& field, std::span<const View> views) {
  std::vector<FieldPoint> points;
  for (const PatchCell& cell : field.patches) {
    for (const View& view : views)
      points.push_back(field_point(view.viewer, {0.5f * (cell.x0 + cell.x1), 0.5f * (cell.y0 + cell.y1)}));
  }
  std::vector<FieldValue> at(points.size());
  field.eval(points, at);
  SlabPatches patches;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const View& view = views[i % views.size()];
    const float value = view.albedo > 0 ? at[i].mean / view.albedo : 0;
    if (i % views.size() == 0) patches.seen.push_back({});
    PatchSeen& seen = patches.seen.back();
    seen.mean += view.weight * value, seen.square += view.weight * sqr(value);
    seen.largest = max(seen.largest, value);
    patches.values.push_back(value);
  }
  return patches;
}

void analyse_patches(Leaf& leaf, const Slab& slab, const Field& field, bool bounds) {
  const std::span<const View> views = slab.views;
  const auto axes = std::size_t(slab.box.axes);
  const Box box = box_of(leaf.cell, field.domain);
  const std::vector<Touched> touched = touched_by(box, slab, field);
  float mean = 0, square = 0;
  Shares steady{};  // the square that is left where slabs are thin along a coordinate
  std::vector<float> largest(views.size(), 0);
  for (const Touched& patch : touched) {
    const float share = share_of(box, patch.cell);
    mean += share * patch.seen.mean, square += share * patch.seen.square;
    const auto value = [&patch](std::size_t k) { return patch.values[k]; };
    for (std::size_t k = 0; k < views.size(); ++k) largest[k] = max(largest[k], value(k));
    for (std::size_t axis = 0; axis < axes; ++axis)
      steady[axis] += share * (sqr(patch.seen.mean) + patch.seen.square - between(views, axis, value));
  }
  const float area = area_share(leaf.cell), root = sqrt(square);
  const float top = *std::max_element(largest.begin(), largest.end());
  leaf.ideal = area * mean;
  leaf.height = max(bounds ? top * (1 + margin) : root, floor_share);
  leaf.cost = bounds ? area * leaf.height : max(area * root, leaf.ideal);
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const auto of_view = [&largest](std::size_t k) { return largest[k]; };
    leaf.known_cost[axis] =
        area * (bounds ? top - mean_of_largest(views, axis, of_view) : root - sqrt(max(steady[axis], 0.f)));
  }
  const Prices prices(touched, field.domain, bounds);
  const float x = prices.after(leaf.cell, true), y = prices.after(leaf.cell, false);
  leaf.split_x = x < y || (x == y && leaf.cell.level_x <= leaf.cell.level_y);
  if (bounds) leaf.raise(leaf.seen);  // where somebody met more than the patches hold
}

}  // namespace reflectree::detail
