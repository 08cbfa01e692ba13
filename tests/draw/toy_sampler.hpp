// SPDX-License-Identifier: Apache-2.0
// Sampler data made by hand for drawing: every slab's tree is split evenly, bounds are sampled maxima.
#pragma once

#include <algorithm>
#include <cmath>

#include "reflectree/draw/disk_image.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree {

inline float normalised_target(const AnyBrdf& f, const SamplerData& data, Direction wo, Vec2<float> p) {
  const DomainPoint point = lift(data.domain, wo, p);
  if (point.projected_area <= 0) return 0;
  return data.target(f(point.geometry)) * point.projected_area;
}

inline void split_evenly(std::vector<TreeSplit>& nodes, int levels) {
  nodes.push_back(levels == 0 ? TreeSplit::leaf : levels % 2 == 0 ? TreeSplit::x : TreeSplit::y);
  if (levels > 0) split_evenly(nodes, levels - 1), split_evenly(nodes, levels - 1);
}

inline SamplerData toy_sampler(const AnyBrdf& f, const Domain& domain, int levels = 6) {
  SamplerData data;
  data.material = f.traits().name;
  data.domain = domain;
  data.exact_partition = {{{"theta_o", 0, pi / 2}}, {0, Partition::leaf, Partition::leaf}, {pi / 4}};
  data.one_shot_partition = data.exact_partition;
  const int n = 96;
  const auto point = [&](int i, int j) {
    const float y = (float(j) + 0.5f) / n;
    return Vec2<float>{2 * (float(i) + 0.5f) / n - 1, domain.half() ? y : 2 * y - 1};
  };
  for (int k = 1; k <= 16; ++k) {
    const float c = float(k) / 16;
    double sum = 0;
    for (int i = 0; i < n * n; ++i) {
      sum += double(normalised_target(f, data, {std::sqrt(1 - c * c), 0, c}, point(i % n, i / n)));
    }
    data.albedo.cos_theta_o.push_back(c);
    data.albedo.albedo.push_back(float(sum / (n * n)));
  }
  std::vector<TreeSplit> nodes;
  split_evenly(nodes, levels);
  const LeafFinder finder(nodes, domain.symmetry);
  const std::size_t leaves = (nodes.size() + 1) / 2;
  for (int slab = 0; slab < 2; ++slab) {
    std::vector<double> most(leaves, 1e-3);
    for (int view = 0; view <= 4; ++view) {
      const Direction wo = draw::viewer_at(pi / 4 * (float(slab) + float(view) / 4 * 0.9f));
      for (int i = 0; i < n * n; ++i) {
        const Vec2<float> p = point(i % n, i / n);
        double& m = most[finder.find(p).index];
        m = std::max(m, double(normalised_target(f, data, wo, p) / albedo_at(data.albedo, wo.z)));
      }
    }
    double volume = 0;
    const double margin = 1.1, highest = *std::max_element(most.begin(), most.end());
    MajorantTree tree;
    tree.nodes = nodes;
    tree.slope_x.assign(leaves, 0);
    tree.slope_y.assign(leaves, 0);
    for (const double m : most) {
      tree.mass.push_back(std::uint32_t(m / highest * 1e9));
      volume += m * margin / double(leaves);
    }
    tree.volume = float(volume);
    data.one_shot.push_back(DensityTree{tree});
    data.exact.push_back(std::move(tree));
  }
  return data;
}

}  // namespace reflectree
