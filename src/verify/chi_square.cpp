// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/chi_square.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "parallel.hpp"
#include "reflectree/math/sum.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t chunk = 1 << 14;
constexpr double least_expected = 5;  // bins below are pooled, as everywhere
constexpr double least_count = 50;    // of weighted bins, whose variance is measured

Tally empty_tally(const ErasedSampler& sampler, std::size_t bins) {
  Tally tally;
  tally.sampler = sampler.name;
  tally.count.resize(bins);
  tally.weight.resize(bins);
  tally.weight2.resize(bins);
  return tally;
}

void draw_chunk(const ErasedSampler& sampler, const Bins& bins, Pcg32 u, std::uint64_t n, Tally& tally) {
  for (std::uint64_t i = 0; i < n; ++i) {
    DrawnDirection d;
    ++tally.samples;
    if (!sampler.sample(bins.wo, u, d)) {
      ++tally.none;
      continue;
    }
    const float length2 = dot(d.wi, d.wi);
    if (!(d.wi.z > 0) || !(std::abs(length2 - 1) < 1e-4f) || !std::isfinite(d.weight)) {
      ++tally.invalid;
      continue;
    }
    if (!(d.weight > 0)) ++tally.dead;
    const std::size_t b = bins.find(d.wi);
    ++tally.count[b];
    tally.weight[b] += double(d.weight);
    tally.weight2[b] += sqr(double(d.weight));
  }
}

std::vector<std::size_t> sorted_by(std::size_t n, const std::function<double(std::size_t)>& key) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return order;
}

CheckResult verdict(const char* name, double statistic, double dof, const ChiSquareOptions& options) {
  const double level = sidak(options.family_significance, options.tests);
  CheckResult result;
  result.name = name;
  result.statistic = statistic;
  result.threshold = chi_square_quantile(level, dof);
  result.p_value = chi_square_tail(statistic, dof);
  result.passed = result.p_value >= level;
  return result;
}

std::string text(const char* format, const std::string& sampler, double dof, double level, double more) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, dof, level, more);
  return sampler + ", " + buffer;
}

// Counts against any masses; they are compared in shape, the total is fitted.
CheckResult pearson(const char* name, const Tally& tally, std::span<const double> mass,
                    const ChiSquareOptions& options) {
  CheckResult result;
  result.name = name;
  CompensatedSum mass_sum;
  for (const double m : mass) mass_sum += m;
  const auto drawn = double(std::accumulate(tally.count.begin(), tally.count.end(), std::uint64_t{0}));
  if (!(mass_sum.value() > 0)) {  // nothing to reflect: nothing may be drawn
    result.passed = tally.none == tally.samples;
    result.statistic = double(tally.samples - tally.none);
    result.detail = tally.sampler + ", albedo 0: every draw must be \"no sample\"";
    return result;
  }
  const double scale = drawn / mass_sum.value();
  double statistic = 0, expected = 0, observed = 0;
  int groups = 0;
  const auto close_group = [&] {
    statistic += sqr(observed - expected) / expected;
    ++groups;
    expected = observed = 0;
  };
  double impossible = 0;
  const auto order = sorted_by(mass.size(), [&](std::size_t i) { return mass[i]; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t i = order[k];
    if (!(mass[i] > 0)) {
      impossible += double(tally.count[i]);
      continue;
    }
    expected += scale * mass[i];
    observed += double(tally.count[i]);
    const double rest = k + 1 < order.size() ? scale * mass[order[k + 1]] : 0;
    if (expected >= least_expected && (rest > 0 || k + 1 == order.size())) close_group();
  }
  if (expected > 0) close_group();
  const double dof = std::max(groups - 1, 1);
  result = verdict(name, statistic, dof, options);
  result.passed = result.passed && tally.invalid == 0 && impossible == 0 && drawn > 0;
  result.detail = text("%.0f degrees of freedom, level %.2g, %.0f invalid", tally.sampler, dof,
                       sidak(options.family_significance, options.tests), double(tally.invalid) + impossible);
  return result;
}

}  // namespace

Tally tally_of(const ErasedSampler& sampler, const Bins& bins, const ChiSquareOptions& options,
               const Host& host) {
  const std::size_t size = std::max<std::size_t>(bins.boxes.size(), 1);
  const std::uint64_t chunks = (options.samples + chunk - 1) / chunk;
  std::vector<Tally> parts(chunks, empty_tally(sampler, size));
  detail::for_each_index(host, sampler.concurrent, chunks, [&](std::size_t c) {
    draw_chunk(sampler, bins, detail::part_generator(options.seed, c),
               std::min(chunk, options.samples - c * chunk), parts[c]);
  });
  Tally sum = empty_tally(sampler, size);
  for (const Tally& part : parts) {
    sum.samples += part.samples;
    sum.none += part.none;
    sum.dead += part.dead;
    sum.invalid += part.invalid;
    for (std::size_t i = 0; i < size; ++i) {
      sum.count[i] += part.count[i];
      sum.weight[i] += part.weight[i];
      sum.weight2[i] += part.weight2[i];
    }
  }
  return sum;
}

