// SPDX-License-Identifier: Apache-2.0
// What the doctor examines: anybody's eval, sample and pdf, as functions over batches. A renderer's own
// code, another library, a program on a pipe (program_patient.hpp): whatever fills in the three functions.
//
//   const Patient mine = patient("mine", f, [](Direction wo, Pcg32& u) { ... },
//                                [](Direction wo, Direction wi) { ... });
//   const Diagnosis diagnosis = doctor(mine);        // doctor.hpp
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/sampler/any_sampler.hpp"

namespace reflectree {

// What eval returns: f in sr^-1, or f cos_theta_i. `detect`: the doctor finds out, and says so.
enum class EvalKind : std::uint8_t { detect, f, f_cos };
// What sample returns beside the direction and its pdf: f cos_theta_i / pdf, one of the other two, or nothing.
enum class ValueKind : std::uint8_t { detect, weight, f_cos, f, none };

struct PatientDraw {
  Direction wi{};
  double pdf = 0;      // per solid angle, sr^-1
  bool drawn = false;  // false: "no sample", a lost draw that counts as weight 0
};

// All three are called with as many wo as wi or draws. Both directions are unit vectors that point away from
// the surface; z is the normal; wo is known, wi is sampled. They may throw Error, which ends the examination.
struct Patient {
  std::string name = "sampler";
  int channels = 1;  // of eval and of sample's values: out[i * channels + c]
  EvalKind eval_kind = EvalKind::f;
  ValueKind value_kind = ValueKind::weight;
  bool concurrent = true;  // false: called from one thread
  std::function<void(std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out)>
      eval;
  // The same wo and the same seed give the same draws. Within a call draws are independent.
  std::function<void(std::span<const Direction> wo, std::uint64_t seed, std::span<PatientDraw> draws,
                     std::span<double> values)>
      sample;
  // Density of sample's directions per solid angle, sr^-1. Empty: the method has none.
  std::function<void(std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out)>
      pdf;
};

// eval alone, of a function.
Patient patient(const AnyBrdf& f);

// A sampler of ours, a peer's, or any other chosen at run time.
Patient patient(const AnyBrdf& f, const AnySampler<Spectrum>& sampler);

// One direction at a time. draw(wo, u) returns an optional of anything with wi, pdf and weight (a number, Rgb
// or Spectrum with as many channels as f); density(wo, wi) the pdf per solid angle.
template <class Draw, class Density>
Patient patient(std::string name, const AnyBrdf& f, Draw draw, Density density) {
  Patient p = patient(f);
  p.name = std::move(name);
  const auto channels = std::size_t(p.channels);
  p.sample = [draw, channels](std::span<const Direction> wo, std::uint64_t seed, std::span<PatientDraw> draws,
                              std::span<double> values) {
    Pcg32 u(seed, seed >> 32U);
    for (std::size_t i = 0; i < wo.size(); ++i) {
      draws[i] = {};
      const auto drawn = draw(wo[i], u);
      if (drawn) draws[i] = {drawn->wi, double(drawn->pdf), true};
      for (std::size_t c = 0; c < channels; ++c) {
        values[i * channels + c] = drawn ? double(channel_value(drawn->weight, int(c))) : 0;
      }
    }
  };
  p.pdf = [density](std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out) {
    for (std::size_t i = 0; i < wo.size(); ++i) out[i] = double(density(wo[i], wi[i]));
  };
  return p;
}
}  // namespace reflectree
