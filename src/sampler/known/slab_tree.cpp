// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/slab_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reflectree {

class SlabTree::Making {
 public:
  Making(SlabTree& tree, const Partition& partition, const std::vector<KnownParameter>& parameters)
      : tree_(tree), partition_(partition), parameters_(parameters) {}

  void add_nodes() {
    std::vector<std::uint32_t> open;  // inner nodes whose upper child is still to come
    std::vector<bool> in_lower;
    std::size_t inner = 0;
    std::uint32_t slab = 0;
    const auto attach = [&](std::uint32_t at) {
      if (open.empty()) return;
      Node& parent = tree_.nodes_[open.back() - tree_.slabs_];
      (in_lower.back() ? parent.lower : parent.upper) = at;
    };
    for (const std::uint8_t axis : partition_.axis) {
      if (axis == Partition::leaf) {
        attach(slab++);
        // The subtree that ends here may be the lower one of its parent, whose upper child follows.
        while (!open.empty() && !in_lower.back()) open.pop_back(), in_lower.pop_back();
        if (open.empty()) break;
        in_lower.back() = false;
        continue;
      }
      const float split = partition_.split[inner++];
      const auto at = std::uint32_t(tree_.slabs_ + tree_.nodes_.size());
      attach(at);
      tree_.nodes_.push_back({key_of(axis, split), axis, 0, 0});
      depth_.push_back(open.size());
      open.push_back(at), in_lower.push_back(true);
    }
  }

  // The different borders of every axis, of as many levels of the tree as the grid has room for.
  void choose_borders() {
    const std::size_t most = 64 + 16 * std::size_t(tree_.slabs_);
    std::size_t levels = 0;
    for (const std::size_t d : depth_) levels = std::max(levels, d + 1);
    for (;; --levels) {
      borders_.assign(partition_.coordinates.size(), {});
      for (std::size_t i = 0; i < depth_.size(); ++i) {
        if (depth_[i] < levels) borders_[tree_.nodes_[i].axis].push_back(tree_.nodes_[i].split);
      }
      std::size_t cells = 1;
      for (std::vector<float>& b : borders_) {
        std::sort(b.begin(), b.end());
        b.erase(std::unique(b.begin(), b.end()), b.end());
        cells *= b.size() + 1;
        if (cells > most) break;
      }
      if (cells <= most || levels == 0) return;
    }
  }

  void make_lookups() {
    // A cosine at a border belongs to the lower cosines.
    std::vector<float> cosines{1};
    for (const float b : borders_[0]) cosines.push_back(std::nextafter(-b, 2.f));
    cosines.push_back(min_cos_theta_o);
    std::reverse(cosines.begin(), cosines.end());
    tree_.cosines_ = CosineLookup(cosines);
    tree_.others_ = borders_.size() - 1;
    std::size_t stride = borders_[0].size() + 1;
    for (std::size_t a = 0; a < tree_.others_; ++a) {
      const std::vector<float>& borders = borders_[1 + a];
      Axis& axis = tree_.axes_[a];
      axis = axis_of(1 + a, borders.size());
      axis.stride = stride;
      axis.borders = borders;
      std::size_t before = 0;
      for (std::size_t cell = 0; cell <= axis.cell(std::numeric_limits<float>::max()); ++cell) {
        while (before < borders.size() && axis.cell(borders[before]) < cell) ++before;
        axis.guide.push_back(std::uint16_t(before));
      }
      axis.borders.push_back(std::numeric_limits<float>::infinity());
      stride *= borders.size() + 1;
    }
    cells_ = stride;
  }

  void fill_grid() {
    for (std::size_t cell = 0; cell < cells_; ++cell) {
      // How many borders of each axis the cell is beyond.
      std::array<std::size_t, 1 + max_others> passed{};
      for (std::size_t a = 0, rest = cell; a < borders_.size(); ++a) {
        passed[a] = rest % (borders_[a].size() + 1), rest /= borders_[a].size() + 1;
        if (a == 0) passed[0] = borders_[0].size() - passed[0];  // counted in ascending cosines
      }
      std::uint32_t at = tree_.nodes_.empty() ? 0 : tree_.slabs_;
      while (at >= tree_.slabs_) {
        const Node& node = tree_.nodes_[at - tree_.slabs_];
        const std::vector<float>& borders = borders_[node.axis];
        const auto border = std::lower_bound(borders.begin(), borders.end(), node.split);
        if (border == borders.end() || *border != node.split) break;
        const bool upper = std::size_t(border - borders.begin()) < passed[node.axis];
        at = upper ? node.upper : node.lower;
      }
      tree_.grid_.push_back(at);
    }
  }

 private:
  // Null of what is no parameter.
  const KnownParameter* parameter_of(std::size_t axis) const {
    const std::size_t of_viewer = partition_.coordinates.size() - parameters_.size();
    return axis < of_viewer ? nullptr : &parameters_[axis - of_viewer];
  }
  // By what a border is compared with a place.
  float key_of(std::size_t axis, float border) const {
    if (axis == 0) return -std::cos(border);
    if (partition_.coordinates[axis].name == "phi_o") return azimuth_key(border);
    const KnownParameter* parameter = parameter_of(axis);
    return parameter ? value_of(*parameter, border) : border;
  }
  // Without borders and guide: cells about as wide as borders are apart.
  Axis axis_of(std::size_t which, std::size_t borders) const {
    const KnownCoordinate& c = partition_.coordinates[which];
    const KnownParameter* parameter = parameter_of(which);
    std::size_t cells = 8;
    while (cells < 2 * borders && cells < 4096) cells *= 2;
    Axis axis;
    axis.by_bits = parameter && parameter->logarithmic;
    if (axis.by_bits) {
      axis.first = std::bit_cast<std::uint32_t>(parameter->range.lo);
      axis.most = std::bit_cast<std::uint32_t>(parameter->range.hi);
      while ((axis.most - axis.first) >> axis.shift >= cells) ++axis.shift;
    } else {
      const bool azimuth = c.name == "phi_o";
      const float lo = azimuth ? azimuth_key(c.lo) : c.lo, hi = azimuth ? azimuth_key(c.hi) : c.hi;
      axis.lo = lo, axis.per_unit = float(cells) / (hi - lo), axis.last = float(cells - 1);
    }
    return axis;
  }

  SlabTree& tree_;
  const Partition& partition_;
  const std::vector<KnownParameter>& parameters_;
  std::vector<std::size_t> depth_;           // of every inner node
  std::vector<std::vector<float>> borders_;  // by axis, ascending
  std::size_t cells_ = 0;
};

SlabTree::SlabTree(const Partition& partition, const std::vector<KnownParameter>& parameters)
    : slabs_(std::uint32_t(slab_count(partition))) {
  Making making(*this, partition, parameters);
  making.add_nodes();
  making.choose_borders();
  making.make_lookups();
  making.fill_grid();
}

std::size_t SlabTree::bytes() const {
  std::size_t bytes = nodes_.size() * sizeof(Node) + grid_.size() * sizeof(std::uint32_t) + cosines_.bytes();
  for (const Axis& axis : axes_)
    bytes += axis.borders.size() * sizeof(float) + axis.guide.size() * sizeof(std::uint16_t);
  return bytes;
}

}  // namespace reflectree
