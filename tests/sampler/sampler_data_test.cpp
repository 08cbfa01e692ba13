// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/sampler_data.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "functions.hpp"
#include "reflectree/error.hpp"

namespace reflectree {
namespace {

const SamplerData& good_data() {
  static const SamplerData data = build(material("plastic:alpha=0.3"));
  return data;
}

TEST(SamplerData, RefusesEveryKindOfDamage) {
  ASSERT_NO_THROW(validate(good_data()));
  const auto refused = [&](const char* what, const std::function<void(SamplerData&)>& damage) {
    SamplerData d = good_data();
    damage(d);
    EXPECT_THROW(validate(d), Error) << what;
    EXPECT_THROW(pack(d), Error) << what;
  };
  refused("known coordinate", [](auto& d) { d.exact_partition.coordinates[0].name = "phi_o"; });
  refused("known coordinates", [](auto& d) { d.one_shot_partition.coordinates.push_back({"alpha", 0, 1}); });
  refused("a tree too few", [](auto& d) { d.exact.pop_back(); });
  refused("a tree too many", [](auto& d) { d.one_shot.push_back(d.one_shot[0]); });
  refused("tree goes on", [](auto& d) { d.exact[0].nodes.push_back(TreeSplit::leaf); });
  refused("tree incomplete", [](auto& d) { d.exact[0].nodes.pop_back(); });
  refused("tree empty", [](auto& d) { d.one_shot[0] = {}; });
  refused("unknown node", [](auto& d) { d.exact[0].nodes[0] = TreeSplit(3); });
  refused("a mass missing", [](auto& d) { d.exact[0].mass.pop_back(); });
  refused("a slope missing", [](auto& d) { d.exact[0].slope_x.pop_back(); });
  refused("a slope too many", [](auto& d) { d.one_shot[0].slope_y.push_back(0); });
  refused("lost support", [](auto& d) { d.exact[0].mass[0] = 0; });
  refused("empty edge", [](auto& d) { d.exact[0].slope_x[0] = -128; });
  refused("masses overflow", [](auto& d) { d.one_shot[0].mass.back() = 0xffffffffU; });
  refused("volume", [](auto& d) { d.exact[0].volume = std::nanf(""); });
  refused("volume", [](auto& d) { d.exact[0].volume = -1; });
  refused("status", [](auto& d) { d.exact[0].status = BoundStatus(7); });
  refused("ratio", [](auto& d) { d.exact[0].bound_ratio = -1; });
  refused("ratio of estimated",
          [](auto& d) { d.exact[0].status = BoundStatus::estimated, d.exact[0].bound_ratio = 1; });
  refused("albedo", [](auto& d) { d.albedo.albedo[1] = std::nanf(""); });
  refused("albedo", [](auto& d) { d.albedo.albedo[1] = -1; });
  refused("albedo short", [](auto& d) { d.albedo.albedo.pop_back(); });
  refused("albedo error", [](auto& d) { d.albedo.relative_error = std::nanf(""); });
  refused("albedo error", [](auto& d) { d.albedo.relative_error = 1.01f; });
  refused("albedo empty", [](auto& d) { d.albedo = {}; });
  refused("albedo order", [](auto& d) { std::swap(d.albedo.cos_theta_o[1], d.albedo.cos_theta_o[2]); });
  refused("albedo span", [](auto& d) { d.albedo.cos_theta_o.back() = 0.999f; });
  refused("albedo span", [](auto& d) { d.albedo.cos_theta_o.front() = 1e-6f; });
  refused("domain", [](auto& d) { d.domain.kind = DomainKind(9); });
  refused("exponent", [](auto& d) { d.domain.exponent = 2; });
  refused("exponent", [](auto& d) { d.domain.exponent = std::nanf(""); });
  refused("depth", [](auto& d) {  // a comb of 16 levels along x
    CanonicalTree& tree = d.exact[0];
    tree.nodes.assign(16, TreeSplit::x);
    tree.nodes.insert(tree.nodes.end(), 17, TreeSplit::leaf);
    tree.mass.assign(17, 1), tree.slope_x.assign(17, 0), tree.slope_y.assign(17, 0);
  });
}

TEST(LeafCells, TileTheSquare) {
  const SamplerData& d = good_data();
  const auto tiles = [&](const CanonicalTree& tree, const Domain& domain) {
    const auto cells = leaf_cells(tree.nodes, domain.symmetry);
    ASSERT_EQ(cells.size(), tree.mass.size());
    double area = 0;
    for (const SquareCell& c : cells) area += double(c.x1 - c.x0) * double(c.y1 - c.y0);
    EXPECT_DOUBLE_EQ(area, domain.half() ? 2 : 4);
    Pcg32 u(1);
    for (int i = 0; i < 200; ++i) {
      const float x = 2 * to_unit_float(u()) - 1;
      const float y = domain.half() ? to_unit_float(u()) : 2 * to_unit_float(u()) - 1;
      int holders = 0;
      for (const SquareCell& c : cells) holders += x >= c.x0 && x < c.x1 && y >= c.y0 && y < c.y1;
      EXPECT_EQ(holders, 1);
    }
  };
  for (const Symmetry symmetry : {Symmetry::mirror, Symmetry::none}) {
    for (const CanonicalTree& tree : d.exact) tiles(tree, {DomainKind::equal_area, symmetry, 0});
    for (const CanonicalTree& tree : d.one_shot) tiles(tree, {DomainKind::equal_area, symmetry, 0});
  }
}

}  // namespace
}  // namespace reflectree
