// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/packing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

// The largest difference in units of what rounding may do, and where.
struct Worst {
  double excess = 0;
  std::string where = "none differs";
  void see(double difference, double allowed, const std::string& place) {
    const double e = difference / allowed;
    if (e > excess || !std::isfinite(e)) excess = std::isfinite(e) ? e : INFINITY, where = place;
  }
  void must(bool right, const std::string& place) {
    if (!right) see(INFINITY, 1, place);
  }
  CheckResult result(const char* name) const {
    CheckResult r;
    r.name = name;
    r.statistic = excess;
    r.threshold = 1;
    r.passed = excess <= 1;
    r.detail = "over rounding, worst: " + where;
    return r;
  }
};

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

// Of a family: at random places, as the canonical table interpolates.
CheckResult check_family_albedo(const SamplerData& data, const PackedSampler& packed) {
  Worst worst;
  Pcg32 u(1, 37);
  for (int k = 0; k < 4000; ++k) {
    const float c = std::max(std::exp(-8 * to_unit_float(u())), min_cos_theta_o);
    const float phi = azimuth_span(data.frame.symmetry) * to_unit_float(u());
    Coordinates at{};
    for (std::size_t i = 0; i < data.parameters.size(); ++i)
      at[i] = linear_mix(to_unit_float(u()), lowest(data.parameters[i]), highest(data.parameters[i]));
    const double expected = double(albedo_at(data.albedo, c, phi, at)),
                 found = double(packed.viewer.albedo.at(c, phi, at));
    worst.see(std::abs(found - expected), 2e-5 * expected + 1e-30,
              text("cos theta_o %.6g: %.8g for %.8g", double(c), found, expected));
  }
  return worst.result("packed_albedo");
}

CheckResult check_albedo(const SamplerData& data, const PackedSampler& packed) {
  if (!data.parameters.empty()) return check_family_albedo(data, packed);
  Worst worst;
  const AlbedoTable& table = data.albedo;
  const std::size_t columns = table.cos_theta_o.size();
  for (std::size_t row = 0; row < std::max<std::size_t>(table.phi_o.size(), 1); ++row) {
    const float* albedo = table.albedo.data() + row * columns;
    float phi = table.phi_o.empty() ? 0 : table.phi_o[row];
    // The azimuth at which a segment ends belongs to the next one.
    if (row + 1 < table.phi_o.size() && table.phi_o[row + 1] == phi) phi = std::nextafter(phi, 0.f);
    const auto looked_up = [&](float c) {
      return double(table.phi_o.empty() ? packed.viewer.albedo.at(c) : packed.viewer.albedo.at(c, phi));
    };
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const double c0 = double(table.cos_theta_o[i]), c1 = double(table.cos_theta_o[i + 1]);
      const double a0 = double(albedo[i]), a1 = double(albedo[i + 1]);
      for (const double part : {0., 0.25, 0.5, 0.75, 1.}) {
        // An inner node belongs to the piece above it.
        if (part == 1 && i + 2 < columns) continue;
        const float c = part < 1 ? float(c0 + part * (c1 - c0)) : table.cos_theta_o[i + 1];
        const double t = (double(c) - c0) / (c1 - c0), expected = a0 + t * (a1 - a0);
        // base + slope c in float: three roundings of the larger. Beside a row, a rounding of the next one.
        const double slope = (a1 - a0) / (c1 - c0), base = a0 - slope * c0;
        double rounding = 3e-7 * (std::abs(base) + std::abs(slope * double(c))) + 1e-7 * expected + 1e-37;
        if (!table.phi_o.empty()) rounding += 1e-5 * expected;
        worst.see(std::abs(looked_up(c) - expected), rounding,
                  text("theta_o %.4f deg: %.8g for %.8g",
                       std::acos(std::min(double(c), 1.)) * 180 / pi_v<double>, looked_up(c), expected));
      }
    }
  }
  return worst.result("packed_albedo");
}

// Slabs of one coordinate ascend in theta_o in the canonical form, in the cosine in the packed one.
const PackedSlab& packed_slab(const PackedForest& forest, std::size_t slabs, std::size_t canonical) {
  return forest.slabs[forest.tree.empty() ? slabs - 1 - canonical : canonical];
}

