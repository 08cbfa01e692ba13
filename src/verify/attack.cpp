// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/attack.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "parallel.hpp"
#include "reflectree/math/low_discrepancy.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {
namespace {

struct Climber {
  AttackPoint at{};
  double ratio = 0;
  std::uint64_t overshoots = 0, evaluations = 0;
};

bool higher(const Climber& a, const Climber& b) { return a.ratio > b.ratio; }

// Pattern search: neighbours along the axes and four random ones; the step follows success.
void climb(const RatioFunction& ratio, Climber& c, double step, const AttackOptions& options, Pcg32 u) {
  const auto axes = std::size_t(options.coordinates);
  std::vector<AttackPoint> around(2 * axes + 4);
  std::vector<double> values(around.size());
  for (int s = 0; s < options.steps; ++s) {
    for (std::size_t k = 0; k < around.size(); ++k) {
      around[k] = c.at;
      for (std::size_t axis = 0; axis < axes; ++axis) {
        const double move = k < 2 * axes ? (k / 2 == axis ? (k % 2 ? step : -step) : 0)
                                         : step * (2 * to_unit_double(u()) - 1);
        around[k][axis] = std::clamp(c.at[axis] + move, 0., 1.);
      }
    }
    ratio(around, values);
    const auto best = std::size_t(std::max_element(values.begin(), values.end()) - values.begin());
    c.evaluations += around.size();
    for (const double v : values) c.overshoots += v > 1;
    if (values[best] > c.ratio) {
      c.ratio = values[best];
      c.at = around[best];
      step = std::min(step * 1.5, 0.1);
    } else {
      step *= 0.5;
    }
  }
}

}  // namespace

AttackResult attack(const RatioFunction& ratio, const AttackOptions& options, const Host& host) {
  constexpr std::size_t chunk = 4096;
  const std::size_t chunks = (options.probes + chunk - 1) / chunk;
  std::vector<std::vector<Climber>> best(chunks);
  std::vector<std::uint64_t> overshoots(chunks);
  detail::for_each_index(host, true, chunks, [&](std::size_t c) {
    const std::size_t size = std::min(chunk, options.probes - c * chunk);
    std::vector<AttackPoint> points(size);
    std::vector<double> values(size);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::uint32_t d = 0; d < std::uint32_t(options.coordinates); ++d) {
        points[i][d] = scrambled_sobol(std::uint32_t(c * chunk + i), d, std::uint32_t(options.seed));
      }
    }
    ratio(points, values);
    for (std::size_t i = 0; i < size; ++i) {
      overshoots[c] += values[i] > 1;
      best[c].push_back({points[i], values[i], 0, 0});
    }
    std::stable_sort(best[c].begin(), best[c].end(), higher);
    best[c].resize(std::min(size, options.climbs));
  });
  std::vector<Climber> climbers;
  for (const auto& list : best) climbers.insert(climbers.end(), list.begin(), list.end());
  std::stable_sort(climbers.begin(), climbers.end(), higher);
  climbers.resize(std::min(climbers.size(), options.climbs));

  const double step = std::cbrt(1 / double(std::max<std::size_t>(options.probes, 1)));
  detail::for_each_index(host, true, climbers.size(), [&](std::size_t i) {
    climb(ratio, climbers[i], step, options, detail::part_generator(options.seed, i));
  });
  AttackResult result;
  result.evaluations = options.probes;
  for (const auto n : overshoots) result.overshoots += n;
  for (const Climber& c : climbers) {
    result.evaluations += c.evaluations;
    result.overshoots += c.overshoots;
    if (c.ratio > result.worst) result.worst = c.ratio, result.at = c.at;
  }
  return result;
}

void OvershootSums::add(double r) {
  ++trials;
  ratio += r;
  worst = std::max(worst, r);
  if (!(r > 1)) return;
  ++overshoots;
  excess += r - 1;
  excess2 += sqr(r - 1);
  ++octave[std::size_t(std::clamp(int(std::ceil(-std::log2(r - 1))), 0, int(octave.size()) - 1))];
}

void OvershootSums::add(const OvershootSums& other) {
  ratio += other.ratio;
  excess += other.excess;
  excess2 += other.excess2;
  worst = std::max(worst, other.worst);
  trials += other.trials;
  overshoots += other.overshoots;
  for (std::size_t j = 0; j < octave.size(); ++j) octave[j] += other.octave[j];
}

OvershootMass overshoot_mass(const OvershootSums& sums, double attacked_worst) {
  OvershootMass result;
  result.trials = sums.trials;
  result.overshoots = sums.overshoots;
  result.worst = sums.worst;
  const double n = double(sums.trials), mean = sums.excess / n, mean_ratio = sums.ratio / n;
  if (!(mean_ratio > 0)) return result;
  const double range = std::max({sums.worst, attacked_worst, 1.}) - 1;
  const double variance = std::max(sums.excess2 - n * mean * mean, 0.) / std::max(n - 1, 1.);
  const double by_rate = rate_upper_bound(sums.overshoots, sums.trials, 0.975) * range;
  const double by_mean = mean_upper_bound(mean, variance, range, sums.trials, 0.975);
  const double each = 1 - 1e-6 / double(sums.octave.size());
  double below = 0;
  for (std::size_t j = 0; j + 1 < sums.octave.size(); ++j) {
    below += std::exp2(-double(j)) * rate_lower_bound(sums.octave[j], sums.trials, each);
  }
  result.estimate = mean / mean_ratio;
  result.upper = std::min(by_rate, by_mean) / mean_ratio;
  result.surely = below / mean_ratio;
  return result;
}

OvershootMass overshoot_mass(const RatioTrial& trial, std::uint64_t trials, double attacked_worst,
                             std::uint64_t seed, const Host& host) {
  constexpr std::uint64_t chunk = 1 << 18;
  std::vector<OvershootSums> parts((trials + chunk - 1) / chunk);
  detail::for_each_index(host, true, parts.size(), [&](std::size_t c) {
    Pcg32 u = detail::part_generator(seed, c);
    OvershootSums& p = parts[c];
    for (std::uint64_t i = std::min(chunk, trials - c * chunk); i > 0; --i) p.add(trial(u));
  });
  OvershootSums total;
  for (const OvershootSums& p : parts) total.add(p);
  return overshoot_mass(total, attacked_worst);
}

CheckResult check_overshoot(const OvershootMass& mass, double limit) {
  CheckResult result;
  result.name = "overshoot_mass";
  result.threshold = limit;
  result.passed = mass.surely <= limit;
  result.decided = !result.passed || mass.upper <= limit;
  result.statistic = result.passed ? mass.upper : mass.surely;
  char buffer[240];
  int written = std::snprintf(
      buffer, sizeof buffer, "%llu overshoots in %llu trials, worst ratio %.5g, estimate %.3g, at most %.3g",
      static_cast<unsigned long long>(mass.overshoots), static_cast<unsigned long long>(mass.trials),
      mass.worst, mass.estimate, mass.upper);
  if (!result.decided && mass.estimate < limit) {
    // Both bounds narrow with the root of the trials at least.
    const double factor = sqr((mass.upper - mass.estimate) / (limit - mass.estimate));
    std::snprintf(buffer + written, sizeof buffer - std::size_t(written),
                  "; so many trials cannot tell, about %.1g might", double(mass.trials) * factor);
  } else if (!result.decided) {
    std::snprintf(buffer + written, sizeof buffer - std::size_t(written),
                  "; probably above, but so many trials cannot be sure");
  }
  result.detail = buffer;
  return result;
}

}  // namespace reflectree
