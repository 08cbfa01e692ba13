// SPDX-License-Identifier: Apache-2.0
// Sampling through the C interface, in blocks.
#include <bit>

#include "directions.hpp"
#include "handles.hpp"
#include "reflectree/simd/sample_batch.hpp"

using namespace reflectree;
using namespace reflectree::c;

namespace {

static_assert(sizeof(reflectree_pcg32) == sizeof(Pcg32));

struct CallersBits {
  reflectree_bits next;
  void* state;
  std::uint32_t operator()() { return next(state); }
};

// draw(bits): our own generator is called without its pointer.
template <class Draw>
void with_bits(reflectree_bits next, void* state, const Draw& draw) {
  if (next != reflectree_pcg32_next) {
    CallersBits bits{next, state};
    draw(bits);
    return;
  }
  auto& kept = *static_cast<reflectree_pcg32*>(state);
  Pcg32 bits = std::bit_cast<Pcg32>(kept);
  draw(bits);
  kept = std::bit_cast<reflectree_pcg32>(bits);
}

// Where samples go.
struct Output {
  std::size_t channels;
  float *wi, *pdf, *weight;
  void store(std::size_t i, const DirectionSample<Spectrum>& s) const {
    c::store(s.wi, wi, i);
    if (pdf) pdf[i] = s.pdf;
    if (weight) std::copy_n(s.weight.data(), channels, weight + i * channels);
  }
};

Output output(const reflectree_sampler& s, std::size_t n, const float* wo, float* wi, float* pdf,
              float* weight, const char* where) {
  const auto channels = std::size_t(s.sampler.exact.brdf().channels());
  check_count(n, std::max<std::size_t>(3, channels), where);
  needed_for(n, wo, where, "wo"), needed_for(n, wi, where, "wi");
  return {channels, wi, pdf, weight};
}

// draw(directions, samples, first) of every block. A single viewer goes through one(wo): the lanes of a block
// cost a renderer that asks for one direction at a time three times as much.
template <class One, class Draw>
void sample_blocks(std::size_t n, const float* wo, const Output& out, const One& one, const Draw& draw) {
  if (n == 1) {
    const std::optional<DirectionSample<Spectrum>> drawn = one(direction_at(wo, 0));
    out.store(0, drawn ? *drawn : DirectionSample<Spectrum>{{}, 0, Spectrum(int(out.channels)), 0});
    return;
  }
  std::array<Direction, block_size> directions;
  std::vector<DirectionSample<Spectrum>> samples(std::min(n, block_size));
  in_blocks(n, [&](std::size_t first, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) directions[k] = direction_at(wo, first + k);
    draw(std::span<const Direction>(directions.data(), count),
         std::span<DirectionSample<Spectrum>>(samples.data(), count), first);
    for (std::size_t k = 0; k < count; ++k) out.store(first + k, samples[k]);
  });
}

// Both ways that take random bits.
template <class S>
void sample_by_bits(const reflectree_sampler& s, const S& sampler, std::size_t n, const float* wo,
                    reflectree_bits bits, void* state, float* wi, float* pdf, float* weight,
                    const char* where) {
  const Output out = output(s, n, wo, wi, pdf, weight, where);
  if (!bits) refuse(where, "bits is null", "pass reflectree_pcg32_next and a reflectree_pcg32");
  if (bits == reflectree_pcg32_next) needed(state, where, "state");
  with_bits(bits, state, [&](auto& u) {
    sample_blocks(
        n, wo, out, [&](Direction w) { return sampler.sample(w, u); },
        [&](auto directions, auto samples, std::size_t) { sample_batch(sampler, directions, u, samples); });
  });
}

// value(i) of every pair or viewer.
template <class Value>
void for_each_value(std::size_t n, float* out, const Value& value) {
  for (std::size_t i = 0; i < n; ++i) out[i] = value(i);
}

}  // namespace

