// SPDX-License-Identifier: Apache-2.0
// Step 5: choosing a leaf. Left: every level of the tree as intervals of [0, 1), as wide as the probability
// of their nodes; the random number falls straight through. Right: the nested cells that it chooses.
#include <algorithm>

#include "coarse_tree.hpp"
#include "reflectree/draw/square_image.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

struct Node {
  int depth;
  double from, to;  // the interval
  SquareCell cell;
};

// All nodes of the tree with their intervals.
class Walk {
 public:
  explicit Walk(const CoarseTree& tree) : tree_(tree) {
    for (const CoarseLeaf& leaf : tree.leaves) total_ += leaf.mass;
  }
  std::vector<Node> nodes;

  double visit(SquareCell cell, int depth, double from) {
    const std::size_t self = nodes.size();
    nodes.push_back({depth, from, from, cell});
    const TreeSplit split = tree_.nodes[node_++];
    double to = from;
    if (split == TreeSplit::leaf) {
      to += tree_.leaves[leaf_++].mass / total_;
    } else {
      const SquareHalves halves = halves_of(cell, split);
      to = visit(halves.upper, depth + 1, visit(halves.lower, depth + 1, from));
    }
    nodes[self].to = to;
    return to;
  }

 private:
  const CoarseTree& tree_;
  double total_ = 0;
  std::size_t node_ = 0, leaf_ = 0;
};

}  // namespace

Figure descent_figure(const Example& example) {
  const Domain& domain = example.data.domain;
  constexpr int depth = 5;
  constexpr double u = 0.42;
  const CoarseTree tree = cut(example, depth);
  Walk walk(tree);
  const SquareCell root = root_cell(domain.symmetry);
  walk.visit(root, 0, 0);

  Figure figure{840, 330, "Choosing a leaf", {}, {}};
  figure.description =
      "Each level of the tree divides the unit interval in proportion to its nodes' volumes; the random "
      "number 0.42 falls through nested intervals to a leaf, and chooses nested cells of the square.";
  const double left = 62, width = 400, top = 66, row = 34;
  figure.body =
      label(16, 26, "Choosing a leaf in proportion to its volume *V* = area × bound", Anchor::start, "head");
  for (const Node& n : walk.nodes) {
    const bool hit = u >= n.from && u < n.to;
    figure.body += rectangle(left + width * n.from, top + row * n.depth + 3,
                             std::max(width * (n.to - n.from), 0.4), row - 6, hit ? "chosen" : "interval");
  }
  for (int d = 0; d <= depth; ++d) {
    figure.body += label(left - 8, top + row * d + row / 2 + 4,
                         d == 0 ? "root" : "level " + std::to_string(d), Anchor::end, "tick");
  }
  const double x = left + width * u, bottom = top + row * (depth + 1);
  PathData arrow;
  arrow.move_to(x, top - 12);
  arrow.line_to(x, bottom + 6);
  arrow.move_to(x - 3.5, bottom);
  arrow.line_to(x, bottom + 6);
  arrow.line_to(x + 3.5, bottom);
  figure.body += path(arrow, "arrow") + label(x, top - 18, "*u* = 0.42", Anchor::middle, "label");
  figure.body += line(left, bottom + 14, left + width, bottom + 14, "axis");
  for (const int k : {0, 1}) {
    figure.body += label(left + width * k, bottom + 28, std::to_string(k), Anchor::middle, "tick");
  }

  SquarePlace place{516, 40, 300, domain.half()};
  if (domain.half()) place.y = top + 24;
  for (const CoarseLeaf& leaf : tree.leaves) {
    figure.body += cell_rectangle(leaf.cell, place, "interval");
  }
  for (const Node& n : walk.nodes) {
    if (u >= n.from && u < n.to) figure.body += cell_rectangle(n.cell, place, "nested");
  }
  figure.body += square_axes(place) + label(place.x, place.y + place.height() + 36,
                                            "the same nodes as cells of the square", Anchor::start, "note");
  return figure;
}

}  // namespace reflectree::method
