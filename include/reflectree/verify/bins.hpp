// SPDX-License-Identifier: Apache-2.0
// Bins of nearly equal probability over the hemisphere, from cubature alone: a k-d tree over the chart,
// halved at the median mass, then the mass of every bin by a cubature of its own. Where f tells of patches over
// which it is constant, no bin reaches over the border of one: each is a patch, or a part of a bright one.
#pragma once

#include <optional>
#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {

struct Bins {
  Direction wo;
  HemisphereChart chart;
  struct Node {
    bool split_x = false;
    double at = 0;
    int lower = -1, upper = -1;  // nodes; negative: bin number -1 - value
  };
  std::vector<Node> nodes;  // the root first; empty: a single bin
  std::vector<CubatureBox> boxes;
  std::vector<double> mass;  // integral of t cos_i over each bin
  double total = 0;          // their sum
  double worst_error = 0;    // largest relative error bound among them

  bool patches = false;  // the bins lie in patches of f

  // Of a bin where f is 0 the one beside it where rounding alone can have led there.
  std::size_t find(Direction wi) const;
};

struct BinOptions {
  int count = 400;          // about, where f tells of patches
  double tolerance = 3e-4;  // relative, of each mass; biases chi-square by less than samples * tolerance^2
  std::optional<Vec3<double>> centre = {};  // of the chart; default: where a search finds t cos_i highest
};

// No bins at all where the albedo is zero.
Bins equal_mass_bins(const TargetFunction& f, Direction wo, const BinOptions& options = {},
                     const Host& host = {});

// The integral of the sampler's own density over each bin; its density may jump anywhere.
std::vector<double> density_masses(const ErasedSampler& sampler, const Bins& bins, double tolerance = 1e-3,
                                   const Host& host = {});

}  // namespace reflectree
