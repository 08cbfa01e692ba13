// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/way_tally.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "neighbours.hpp"
#include "parallel.hpp"
#include "reflectree/verify/reference_target.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t chunk = 1 << 13;

WayTally empty_tally(const WayIn& way, std::size_t bins, std::size_t channels) {
  WayTally t;
  t.sampler = way.name;
  t.count.resize(bins);
  t.weight.resize(bins);
  t.weight2.resize(bins);
  t.channel.resize(channels);
  t.channel2.resize(channels);
  t.lane_count.resize(batch_lanes * lane_groups);
  return t;
}

template <class T>
void add_to(std::vector<T>& sum, const std::vector<T>& part) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
}

bool lit(const AnyBrdf& f, Direction wo, Direction wi) {
  const auto around = detail::neighbours(wi);
  std::vector<float> values(around.size() * std::size_t(f.channels()));
  channel_values(f, normalize(Vec3<double>{wo.x, wo.y, wo.z}), around, values);
  const std::size_t channels = std::size_t(f.channels());
  for (std::size_t k = 0; k < around.size(); ++k) {
    const auto* at = values.data() + k * channels;
    if (std::all_of(at, at + channels, [](float v) { return v == 0; })) return false;
  }
  return true;
}

void draw_chunk(const Suspect& s, const WayIn& way, const Bins& bins, Pcg32 u, std::uint64_t n, WayTally& t) {
  const std::size_t channels = s.channels();
  std::vector<DrawnAt> drawn(n);
  std::vector<float> weights(n * channels);
  way.draw(bins.wo, u, drawn, weights);
  t.samples += n;
  for (std::size_t i = 0; i < n; ++i) {
    const DrawnAt& d = drawn[i];
    if (!d.drawn) {
      ++t.none;
      continue;
    }
    const std::span<const float> w = std::span(weights).subspan(i * channels, channels);
    const double weight = reference_target(s.target, w);
    if (!(d.wi.z > 0) || !(std::abs(dot(d.wi, d.wi) - 1) < 1e-4f) || !std::isfinite(weight) ||
        !std::isfinite(d.pdf)) {
      ++t.invalid;
      continue;
    }
    if (!(weight > 0)) {
      ++t.dead;
      t.dead_lit += lit(s.f, bins.wo, d.wi);
    }
    const std::size_t b = bins.find(d.wi);
    ++t.count[b];
    t.weight[b] += weight;
    t.weight2[b] += weight * weight;
    for (std::size_t c = 0; c < channels; ++c) {
      t.channel[c] += double(w[c]);
      t.channel2[c] += sqr(double(w[c]));
    }
    if (d.lane < batch_lanes) {
      ++t.lane_count[d.lane * lane_groups + b * lane_groups / t.count.size()];
    }
  }
}

}  // namespace

WayTally tally_of(const Suspect& s, const WayIn& way, const Bins& bins, std::uint64_t samples,
                  std::uint64_t seed, const Host& host) {
  const std::size_t size = std::max<std::size_t>(bins.boxes.size(), 1);
  const std::uint64_t chunks = (samples + chunk - 1) / chunk;
  std::vector<WayTally> parts(chunks, empty_tally(way, size, s.channels()));
  detail::for_each_index(host, s.concurrent(), chunks, [&](std::size_t c) {
    draw_chunk(s, way, bins, detail::part_generator(seed, c), std::min(chunk, samples - c * chunk), parts[c]);
  });
  WayTally sum = empty_tally(way, size, s.channels());
  for (const WayTally& p : parts) {
    sum.samples += p.samples;
    sum.none += p.none;
    sum.dead += p.dead;
    sum.dead_lit += p.dead_lit;
    sum.invalid += p.invalid;
    add_to(sum.count, p.count);
    add_to(sum.weight, p.weight);
    add_to(sum.weight2, p.weight2);
    add_to(sum.channel, p.channel);
    add_to(sum.channel2, p.channel2);
    add_to(sum.lane_count, p.lane_count);
  }
  return sum;
}

std::vector<ChannelReference> channel_references(const AnyBrdf& f, Direction wo, std::uint64_t seed,
                                                 const Host& host) {
  constexpr std::size_t few = 4;
  const auto channels = std::size_t(f.channels());
  Pcg32 u = detail::part_generator(seed, 0);
  std::vector<ChannelReference> references(std::min(channels, few));
  for (std::size_t k = 0; k < references.size(); ++k) {
    auto& coefficients = references[k].coefficients;
    coefficients.resize(channels);
    if (channels <= few) {
      coefficients[k] = 1;
    } else {
      for (double& c : coefficients) c = to_unit_double(u());
    }
  }
  detail::for_each_index(host, f.traits().concurrent, references.size(), [&](std::size_t k) {
    ReferenceOptions options;
    options.relative_tolerance = 3e-5;
    options.max_evaluations = 500'000;
    references[k].integral = reference_albedo(combined_channels(f, references[k].coefficients), wo, options);
  });
  return references;
}