void check_borders(const char* mode, const SamplerData& data, const Partition& partition,
                   const PackedForest& forest, Worst& worst) {
  const std::vector<SlabBox> boxes = slab_boxes(partition);
  worst.must(forest.slabs.size() == boxes.size(), std::string(mode) + ": one packed slab per slab");
  if (forest.slabs.size() != boxes.size()) return;
  const std::size_t axes = partition.coordinates.size();
  const bool family = axes > 1 && partition.coordinates.back().name != "phi_o";
  for (std::size_t s = 0; s < boxes.size() && family; ++s) {
    for (const float x : {0.001f, 0.5f, 0.999f}) {
      const float theta = linear_mix(x, boxes[s].lo[0], boxes[s].hi[0]);
      for (const float y : {0.001f, 0.5f, 0.999f}) {
        std::array<float, 1 + max_parameters> others{};
        for (std::size_t a = 1; a < axes; ++a) others[a - 1] = linear_mix(y, boxes[s].lo[a], boxes[s].hi[a]);
        const std::size_t parameters = data.parameters.size();
        for (std::size_t p = 0; p < parameters; ++p) {
          float& other = others[axes - 1 - parameters + p];
          other = value_of(data.parameters[p], other);
        }
        if (axes > 1 + parameters) others[0] = azimuth_key(others[0]);
        const std::size_t found = forest.tree(std::max(std::cos(theta), min_cos_theta_o), others.data());
        worst.must(found == s, std::string(mode) +
                                   text(", theta_o %.6g, slab %.0f: another slab", double(theta), double(s)));
      }
    }
  }
  for (std::size_t s = 0; s < boxes.size() && !forest.tree.empty() && !family; ++s) {
    for (const float x : {0.001f, 0.5f, 0.999f}) {
      for (const float y : {0.001f, 0.5f, 0.999f}) {
        const float theta = linear_mix(x, boxes[s].lo[0], boxes[s].hi[0]);
        const float phi = linear_mix(y, boxes[s].lo[1], boxes[s].hi[1]);
        const float azimuth = azimuth_key(phi);
        const std::size_t found = forest.tree(std::max(std::cos(theta), min_cos_theta_o), &azimuth);
        worst.must(found == s, std::string(mode) + text(", theta_o %.6g, phi_o %.6g: another slab",
                                                        double(theta), double(phi)));
      }
    }
  }
  for (std::size_t s = 0; s < boxes.size() && forest.tree.empty(); ++s) {
    const double upper = std::cos(double(boxes[s].lo[0]));
    const double lower = std::max(std::cos(double(boxes[s].hi[0])), double(min_cos_theta_o));
    // Three roundings away from the borders; a slab thinner than that cannot be told.
    const double top = upper - 3e-7 * upper, bottom = lower + 3e-7 * lower;
    if (!(bottom < top)) continue;
    for (const double c : {top, 0.5 * (top + bottom), bottom}) {
      const auto found = std::size_t(&forest.slab_at(float(c)) - forest.slabs.data());
      worst.must(found == boxes.size() - 1 - s,
                 std::string(mode) + text(", cos theta_o %.8g: slab %.0f for %.0f", c, double(found),
                                          double(boxes.size() - 1 - s)));
    }
  }
}

void check_leaves(const std::string& place, const CanonicalTree& tree, const Domain& domain,
                  const PackedSlab& slab, const PackedLeaf* leaves, std::span<const double> height,
                  Worst& worst) {
  const std::vector<SquareCell> cells = leaf_cells(tree.nodes, domain.symmetry);
  const double y0 = domain.half() ? 0 : -1, unit_y = domain.half() ? 0x1p-16 : 0x1p-15;
  double volume = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const PackedLeaf& l = leaves[i];
    const double width = std::ldexp(0x1p-14, std::countr_zero(l.x)),
                 length = std::ldexp(2 * unit_y, std::countr_zero(l.y));
    const double x = -1 + double(l.x) * 0x1p-15 - width / 2, y = y0 + double(l.y) * unit_y - length / 2;
    worst.must(x == double(cells[i].x0) && y == double(cells[i].y0) && x + width == double(cells[i].x1) &&
                   y + length == double(cells[i].y1),
               place + text(", leaf %.0f: another cell", double(i)));
    worst.must(l.slope_x == tree.slope_x[i] && l.slope_y == tree.slope_y[i],
               place + text(", leaf %.0f: another slope", double(i)));
    const double share = width * length / (domain.half() ? 2 : 4);
    worst.see(
        std::abs(double(l.height) - height[i] / share), 2e-7 * height[i] / share,
        place + text(", leaf %.0f: height %.8g for %.8g", double(i), double(l.height), height[i] / share));
    volume += height[i];
  }
  worst.see(std::abs(double(slab.volume) - volume), 1e-6 * volume,
            place + text(": volume %.8g for %.8g", double(slab.volume), volume));
}

