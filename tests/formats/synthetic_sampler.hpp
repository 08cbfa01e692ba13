// SPDX-License-Identifier: Apache-2.0
// A small sampler's data made by hand, with something other than the default in every field.
#pragma once

#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::synthetic {

inline SamplerData sampler_data() {
  SamplerData data;
  data.material = "0.5*lambert:rho=0.5 + ggx:alpha=0.3";
  data.target = {TargetKind::channel, 2};
  data.domain = {DomainKind::stretched, Symmetry::none, 1.5f};
  data.exact_partition = {{{"theta_o", 0, 1.5707887f}}, {0, Partition::leaf, Partition::leaf}, {0.75f}};
  data.one_shot_partition = {{{"theta_o", 0, 1.5707887f}}, {Partition::leaf}, {}};
  MajorantTree low, high;
  low.nodes = {TreeSplit::x, TreeSplit::leaf, TreeSplit::y, TreeSplit::leaf, TreeSplit::leaf};
  low.mass = {4'000'000'000U, 1, 77};
  low.slope_x = {0, -127, 127}, low.slope_y = {1, 2, -3};
  low.volume = 1.21f;
  low.status = BoundStatus::certified;
  low.bound_ratio = 1.01f;
  high.nodes = {TreeSplit::leaf};
  high.mass = {12345}, high.slope_x = {5}, high.slope_y = {-6};
  high.volume = 1.25f;
  data.exact = {low, high};
  DensityTree density;
  density.nodes = {TreeSplit::y, TreeSplit::x, TreeSplit::leaf, TreeSplit::leaf, TreeSplit::leaf};
  density.mass = {100, 200, 300}, density.slope_x = {10, 20, 30}, density.slope_y = {-10, -20, -30};
  data.one_shot = {density};
  data.albedo = {{min_cos_theta_o, 0.5f, 1}, {0.9f, 0.8f, 0.75f}, 1e-4f, 0.02f};
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) data.probes.target[i] = 0.01f * float(i);
  data.report = {1.25f, 1e-8f, 0.007f, 1e-3f, 123'456'789'012ULL, {}};
  return data;
}

// The same of a family: two slabs of theta_o, the upper one cut in two by alpha.
inline SamplerData family_data() {
  SamplerData data = sampler_data();
  data.material = "ggx:alpha=0.02..1,f0=1";
  data.domain = {DomainKind::scaled_star, Symmetry::mirror};
  data.parameters = {{{"alpha", 0.02f, 1}, true}};
  data.law.x = {0.1f, 0.7f, 0}, data.law.y = {0.1f, 0.6f, 0};
  const float lo = lowest(data.parameters[0]), hi = highest(data.parameters[0]);
  const std::vector<KnownCoordinate> coordinates{{"theta_o", 0, 1.5707887f}, {"alpha", lo, hi}};
  data.exact_partition = {
      coordinates, {0, Partition::leaf, 1, Partition::leaf, Partition::leaf}, {0.75f, -2}};
  data.exact.push_back(data.exact.back());
  data.one_shot_partition = {coordinates, {Partition::leaf}, {}};
  data.albedo.parameters = {{lo, hi, 4}};
  data.albedo.albedo.clear();
  for (int i = 0; i < 12; ++i) data.albedo.albedo.push_back(1 - 0.03f * float(i));
  return data;
}

}  // namespace reflectree::synthetic
