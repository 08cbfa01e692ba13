// SPDX-License-Identifier: Apache-2.0
// Erases the type of a sampler: every way into it, so that each can be judged alike.
#pragma once

#include <optional>
#include <vector>

#include "reflectree/sampler/sampler.hpp"
#include "reflectree/simd/sample_batch.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

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
  double last_miss_ = 0, last_variance_ = 0;
};

template <class Value>
void store(const DirectionSample<Value>& s, std::size_t channels, DrawnAt& out, float* weights) {
  out.wi = s.wi, out.pdf = s.pdf, out.drawn = s.flags != 0;
  for (std::size_t c = 0; c < channels; ++c) weights[c] = out.drawn ? channel_value(s.weight, int(c)) : 0.f;
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

// Borrows sampler and data. f: the sampler's own function.
template <Brdf F>
Suspect suspect(const Sampler<F>& sampler, AnyBrdf f, const SamplerData* data = nullptr) {
  const std::size_t channels = std::size_t(f.channels());
  const PackedSampler& packed = sampler.exact.packed();
  Suspect s{
      std::move(f), packed.target, ways_into(sampler.exact, channels), {}, {}, {}, {}, {}, {}, {}, {}, {},
      &packed,      data};
  for (WayIn& way : ways_into(sampler.one_shot, channels)) s.ways.push_back(std::move(way));
  s.exact_pdf = [&sampler](Direction wo, Direction wi) { return sampler.exact.pdf(wo, wi); };
  s.one_shot_pdf = [&sampler](Direction wo, Direction wi) { return sampler.one_shot.pdf(wo, wi); };
  s.albedo = [&sampler](Direction wo) { return double(sampler.exact.albedo(wo)); };
  s.point = [&sampler](Direction wo, double u1, double u2) -> std::optional<Direction> {
    if (const auto drawn = sampler.one_shot.sample(wo, u1, u2)) return drawn->wi;
    return std::nullopt;
  };
  s.invert = [&sampler](Direction wo, Direction wi) { return sampler.one_shot.invert(wo, wi); };
  s.propose = [&sampler](Direction wo, Pcg32& u) -> std::optional<Direction> {
    if (const auto drawn = sampler.one_shot.propose(wo, u)) return drawn->wi;
    return std::nullopt;
  };
  s.once = [&sampler, channels](Direction wo, Pcg32& u, std::span<float> weights) {
    const auto drawn = sampler.exact.sample_once(wo, u);
    for (std::size_t c = 0; c < channels; ++c)
      weights[c] = drawn ? channel_value(drawn->weight, int(c)) : 0.f;
  };
  return s;
}

// Of what is chosen at run time: compiled once, in the library, for it takes long.
extern template Suspect suspect(const Sampler<AnyBrdf>&, AnyBrdf, const SamplerData*);
extern template Suspect suspect(const Sampler<FamilyMember<AnyFamily>>&, AnyBrdf, const SamplerData*);

}  // namespace reflectree
