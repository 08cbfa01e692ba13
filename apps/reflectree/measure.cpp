// SPDX-License-Identifier: Apache-2.0
#include "measure.hpp"

#include <algorithm>
#include <chrono>

#include "reflectree/error.hpp"
#include "reflectree/formats/open.hpp"
#include "reflectree/text/number_text.hpp"
#include "reflectree/verify/trials.hpp"

namespace reflectree::cli {

namespace {

constexpr float degree = pi / 180;

struct FirstTrial {
  double ratio = -1;
  void trial(bool, float value, float majorant) {
    if (ratio < 0) ratio = double(value) / double(majorant);
  }
  void exhausted() {}
};

template <class Draw>
double nanoseconds(std::uint64_t seed, const Draw& draw) {
  constexpr int rounds = 3, samples = 60'000;
  constexpr std::size_t viewers = 1024;
  Pcg32 u(seed, 5);
  std::vector<Direction> wo(viewers);
  for (Direction& w : wo) w = random_viewer(u);
  double best = 1e30;
  for (int round = 0; round < rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < samples; ++i) draw(wo[i % viewers], u);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count() / samples);
  }
  return best;
}

}  // namespace

Direction random_viewer(Pcg32& u) { return direction_from_angles(89.9f * degree * to_unit_float(u()), 0.f); }

namespace {

// The ratio T / (a M) at the first trial of exact mode for a random wo.
RatioTrial first_trial_ratio(const OpenedSampler& subject) {
  return [&subject](Pcg32& u) {
    FirstTrial first;
    subject.sampler.exact.sample(random_viewer(u), u, first);
    return std::max(first.ratio, 0.);
  };
}

}  // namespace

std::vector<double> parse_theta_o(const std::string& text) {
  std::vector<double> theta_o_deg;
  std::string_view rest = text;
  while (true) {
    const auto theta = take_number(rest);
    if (!theta || !(*theta >= 0 && *theta < 90)) break;
    theta_o_deg.push_back(double(*theta));
    if (rest.empty()) return theta_o_deg;
    if (rest[0] != ',') break;
    rest.remove_prefix(1);
  }
  throw Error("'" + text + "' is no list of elevations", "--theta-o-deg",
              "give degrees from 0 to below 90, with commas between them");
}

Overshoot measure_overshoot(const OpenedSampler& subject, std::uint64_t trials, std::uint64_t seed,
                            const Host& host) {
  AttackOptions options;
  options.seed = seed;
  Overshoot result;
  result.attack = attack(bound_ratio(subject.f, subject.data), options, host);
  result.mass = overshoot_mass(first_trial_ratio(subject), trials, result.attack.worst, seed, host);
  return result;
}

Speed measure_speed(const OpenedSampler& subject, std::uint64_t seed) {
  Speed speed;
  SampleStatistics statistics;
  Pcg32 u(seed, 6);
  for (int i = 0; i < 100'000; ++i) subject.sampler.exact.sample(random_viewer(u), u, statistics);
  if (statistics.accepted) speed.mean_trials = double(statistics.trials) / double(statistics.accepted);
  // The sum keeps the work from being left out.
  double sum = 0;
  speed.exact_ns = nanoseconds(seed, [&](Direction wo, Pcg32& bits) {
    if (const auto s = subject.sampler.exact.sample(wo, bits)) sum += double(s->pdf);
  });
  speed.one_shot_ns = nanoseconds(seed, [&](Direction wo, Pcg32& bits) {
    if (const auto s = subject.sampler.one_shot.sample(wo, bits)) sum += double(s->pdf);
  });
  if (!(sum >= 0)) speed.exact_ns = speed.one_shot_ns = 0;
  return speed;
}

}  // namespace reflectree::cli
