// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/attack.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "parallel.hpp"
#include "reflectree/math/low_discrepancy.hpp"
#include "reflectree/math/sum.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {
namespace {

struct Climber {
  AttackPoint at{};
  double ratio = 0;
  std::uint64_t overshoots = 0, evaluations = 0;
};

bool higher(const Climber& a, const Climber& b) { return a.ratio > b.ratio; }

// Pattern search: six neighbours along the axes and four random ones; the step follows success.
void climb(const RatioFunction& ratio, Climber& c, double step, int steps, Pcg32 u) {
  std::array<AttackPoint, 10> around;
  std::array<double, around.size()> values;
  for (int s = 0; s < steps; ++s) {
    for (std::size_t k = 0; k < around.size(); ++k) {
      around[k] = c.at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double move =
            k < 6 ? (k / 2 == axis ? (k % 2 ? step : -step) : 0) : step * (2 * to_unit_double(u()) - 1);
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
      for (std::uint32_t d = 0; d < 3; ++d) {
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
    climb(ratio, climbers[i], step, options.steps, detail::part_generator(options.seed, i));
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

OvershootMass overshoot_mass(const RatioTrial& trial, std::uint64_t trials, double attacked_worst,
                             std::uint64_t seed, const Host& host) {
  constexpr std::uint64_t chunk = 1 << 18;
  struct Part {
    double ratio = 0, excess = 0, excess2 = 0, worst = 0;
    std::uint64_t overshoots = 0;
  };
  std::vector<Part> parts((trials + chunk - 1) / chunk);
  detail::for_each_index(host, true, parts.size(), [&](std::size_t c) {
    Pcg32 u = detail::part_generator(seed, c);
    Part& p = parts[c];
    for (std::uint64_t i = std::min(chunk, trials - c * chunk); i > 0; --i) {
      const double r = trial(u);
      p.ratio += r;
      if (!(r > 1)) continue;
      ++p.overshoots;
      p.excess += r - 1;
      p.excess2 += sqr(r - 1);
      p.worst = std::max(p.worst, r);
    }
  });
  OvershootMass result;
  result.trials = trials;
  Sum ratio, excess, excess2;
  for (const Part& p : parts) {
    ratio += p.ratio;
    excess += p.excess;
    excess2 += p.excess2;
    result.overshoots += p.overshoots;
    result.worst = std::max(result.worst, p.worst);
  }
  const double n = double(trials), mean = excess.value() / n, mean_ratio = ratio.value() / n;
  const double range = std::max({result.worst, attacked_worst, 1.}) - 1;
  const double variance = std::max(excess2.value() - n * mean * mean, 0.) / std::max(n - 1, 1.);
  const double by_rate = rate_upper_bound(result.overshoots, trials, 0.975) * range;
  const double by_mean = mean_upper_bound(mean, variance, range, trials, 0.975);
  result.estimate = mean_ratio > 0 ? mean / mean_ratio : 0;
  result.upper = mean_ratio > 0 ? std::min(by_rate, by_mean) / mean_ratio : 0;
  return result;
}

CheckResult check_overshoot(const OvershootMass& mass, double limit) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "%llu overshoots in %llu trials, worst ratio %.5g, estimate %.3g",
                static_cast<unsigned long long>(mass.overshoots),
                static_cast<unsigned long long>(mass.trials), mass.worst, mass.estimate);
  return {"overshoot_mass", mass.upper <= limit, mass.upper, limit, 1, buffer};
}

}  // namespace reflectree
