// SPDX-License-Identifier: Apache-2.0
// Independent roads to the albedo: a sampler's table, adaptive cubature, and unbiased estimates.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/verify/reference.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {

struct FurnaceOptions {
  int directions = 200;                         // random theta_o, uniform up to max_theta_o
  std::vector<double> cosines;                  // more: of chosen theta_o, such as a table's nodes
  double max_theta_o = 1.5690509975429023;      // 89.9 degrees
  double tolerance = 1e-4;                      // relative, there
  double grazing_theta_o = 1.5707788735023767;  // 89.999 degrees
  double grazing_tolerance = 1e-3;
  std::size_t max_evaluations = 1'000'000;  // of each reference
  std::uint64_t seed = 1;
};

// The worst relative difference between the table and the reference, over the tolerance. Fails too where
// the reference's own error, which is estimated generously, exceeds twenty tolerances.
CheckResult check_albedo_table(const std::function<double(Direction wo)>& albedo, const TargetFunction& f,
                               const FurnaceOptions& options = {}, const Host& host = {});

// One independent unbiased estimate of a(wo): sum(V) a for an accepted trial and 0 for a rejected one, or
// the weight of sample_once and 0 for none.
using AlbedoEstimate = std::function<double(Direction wo, Pcg32& u)>;

// The mean of many estimates within four standard errors of the reference.
CheckResult check_albedo_estimates(const std::string& name, const AlbedoEstimate& estimate,
                                   const TargetFunction& f, Direction wo, std::uint64_t count = 10'000'000,
                                   std::uint64_t seed = 1, const Host& host = {});

}  // namespace reflectree
