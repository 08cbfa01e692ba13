// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/square/tree.hpp"

#include <gtest/gtest.h>

#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

CanonicalTree four_leaves() {
  return {{TreeSplit::x, TreeSplit::y, TreeSplit::leaf, TreeSplit::x, TreeSplit::leaf, TreeSplit::leaf,
           TreeSplit::leaf},
          {10, 20, 30, 40},
          {0, 64, -32, 16},
          {0, -96, 8, 127}};
}

TEST(TreeReader, AgreesWithLeafCells) {
  const CanonicalTree tree = four_leaves();
  for (const Symmetry symmetry : {Symmetry::none, Symmetry::mirror}) {
    const std::vector<SquareCell> cells = leaf_cells(tree.nodes, symmetry);
    const TreeReader reader(tree, symmetry);
    ASSERT_EQ(cells.size(), 4U);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const SquareCell& c = cells[i];
      EXPECT_EQ(reader.find({0.5f * (c.x0 + c.x1), 0.5f * (c.y0 + c.y1)}).index, i);
      EXPECT_EQ(reader.find({c.x0, c.y0}).index, i) << "lower edges belong to the cell";
    }
  }
}

TEST(TreeReader, DensityIntegratesToOne) {
  for (const Symmetry symmetry : {Symmetry::none, Symmetry::mirror}) {
    CanonicalTree tree = four_leaves();
    const auto integral = [&] {
      const TreeReader reader(tree, symmetry);
      const SquareCell root = root_cell(symmetry);
      constexpr int n = 256;
      double sum = 0;
      for (int i = 0; i < n * n; ++i) {
        const float u = (float(i % n) + 0.5f) / n, v = (float(i / n) + 0.5f) / n;
        sum += reader.density_at({root.x0 + u * (root.x1 - root.x0), root.y0 + v * (root.y1 - root.y0)});
      }
      return sum / (n * n);
    };
    EXPECT_NEAR(integral(), 1, 1e-4);
    const TreeReader reader(tree, symmetry);
    const TreeLeaf leaf = reader.find({0.9f, 0.9f});
    EXPECT_NEAR(reader.mean_density(leaf), 0.4 / 0.5, 1e-6);  // 40 of 100 in half of the square
  }
}

TEST(TreeReader, RefusesATornTree) {
  for (const std::vector<TreeSplit>& nodes :
       {std::vector{TreeSplit::x, TreeSplit::leaf}, {TreeSplit::leaf, TreeSplit::leaf}, {}}) {
    CanonicalTree torn;
    torn.nodes = nodes;
    EXPECT_THROW(TreeReader(torn, Symmetry::mirror), Error);
  }
}

}  // namespace
}  // namespace reflectree