// The masses as the alias table has them.
std::vector<std::uint64_t> choices(const PackedSlab& slab, const PackedLeaf* leaves) {
  std::vector<std::uint64_t> mass(slab.count);
  for (std::size_t i = 0; i < slab.count; ++i) {
    const std::uint64_t own = std::min(leaves[i].threshold, slab.bucket);
    mass[i] += own;
    if (leaves[i].alias < slab.count) mass[leaves[i].alias] += slab.bucket - own;
  }
  return mass;
}

void check_choices(const std::string& place, const CanonicalTree& tree, const PackedSlab& slab,
                   std::span<const std::uint64_t> mass, Worst& worst) {
  std::uint64_t sum = 0;
  for (const std::uint32_t m : tree.mass) sum += m;
  const std::uint64_t all = std::uint64_t(slab.bucket) * slab.count;
  worst.must(all >= sum && all - sum < slab.count, place + ": buckets of another size");
  std::size_t raised = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (mass[i] == tree.mass[i]) continue;
    ++raised;
    worst.must(mass[i] == tree.mass[i] + (all - sum) && raised == 1,
               place + text(", leaf %.0f is chosen %.0f times for %.0f", double(i), double(mass[i]),
                            double(tree.mass[i])));
  }
}

// Inner nodes in preorder.
struct Descent {
  const CanonicalTree& tree;
  std::span<const std::uint64_t> mass;
  const DescentNode* nodes;
  const std::string& place;
  Worst& worst;
  std::size_t next_node = 0, next_leaf = 0, next_inner = 0;

  struct Below {
    double mass;
    std::size_t leaves;
  };
  Below walk() {
    const TreeSplit split = tree.nodes[next_node++];
    if (split == TreeSplit::leaf) return {double(mass[next_leaf++]), 1};
    const std::size_t at = next_inner++;
    const Below lower = walk(), upper = walk();
    const DescentNode& node = nodes[at];
    const double share = lower.mass / (lower.mass + upper.mass);
    worst.must(node.lower_leaves == lower.leaves && bool(node.split_x) == (split == TreeSplit::x),
               place + text(", node %.0f: another split", double(at)));
    worst.see(std::abs(double(node.lower) - share), 2e-7 * share,
              place + text(", node %.0f: lower share %.8g for %.8g", double(at), double(node.lower), share));
    return {lower.mass + upper.mass, lower.leaves + upper.leaves};
  }
};

}  // namespace

std::vector<CheckResult> check_packing(const SamplerData& data, const PackedSampler& packed) {
  Worst slabs, leaves, chosen, descent;
  check_borders("exact", data, data.exact_partition, packed.exact, slabs);
  check_borders("one-shot", data, data.one_shot_partition, packed.one_shot, slabs);
  if (slabs.excess > 1) return {check_albedo(data, packed), slabs.result("packed_slabs")};
  const auto check_tree = [&](const char* mode, const PackedForest& forest, std::size_t slab_number,
                              std::size_t slab_total, const CanonicalTree& tree, double volume) {
    const std::string place = mode + text(" slab %.0f", double(slab_number));
    const PackedSlab& slab = packed_slab(forest, slab_total, slab_number);
    const bool fits = slab.count == tree.mass.size() && slab.first + slab.count <= forest.leaves.size();
    leaves.must(fits, place + ": another number of leaves");
    if (!fits) return;
    const PackedLeaf* first = forest.leaves.data() + slab.first;
    const std::vector<std::uint64_t> mass = choices(slab, first);
    check_choices(place, tree, slab, mass, chosen);
    // Exact: from the mass that was built, less what the table took up, so that no bound falls short.
    double sum = 0;
    for (const std::uint32_t m : tree.mass) sum += m;
    const double unit = volume > 0 ? volume / sum : 1 / (double(slab.bucket) * slab.count);
    std::vector<double> height;
    for (const std::uint64_t m : mass) height.push_back(unit * double(m));
    check_leaves(place, tree, data.domain, slab, first, height, leaves);
    if (volume > 0) return;
    Descent{tree, mass, forest.nodes.data() + slab.first_node, place, descent}.walk();
  };
  for (std::size_t s = 0; s < data.exact.size(); ++s) {
    const double volume = double(data.exact[s].volume);
    if (volume > 0) check_tree("exact", packed.exact, s, data.exact.size(), data.exact[s], volume);
  }
  for (std::size_t s = 0; s < data.one_shot.size(); ++s) {
    check_tree("one-shot", packed.one_shot, s, data.one_shot.size(), data.one_shot[s], 0);
  }
  return {check_albedo(data, packed), slabs.result("packed_slabs"), leaves.result("packed_leaves"),
          chosen.result("packed_choice"), descent.result("packed_descent")};
}

}  // namespace reflectree