CheckResult check_channel_weights(const WayTally& tally, std::span<const ChannelReference> references,
                                  const ChiSquareOptions& options, double tolerance) {
  CheckResult result;
  result.name = "channel_weights";
  const double n = double(tally.samples);
  const double z =
      normal_two_sided_quantile(sidak(options.family_significance, options.tests * int(references.size())));
  result.threshold = 1;
  result.statistic = 0;
  char buffer[160] = "";
  for (std::size_t k = 0; k < references.size(); ++k) {
    const ChannelReference& r = references[k];
    double mean = 0, deviation = 0;  // of a sum: at most the sum of the deviations
    for (std::size_t c = 0; c < r.coefficients.size(); ++c) {
      const double m = tally.channel[c] / n;
      mean += r.coefficients[c] * m;
      deviation += std::abs(r.coefficients[c]) * std::sqrt(std::max(tally.channel2[c] / n - m * m, 0.));
    }
    const double allowed = z * deviation / std::sqrt(std::max(n - 1, 1.)) + tolerance * r.integral.value +
                           std::min(r.integral.error, 3e-4 * r.integral.value) + 1e-30;
    const double excess = std::abs(mean - r.integral.value) / allowed;
    if (k > 0 && excess <= result.statistic) continue;
    result.statistic = excess;
    std::snprintf(buffer, sizeof buffer, "%s, worst of %zu: %s %zu: mean weight %.7g, integral %.7g",
                  tally.sampler.c_str(), references.size(),
                  r.coefficients.size() == references.size() ? "channel" : "combination", k, mean,
                  r.integral.value);
  }
  result.passed = result.statistic <= 1 && tally.invalid == 0;
  result.detail = buffer;
  result.way = tally.sampler;
  return result;
}

CheckResult check_lanes(const WayTally& tally, const ChiSquareOptions& options) {
  std::array<double, lane_groups> all{};
  double total = 0;
  for (std::size_t i = 0; i < tally.lane_count.size(); ++i) {
    all[i % lane_groups] += double(tally.lane_count[i]);
    total += double(tally.lane_count[i]);
  }
  const double level = sidak(options.family_significance, options.tests * int(batch_lanes));
  CheckResult result;
  result.name = "lanes";
  result.way = tally.sampler;
  result.threshold = chi_square_quantile(level, double(lane_groups - 1));
  std::size_t worst = 0, silent = 0;
  for (std::size_t l = 0; l < batch_lanes; ++l) {
    double drawn = 0, statistic = 0;
    for (std::size_t g = 0; g < lane_groups; ++g) drawn += double(tally.lane_count[l * lane_groups + g]);
    silent += !(drawn > 0);
    for (std::size_t g = 0; g < lane_groups; ++g) {
      const double expected = drawn * all[g] / total;
      if (expected > 0) statistic += sqr(double(tally.lane_count[l * lane_groups + g]) - expected) / expected;
    }
    if (statistic > result.statistic) result.statistic = statistic, worst = l;
  }
  const double each = total / double(batch_lanes * lane_groups);
  result.p_value = chi_square_tail(result.statistic, double(lane_groups - 1));
  result.passed = silent == 0 && (each < 20 || result.statistic <= result.threshold);
  result.decided = each >= 20 || !result.passed;
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "%s, worst of %zu lanes: %zu; %zu lanes without a direction",
                tally.sampler.c_str(), batch_lanes, worst, silent);
  result.detail = buffer;
  return result;
}

CheckResult check_alive(const WayTally& tally, bool exact, double expected_none) {
  CheckResult result;
  result.name = "alive";
  result.way = tally.sampler;
  const std::uint64_t dead = exact ? tally.dead : tally.dead_lit;
  result.statistic = double(tally.none + tally.invalid + dead);
  if (expected_none > 1e-9) result.threshold = expected_none + 8 * std::sqrt(expected_none) + 8;
  result.passed = result.statistic <= result.threshold && tally.invalid + dead == 0;
  char buffer[200];
  std::snprintf(
      buffer, sizeof buffer,
      "%s, of %llu draws %llu no sample, %llu invalid, %llu weight 0 where f is not 0, %llu where it "
      "is",
      tally.sampler.c_str(), static_cast<unsigned long long>(tally.samples),
      static_cast<unsigned long long>(tally.none), static_cast<unsigned long long>(tally.invalid),
      static_cast<unsigned long long>(tally.dead_lit),
      static_cast<unsigned long long>(tally.dead - tally.dead_lit));
  result.detail = buffer;
  return result;
}

}  // namespace reflectree
