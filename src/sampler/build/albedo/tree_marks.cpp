// SPDX-License-Identifier: Apache-2.0
#include "tree_marks.hpp"

#include <algorithm>

#include "build/canonical.hpp"
#include "reflectree/math/genz_malik.hpp"

namespace reflectree::detail {

namespace {

// A leaf whose highest value, as far as it was met, is far above those at the nodes of the rule.
struct HiddenPeak {
  std::size_t slab;
  const Leaf* leaf;
  float mass;  // at most, of 1
};

constexpr float far_above = 1.3f;

// By slabs, the largest first.
std::vector<HiddenPeak> hidden_peaks(const std::vector<Slab>& slabs, const Survey& survey) {
  const Domain& domain = survey.field.domain;
  std::vector<HiddenPeak> peaks;
  std::vector<FieldPoint> points;
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    for (const std::uint32_t i : leaves_in_order(slabs[s])) {
      const Leaf& leaf = slabs[s].nodes[i].leaf;
      const Viewer viewer = viewer_at(leaf.seen_by);
      // What weighs less than the table may miss is left alone.
      if (leaf.seen * area_share(leaf.cell) < survey.albedo.relative_error || survey.at_jump(viewer.wo))
        continue;
      const Box box = box_of(leaf.cell, domain);
      for (const Vec2<float>& q : genz_malik_nodes<float>())
        points.push_back(field_point(
            viewer, {box.x0 + 0.5f * box.width * (1 + q.x), box.y0 + 0.5f * box.height * (1 + q.y)}));
      peaks.push_back({s, &leaf, area_share(leaf.cell)});
    }
  }
  std::vector<FieldValue> values(points.size());
  survey.eval(points, values);
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    float highest = 0;
    for (std::size_t i = k * genz_malik_points; i < (k + 1) * genz_malik_points; ++i)
      highest = max(highest, values[i].upper);
    const float albedo = survey.albedo_at(points[k * genz_malik_points].viewer());
    const float seen = peaks[k].leaf->seen, nodes = albedo > 0 ? highest / albedo : seen;
    peaks[k].mass *= seen > far_above * nodes ? seen - nodes : 0;
  }
  std::erase_if(peaks, [](const HiddenPeak& p) { return !(p.mass > 0); });
  std::stable_sort(peaks.begin(), peaks.end(), [](const HiddenPeak& a, const HiddenPeak& b) {
    return a.slab != b.slab ? a.slab < b.slab : a.mass > b.mass;
  });
  return peaks;
}

}  // namespace

const std::vector<Landmark>& TreeMarks::at(const Viewer& viewer) const {
  return slabs[slab_index(partition, viewer, whole)];
}

TreeMarks tree_marks(const std::vector<Slab>& slabs, const Survey& survey) {
  constexpr std::size_t most_leaves = 512, most_peaks = 64;
  constexpr float small = 1.f / 64, narrow = 1.f / 2048;  // half of a width
  const Domain& domain = survey.field.domain;
  TreeMarks marks{partition_of(slabs, survey.field.parameters), survey.field.whole(), {}, {}};
  for (const Slab& slab : slabs) {
    // Of the small leaves those that may weigh most.
    std::vector<std::pair<float, Landmark>> leaves;
    for (const std::uint32_t i : leaves_in_order(slab)) {
      const Leaf& leaf = slab.nodes[i].leaf;
      const Box box = box_of(leaf.cell, domain);
      const Vec2<float> half{0.5f * box.width, 0.5f * box.height};
      if (half.x < small || half.y < small)
        leaves.push_back({leaf.cost, {{box.x0 + half.x, box.y0 + half.y}, half}});
    }
    std::stable_sort(leaves.begin(), leaves.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    if (leaves.size() > most_leaves) leaves.resize(most_leaves);
    std::vector<Landmark>& of_slab = marks.slabs.emplace_back();
    for (const auto& [cost, at] : leaves) of_slab.push_back(at);
  }
  const std::vector<HiddenPeak> peaks = hidden_peaks(slabs, survey);
  std::size_t count = 0;
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const auto& [slab, leaf, mass] = peaks[k];
    count = k > 0 && peaks[k - 1].slab == slab ? count + 1 : 0;
    if (count == 0) marks.peaks.push_back({mass, leaf->seen_by, leaf->seen_at});
    if (count < most_peaks) marks.slabs[slab].push_back({leaf->seen_at, {narrow, narrow}});
  }
  return marks;
}

}  // namespace reflectree::detail
