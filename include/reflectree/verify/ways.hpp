// SPDX-License-Identifier: Apache-2.0
// Every way into a sampler, its type erased, so that each can be judged alike: one direction at a time, many
// at once, batches in lanes, from bits and from points of the square.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reflectree/sampler/sampler.hpp"
#include "reflectree/simd/sample_batch.hpp"
#include "reflectree/verify/attack.hpp"
#include "reflectree/verify/erased.hpp"

namespace reflectree {

struct DrawnAt {
  Direction wi;
  float pdf = 0;
  bool drawn = false;      // false: "no sample"
  std::uint16_t lane = 0;  // place in a call of batch_lanes directions; no_lane in any other
};
inline constexpr std::size_t batch_lanes = 64;
inline constexpr std::uint16_t no_lane = batch_lanes;

// What a caller may see of exact mode's trials: acceptance by lane, overshoots, and where it gives up.
struct TrialLog {
  struct Lane {
    std::uint64_t trials = 0, accepted = 0;
    double expected = 0, variance = 0;  // of `accepted`: sums of p and p (1 - p), p = min(1, T / (a M))
  };
  std::array<Lane, batch_lanes + 1> lane;  // the last: trials whose lane is not known
  OvershootSums sums;                      // of T / (a M)
  std::uint64_t exhausted = 0;
  void add(const TrialLog& other);
};

// out.size() directions for wo; weights holds out.size() * channels values.
struct WayIn {
  std::string name;
  bool exact = true;  // density t cos_i / a; else that of one-shot mode's pdf()
  std::function<void(Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights)> draw;
  // Exact mode: n directions, with the trials that they took.
  std::function<void(Direction wo, Pcg32& u, std::size_t n, TrialLog& log)> watch;
  // Exact mode: the trials after which it gives up where every acceptance is refused; 0: it did not give up.
  std::function<std::uint64_t(Direction wo)> give_up;
};

namespace detail {

// Random bits that refuse every acceptance whose probability is below 1.
struct StubbornBits {
  std::uint32_t operator()() { return 0xffffffffU; }
};
struct TrialCounter {
  std::uint64_t trials = 0;
  bool gave_up = false;
  void trial(bool, float, float) { ++trials; }
  void exhausted() { gave_up = true; }
};
// The first batch_lanes trials of a call are lanes 0, 1, ...: the pending trials of one full block.
class LaneWatcher {
 public:
  LaneWatcher(TrialLog& log, bool lanes) : log_(log), next_(lanes ? 0 : batch_lanes) {}
  void trial(bool accepted, float ratio, float majorant);
  void exhausted() { ++log_.exhausted; }

 private:
  TrialLog& log_;
  std::size_t next_;
};

template <class Value>
void store(const DirectionSample<Value>& s, std::size_t channels, DrawnAt& out, float* weights) {
  out.wi = s.wi, out.pdf = s.pdf, out.drawn = s.flags != 0;
  for (std::size_t c = 0; c < channels; ++c) weights[c] = out.drawn ? channel(s.weight, int(c)) : 0.f;
}

// one(u) for every place of out.
template <class One>
void draw_singly(std::size_t channels, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights,
                 const One& one) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {};
    out[i].lane = no_lane;
    if (const auto s = one(u)) store(*s, channels, out[i], weights.data() + i * channels);
  }
}

// many(u, span of samples) -> number filled, in calls of 1 to 48 directions.
template <class Value, class Many>
void draw_many(std::size_t channels, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights,
               const Many& many) {
  std::vector<DirectionSample<Value>> samples(48);
  for (std::size_t i = 0; i < out.size();) {
    const std::size_t n = std::min<std::size_t>(1 + u() % samples.size(), out.size() - i);
    const std::size_t filled = many(u, std::span(samples.data(), n));
    for (std::size_t k = 0; k < n; ++k, ++i) {
      out[i] = {};
      out[i].lane = no_lane;
      if (k < filled) store(samples[k], channels, out[i], weights.data() + i * channels);
    }
  }
}

// The other directions of a batch: any elevation and azimuth, the horizon and what lies below among them.
std::vector<Direction> strangers(std::size_t n, Pcg32& u);

// batch(wo of every place, u, samples). wo takes every other place of a call, so that a lane which computes
// with its neighbour's numbers is seen; calls of one full block take turns with longer ones.
template <class Value, class Batch>
void draw_batches(std::size_t channels, Direction wo, Pcg32& u, std::span<DrawnAt> out,
                  std::span<float> weights, const Batch& batch) {
  std::vector<DirectionSample<Value>> samples;
  for (std::size_t i = 0; i < out.size();) {
    const bool one_block = u() % 4 != 0;
    const std::size_t size = one_block ? batch_lanes : batch_lanes + 2 + u() % 100;
    std::vector<Direction> wos = strangers(size, u);
    const std::size_t first = u() % 2;
    for (std::size_t k = first; k < size; k += 2) wos[k] = wo;
    samples.resize(size);
    batch(std::span<const Direction>(wos), u, std::span(samples));
    for (std::size_t k = first; k < size && i < out.size(); k += 2, ++i) {
      out[i] = {};
      out[i].lane = one_block ? std::uint16_t(k) : no_lane;
      store(samples[k], channels, out[i], weights.data() + i * channels);
    }
  }
}