extern "C" {

void reflectree_pcg32_seed(reflectree_pcg32* state, uint64_t seed, uint64_t stream) {
  if (state) *state = std::bit_cast<reflectree_pcg32>(Pcg32(seed, stream));
}

uint32_t reflectree_pcg32_next(void* state) {
  auto& kept = *static_cast<reflectree_pcg32*>(state);
  Pcg32 bits = std::bit_cast<Pcg32>(kept);
  const std::uint32_t word = bits();
  kept = std::bit_cast<reflectree_pcg32>(bits);
  return word;
}

reflectree_status reflectree_sample_exact(const reflectree_sampler* s, size_t n, const float* wo,
                                          reflectree_bits bits, void* state, float* wi, float* pdf,
                                          float* weight) {
  return at_border([&] {
    constexpr const char* where = "reflectree_sample_exact";
    const reflectree_sampler& known = checked(s, where, "s");
    sample_by_bits(known, known.sampler.exact, n, wo, bits, state, wi, pdf, weight, where);
  });
}

reflectree_status reflectree_sample_one_shot(const reflectree_sampler* s, size_t n, const float* wo,
                                             reflectree_bits bits, void* state, float* wi, float* pdf,
                                             float* weight) {
  return at_border([&] {
    constexpr const char* where = "reflectree_sample_one_shot";
    const reflectree_sampler& known = checked(s, where, "s");
    sample_by_bits(known, known.sampler.one_shot, n, wo, bits, state, wi, pdf, weight, where);
  });
}

reflectree_status reflectree_sample_uniforms(const reflectree_sampler* s, size_t n, const float* wo,
                                             const double* u, float* wi, float* pdf, float* weight) {
  return at_border([&] {
    constexpr const char* where = "reflectree_sample_uniforms";
    const Output out = output(checked(s, where, "s"), n, wo, wi, pdf, weight, where);
    needed_for(n, u, where, "u");
    std::array<Vec2<double>, block_size> points;
    sample_blocks(
        n, wo, out, [&](Direction w) { return s->sampler.one_shot.sample(w, u[0], u[1]); },
        [&](auto directions, auto samples, std::size_t first) {
          for (std::size_t k = 0; k < directions.size(); ++k)
            points[k] = {u[2 * (first + k)], u[2 * (first + k) + 1]};
          sample_batch(s->sampler.one_shot, directions,
                       std::span<const Vec2<double>>(points.data(), directions.size()), samples);
        });
  });
}

reflectree_status reflectree_eval(const reflectree_sampler* s, size_t n, const float* wo, const float* wi,
                                  float* values) {
  return at_border([&] {
    constexpr const char* where = "reflectree_eval";
    eval_pairs(checked(s, where, "s").sampler.exact.brdf(), n, wo, wi, values, where);
  });
}

reflectree_status reflectree_pdf(const reflectree_sampler* s, int mode, size_t n, const float* wo,
                                 const float* wi, float* pdf) {
  return at_border([&] {
    constexpr const char* where = "reflectree_pdf";
    const Sampler<AnyBrdf>& sampler = checked(s, where, "s").sampler;
    if (mode != REFLECTREE_EXACT && mode != REFLECTREE_ONE_SHOT)
      refuse(where, "mode is " + std::to_string(mode), "pass REFLECTREE_EXACT or REFLECTREE_ONE_SHOT");
    check_count(n, 3, where);
    needed_for(n, wo, where, "wo"), needed_for(n, wi, where, "wi"), needed_for(n, pdf, where, "pdf");
    for_each_value(n, pdf, [&](std::size_t i) {
      const Direction o = direction_at(wo, i), w = direction_at(wi, i);
      if (!is_above(w)) return 0.f;
      return mode == REFLECTREE_EXACT ? sampler.exact.pdf(o, w) : sampler.one_shot.pdf(o, w);
    });
  });
}

reflectree_status reflectree_albedo(const reflectree_sampler* s, size_t n, const float* wo, float* albedo) {
  return at_border([&] {
    constexpr const char* where = "reflectree_albedo";
    const ExactSampler<AnyBrdf>& sampler = checked(s, where, "s").sampler.exact;
    check_count(n, 3, where);
    needed_for(n, wo, where, "wo"), needed_for(n, albedo, where, "albedo");
    const float unit = 1 / s->data.target.scale;  // a power of two
    for_each_value(n, albedo, [&](std::size_t i) { return unit * sampler.albedo(direction_at(wo, i)); });
  });
}

reflectree_status reflectree_expected_trials(const reflectree_sampler* s, size_t n, const float* wo,
                                             float* trials) {
  return at_border([&] {
    constexpr const char* where = "reflectree_expected_trials";
    const ExactSampler<AnyBrdf>& sampler = checked(s, where, "s").sampler.exact;
    check_count(n, 3, where);
    needed_for(n, wo, where, "wo"), needed_for(n, trials, where, "trials");
    for_each_value(n, trials, [&](std::size_t i) { return sampler.expected_trials(direction_at(wo, i)); });
  });
}

reflectree_status reflectree_invert(const reflectree_sampler* s, size_t n, const float* wo, const float* wi,
                                    double* u) {
  return at_border([&] {
    constexpr const char* where = "reflectree_invert";
    const OneShotSampler<AnyBrdf>& sampler = checked(s, where, "s").sampler.one_shot;
    check_count(n, 3, where);
    needed_for(n, wo, where, "wo"), needed_for(n, wi, where, "wi"), needed_for(n, u, where, "u");
    for (std::size_t i = 0; i < n; ++i) {
      const Direction w = direction_at(wi, i);
      const auto at = is_above(w) ? sampler.invert(direction_at(wo, i), w) : std::nullopt;
      u[2 * i] = at ? at->x : -1, u[2 * i + 1] = at ? at->y : -1;
    }
  });
}
}
