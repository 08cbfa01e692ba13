// SPDX-License-Identifier: Apache-2.0
// Looks for points where a bound is exceeded, and bounds the mass that lies above it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/verify/erased.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {

// Coordinates in [0, 1]: elevation of wo, the place of wi in whatever map the sampler uses; where the
// function is anisotropic, the azimuth of wo; and of families the parameters.
using AttackPoint = std::array<double, 6>;
// ratio[i] = T / (a M) at points[i]: above 1 the bound is exceeded.
using RatioFunction = std::function<void(std::span<const AttackPoint> points, std::span<double> ratio)>;

struct AttackOptions {
  std::size_t probes = 1 << 18;  // scrambled Sobol' points, from the best of which local searches start
  std::size_t climbs = 256;
  int steps = 60;  // of each local search
  int coordinates = 3;
  std::uint64_t seed = 1;
};
struct AttackResult {
  double worst = 0;  // the largest ratio found
  AttackPoint at{};
  std::uint64_t evaluations = 0, overshoots = 0;
};
AttackResult attack(const RatioFunction& ratio, const AttackOptions& options = {}, const Host& host = {});

// One trial of an exact sampler for a random wo: the ratio T / (a M) at the proposed point.
using RatioTrial = std::function<double(Pcg32& u)>;

// The overshooting mass 1 - int min(T, aM) / int T = E[(r - 1)+] / E[r] over trials, by which the density
// drawn differs at most.
//   upper   95 % bound, the smaller of two at 97.5 % each: the rate of overshoots (Clopper-Pearson) times the
//           largest excess, which is tight when none is seen; and the empirical Bernstein bound of the mean,
//           tight when many are small. Both need the largest possible excess: the worst that the trials or a
//           preceding attack found.
//   surely  the mass is above it but for one case in a million: the rates of excesses octave by octave
//           (Clopper-Pearson, at a share of that level each), times the octave's lower end.
struct OvershootMass {
  double estimate = 0, upper = 0, worst = 0;
  std::uint64_t trials = 0, overshoots = 0;
  double surely = 0;
};
// Sums over trials: of r, of (r - 1)+ and of its square.
struct OvershootSums {
  double ratio = 0, excess = 0, excess2 = 0, worst = 0;
  std::uint64_t trials = 0, overshoots = 0;
  // octave[j]: excesses from 2^-j to below twice that; the first and last take the rest.
  std::array<std::uint64_t, 28> octave{};
  void add(double ratio);
  void add(const OvershootSums& other);
};
OvershootMass overshoot_mass(const OvershootSums& sums, double attacked_worst = 1);
OvershootMass overshoot_mass(const RatioTrial& trial, std::uint64_t trials, double attacked_worst = 1,
                             std::uint64_t seed = 1, const Host& host = {});

// Holds where the upper bound is within the limit, fails where the mass surely exceeds it, and is open in
// between: that many trials cannot tell, and the detail says about how many would.
CheckResult check_overshoot(const OvershootMass& mass, double limit = 1e-6);

}  // namespace reflectree
