// SPDX-License-Identifier: Apache-2.0
// The bounds of exact mode read from the canonical data, independently of the packed form: what the attack
// of the verify room climbs on.
#pragma once

#include <vector>

#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/verify/attack.hpp"

namespace reflectree {

class MajorantField {
 public:
  MajorantField(const SamplerData& data, AnyBrdf f) : data_(data), f_(std::move(f)) {
    for (const MajorantTree& tree : data.exact) {
      Slab slab;
      for (const std::uint32_t m : tree.mass) slab.sum += m;
      slab.cells = leaf_cells(tree.nodes, data.domain.symmetry);
      std::size_t node = 0, leaf = 0;
      add(tree, slab, node, leaf);
      slabs_.push_back(std::move(slab));
    }
  }

  // T / (albedo M q) at (theta_o, x, y), each as a share of its range.
  double ratio(const AttackPoint& at, float sign_y = 1) const {
    const KnownCoordinate& range = data_.exact_partition.coordinates[0];
    const float theta = linear_mix(float(at[0]), range.lo, range.hi);
    const float cosine = clamp(cos(theta), min_cos_theta_o, 1.f);
    const Direction wo{sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
    const Vec2<float> p{2 * float(at[1]) - 1, data_.domain.half() ? float(at[2]) : 2 * float(at[2]) - 1};
    DomainPoint point = lift(data_.domain, wo, p);
    point.geometry.wi.y *= sign_y, point.geometry.wh.y *= sign_y;
    const float t = data_.target(f_(point.geometry)) * point.projected_area;
    const double bound = majorant(theta, p) * double(albedo_at(data_.albedo, cosine));
    return bound > 0 ? double(t) / bound : t > 0 ? 1e30 : 0;
  }

  // The bound of T / albedo.
  double majorant(float theta_o, Vec2<float> p) const {
    const std::size_t s = find_slab(data_.exact_partition, {&theta_o, 1});
    const Slab& slab = slabs_[s];
    int i = 0;
    while (slab.nodes[std::size_t(i)].upper >= 0) {
      const Node& node = slab.nodes[std::size_t(i)];
      i = (node.split_x ? p.x : p.y) < node.at ? i + 1 : node.upper;
    }
    const auto leaf = std::size_t(slab.nodes[std::size_t(i)].leaf);
    const SquareCell& c = slab.cells[leaf];
    const MajorantTree& tree = data_.exact[s];
    const double share = double(c.x1 - c.x0) * double(c.y1 - c.y0) / (data_.domain.half() ? 2 : 4);
    const double x = 2 * double((p.x - c.x0) / (c.x1 - c.x0)) - 1,
                 y = 2 * double((p.y - c.y0) / (c.y1 - c.y0)) - 1;
    return double(tree.volume) * tree.mass[leaf] / slab.sum / share * (1 + tree.slope_x[leaf] / 128. * x) *
           (1 + tree.slope_y[leaf] / 128. * y);
  }

  RatioFunction ratio_function() const {
    return [this](std::span<const AttackPoint> points, std::span<double> out) {
      for (std::size_t i = 0; i < points.size(); ++i) out[i] = ratio(points[i]);
    };
  }

 private:
  struct Node {
    bool split_x = false;
    float at = 0;
    int upper = -1;  // none: a leaf
    std::uint32_t leaf = 0;
  };
  struct Slab {
    double sum = 0;
    std::vector<Node> nodes;
    std::vector<SquareCell> cells;
  };
  // Appends the subtree at `node`; returns the box that its leaves fill.
  SquareCell add(const MajorantTree& tree, Slab& slab, std::size_t& node, std::size_t& leaf) const {
    const TreeSplit split = tree.nodes[node++];
    const std::size_t self = slab.nodes.size();
    slab.nodes.emplace_back();
    if (split == TreeSplit::leaf) {
      slab.nodes[self].leaf = std::uint32_t(leaf);
      return slab.cells[leaf++];
    }
    const SquareCell lower = add(tree, slab, node, leaf);
    const int upper_node = int(slab.nodes.size());
    const SquareCell upper = add(tree, slab, node, leaf);
    slab.nodes[self] = {split == TreeSplit::x, split == TreeSplit::x ? upper.x0 : upper.y0, upper_node, 0};
    return {lower.x0, upper.x1, lower.y0, upper.y1};
  }

  const SamplerData& data_;
  AnyBrdf f_;
  std::vector<Slab> slabs_;
};

// Notes T / (a M) of the first trial of ExactSampler::sample.
struct FirstTrial {
  double ratio = 0;
  bool accepted = false, seen = false;
  void trial(bool was_accepted, float value, float majorant) {
    if (seen) return;
    seen = true, accepted = was_accepted, ratio = double(value) / double(majorant);
  }
  void exhausted() {}
};

}  // namespace reflectree