CheckResult check_counts(const Tally& tally, const Bins& bins, const ChiSquareOptions& options) {
  return pearson("chi_square", tally, bins.mass, options);
}

CheckResult check_counts(const Tally& tally, std::span<const double> density,
                         const ChiSquareOptions& options) {
  return pearson("chi_square_pdf", tally, density, options);
}

// Weighted counts S have mean n m and, for many small bins, independent variances near the sum of w^2. Its
// mean is n m times the mean of w^2 over that of w, which hardly varies inside a bin: unlike the sum itself
// it does not follow the fluctuation that it judges. Bins are grouped by what is expected, for the same reason.
CheckResult check_weights(const Tally& tally, const Bins& bins, const ChiSquareOptions& options) {
  double statistic = 0, expected = 0, observed = 0, variance = 0, counts = 0;
  int groups = 0;
  const auto close_group = [&] {
    statistic += sqr(observed - expected) / variance;
    ++groups;
    expected = observed = variance = counts = 0;
  };
  CompensatedSum all, all2;
  for (std::size_t i = 0; i < tally.weight.size(); ++i) all += tally.weight[i], all2 += tally.weight2[i];
  const double ratio = all.value() > 0 ? all2.value() / all.value() : 0;
  const auto drawn = double(std::accumulate(tally.count.begin(), tally.count.end(), std::uint64_t{0}));
  const std::size_t n = bins.mass.size();
  const auto order = sorted_by(n, [&](std::size_t i) { return bins.mass[i]; });
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = order[k];
    const double here = double(tally.samples) * bins.mass[i];
    expected += here;
    observed += tally.weight[i];
    variance += here * (tally.weight[i] > 0 ? tally.weight2[i] / tally.weight[i] : ratio);
    counts += drawn * bins.mass[i] / bins.total;
    if (counts >= least_count && variance > 0 && k + 1 < n) close_group();
  }
  if (variance > 0) close_group();
  CheckResult result = verdict("chi_square_weights", statistic, std::max(groups, 1), options);
  result.passed = result.passed && tally.invalid == 0 && groups > 1;
  result.detail = text("%.0f groups, level %.2g, %.0f invalid", tally.sampler, groups,
                       sidak(options.family_significance, options.tests), double(tally.invalid));
  return result;
}

CheckResult check_mean_weight(const Tally& tally, const Bins& bins, const ChiSquareOptions& options,
                              double tolerance) {
  CompensatedSum sum, sum2;
  for (std::size_t i = 0; i < tally.weight.size(); ++i) sum += tally.weight[i], sum2 += tally.weight2[i];
  const double n = double(tally.samples), mean = sum.value() / n;
  const double error = std::sqrt(std::max(sum2.value() / n - mean * mean, 0.) / (n - 1));
  const double level = sidak(options.family_significance, options.tests);
  CheckResult result;
  result.name = "mean_weight";
  result.statistic = std::abs(mean - bins.total);
  result.threshold = normal_two_sided_quantile(level) * error + tolerance * bins.total;
  result.passed = result.statistic <= result.threshold && tally.invalid == 0;
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "%s, mean %.7g, albedo %.7g, standard error %.2g",
                tally.sampler.c_str(), mean, bins.total, error);
  result.detail = buffer;
  return result;
}

CheckResult check_together(const std::string& name, std::span<const double> p_values,
                           const ChiSquareOptions& options) {
  double sum = 0;
  for (const double p : p_values) sum += normal_upper_quantile(std::clamp(p, 1e-300, 1 - 1e-15));
  CheckResult result;
  result.name = name;
  result.statistic = p_values.empty() ? 0 : sum / std::sqrt(double(p_values.size()));
  const double level = sidak(options.family_significance, options.tests);
  result.threshold = normal_upper_quantile(level);
  result.p_value = 0.5 * std::erfc(result.statistic / std::sqrt(2.));
  result.passed = result.statistic <= result.threshold;
  result.detail = std::to_string(p_values.size()) + " directions wo together, in standard deviations";
  return result;
}

double relative_variance(const Tally& tally) {
  double sum = 0, sum2 = 0;
  for (std::size_t i = 0; i < tally.weight.size(); ++i) sum += tally.weight[i], sum2 += tally.weight2[i];
  const double n = double(tally.samples);
  return sum > 0 ? n * sum2 / (sum * sum) - 1 : 0;
}

}  // namespace reflectree