template <class Draw>
std::uint64_t trials_until_given_up(const Draw& draw) {
  StubbornBits bits;
  TrialCounter counter;
  draw(bits, counter);
  return counter.gave_up ? counter.trials : 0;
}

}  // namespace detail

// Borrows the sampler. `channels`: of f.
template <Brdf F>
std::vector<WayIn> ways_into(const ExactSampler<F>& s, std::size_t channels) {
  using Value = ValueOf<F>;
  using Samples = std::span<DirectionSample<Value>>;
  using Wos = std::span<const Direction>;
  std::vector<WayIn> ways(3);
  ways[0].name = "exact";
  ways[0].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_singly(channels, u, out, weights, [&](Pcg32& bits) { return s.sample(wo, bits); });
  };
  ways[0].watch = [&s](Direction wo, Pcg32& u, std::size_t n, TrialLog& log) {
    detail::LaneWatcher watcher(log, false);
    for (std::size_t i = 0; i < n; ++i) s.sample(wo, u, watcher);
  };
  ways[0].give_up = [&s](Direction wo) {
    return detail::trials_until_given_up([&](auto& bits, auto& count) { s.sample(wo, bits, count); });
  };
  ways[1].name = "exact, n";
  ways[1].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_many<Value>(channels, u, out, weights,
                             [&](Pcg32& bits, Samples samples) { return s.sample_n(wo, bits, samples); });
  };
  ways[1].watch = [&s](Direction wo, Pcg32& u, std::size_t n, TrialLog& log) {
    detail::LaneWatcher watcher(log, false);
    std::vector<DirectionSample<Value>> samples(std::min<std::size_t>(n, 32));
    for (std::size_t i = 0; i < n; i += samples.size()) s.sample_n(wo, u, Samples(samples), watcher);
  };
  ways[1].give_up = [&s](Direction wo) {
    std::vector<DirectionSample<Value>> one(1);
    return detail::trials_until_given_up(
        [&](auto& bits, auto& count) { s.sample_n(wo, bits, Samples(one), count); });
  };
  ways[2].name = "exact, batch";
  ways[2].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_batches<Value>(channels, wo, u, out, weights, [&](Wos wos, Pcg32& bits, Samples samples) {
      sample_batch(s, wos, bits, samples);
    });
  };
  ways[2].watch = [&s](Direction wo, Pcg32& u, std::size_t n, TrialLog& log) {
    const std::vector<Direction> wos(batch_lanes, wo);
    std::vector<DirectionSample<Value>> samples(batch_lanes);
    for (std::size_t i = 0; i < n; i += batch_lanes) {
      detail::LaneWatcher watcher(log, true);
      sample_batch(s, Wos(wos), u, Samples(samples), watcher);
    }
  };
  ways[2].give_up = [&s](Direction wo) {
    std::vector<DirectionSample<Value>> one(1);
    return detail::trials_until_given_up(
        [&](auto& bits, auto& count) { sample_batch(s, Wos(&wo, 1), bits, Samples(one), count); });
  };
  return ways;
}

template <Brdf F>
std::vector<WayIn> ways_into(const OneShotSampler<F>& s, std::size_t channels) {
  using Value = ValueOf<F>;
  using Samples = std::span<DirectionSample<Value>>;
  using Wos = std::span<const Direction>;
  std::vector<WayIn> ways(5);
  for (WayIn& way : ways) way.exact = false;
  ways[0].name = "one-shot";
  ways[0].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_singly(channels, u, out, weights, [&](Pcg32& bits) { return s.sample(wo, bits); });
  };
  ways[1].name = "one-shot, points";
  ways[1].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_singly(channels, u, out, weights, [&](Pcg32& bits) {
      const double u1 = to_unit_double(bits()), u2 = to_unit_double(bits());
      return s.sample(wo, u1, u2);
    });
  };
  ways[2].name = "one-shot, n";
  ways[2].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_many<Value>(channels, u, out, weights,
                             [&](Pcg32& bits, Samples samples) { return s.sample_n(wo, bits, samples); });
  };
  ways[3].name = "one-shot, batch";
  ways[3].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_batches<Value>(channels, wo, u, out, weights, [&](Wos wos, Pcg32& bits, Samples samples) {
      sample_batch(s, wos, bits, samples);
    });
  };
  ways[4].name = "one-shot, batch of points";
  ways[4].draw = [&s, channels](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    detail::draw_batches<Value>(channels, wo, u, out, weights, [&](Wos wos, Pcg32& bits, Samples samples) {
      std::vector<Vec2<double>> points(wos.size());
      for (auto& p : points) p.x = to_unit_double(bits()), p.y = to_unit_double(bits());
      sample_batch(s, wos, std::span<const Vec2<double>>(points), samples);
    });
  };
  return ways;
}

}  // namespace reflectree
