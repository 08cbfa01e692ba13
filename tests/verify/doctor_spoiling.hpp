// SPDX-License-Identifier: Apache-2.0
// What spoils a patient: its pdf, its draws, its weights, its eval, or all of its directions.
#pragma once

#include <memory>

#include "reflectree/peers/lobe.hpp"
#include "reflectree/verify/patient.hpp"

namespace reflectree::catalogue {

// Spoils pdf(wo, wi) by a function of it. both: the pdf that sample returns, too, and the weight with it.
using OfPdf = std::function<double(Direction wo, Direction wi, double pdf)>;
inline Patient with_pdf(Patient p, OfPdf spoil, bool both = true) {
  p.pdf = [inner = p.pdf, spoil](std::span<const Direction> wo, std::span<const Direction> wi,
                                 std::span<double> out) {
    inner(wo, wi, out);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = spoil(wo[i], wi[i], out[i]);
  };
  if (!both) return p;
  const auto channels = std::size_t(p.channels);
  p.sample = [inner = p.sample, spoil, channels](std::span<const Direction> wo, std::uint64_t seed,
                                                 std::span<PatientDraw> draws, std::span<double> values) {
    inner(wo, seed, draws, values);
    for (std::size_t i = 0; i < draws.size(); ++i) {
      if (!draws[i].drawn) continue;
      const double before = draws[i].pdf;
      draws[i].pdf = spoil(wo[i], draws[i].wi, before);
      for (std::size_t c = 0; c < channels; ++c) values[i * channels + c] *= before / draws[i].pdf;
    }
  };
  return p;
}
// Spoils a draw and its values.
using OfDraw =
    std::function<void(Direction wo, std::size_t number, PatientDraw& draw, std::span<double> values)>;
inline Patient with_draw(Patient p, OfDraw spoil) {
  const auto channels = std::size_t(p.channels);
  p.sample = [inner = p.sample, spoil, channels](std::span<const Direction> wo, std::uint64_t seed,
                                                 std::span<PatientDraw> draws, std::span<double> values) {
    inner(wo, seed, draws, values);
    for (std::size_t i = 0; i < draws.size(); ++i) {
      if (draws[i].drawn) spoil(wo[i], i, draws[i], values.subspan(i * channels, channels));
    }
  };
  return p;
}
inline Patient with_weight(Patient p, std::function<double(Direction wo, Direction wi, double pdf)> factor) {
  return with_draw(std::move(p),
                   [factor](Direction wo, std::size_t, PatientDraw& d, std::span<double> values) {
                     for (double& v : values) v *= factor(wo, d.wi, d.pdf);
                   });
}
using OfValue = std::function<double(Direction wo, Direction wi, double value)>;
inline Patient with_eval(Patient p, OfValue spoil) {
  const auto channels = std::size_t(p.channels);
  p.eval = [inner = p.eval, spoil, channels](std::span<const Direction> wo, std::span<const Direction> wi,
                                             std::span<double> out) {
    inner(wo, wi, out);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = spoil(wo[k / channels], wi[k / channels], out[k]);
  };
  return p;
}

// eval and pdf of one patient, directions from elsewhere: draw(wo, u) -> optional<Direction>. The weight is
// f cos_theta_i over that pdf.
using OfDirection = std::function<std::optional<Direction>(Direction wo, Pcg32& u)>;
inline Patient with_directions(Patient p, OfDirection draw) {
  const auto channels = std::size_t(p.channels);
  p.sample = [eval = p.eval, pdf = p.pdf, draw, channels](std::span<const Direction> wo, std::uint64_t seed,
                                                          std::span<PatientDraw> draws,
                                                          std::span<double> values) {
    Pcg32 u(seed);
    std::vector<Direction> wi(wo.size());
    for (std::size_t i = 0; i < wo.size(); ++i) {
      const auto drawn = draw(wo[i], u);
      draws[i] = {drawn.value_or(Direction{0, 0, 1}), 0, drawn.has_value()};
      wi[i] = draws[i].wi;
    }
    std::vector<double> density(wo.size());
    pdf(wo, wi, density);
    eval(wo, wi, values);
    for (std::size_t i = 0; i < wo.size(); ++i) {
      draws[i].pdf = draws[i].drawn ? density[i] : 0;
      for (std::size_t c = 0; c < channels; ++c) {
        double& v = values[i * channels + c];
        v = draws[i].drawn && density[i] > 0 ? v * double(wi[i].z) / density[i] : 0;
      }
    }
  };
  return p;
}
inline OfDirection directions_of(LobeMixture mixture) {
  return [mixture](Direction wo, Pcg32& u) -> std::optional<Direction> {
    UniformBits bits(u);
    const auto drawn = mixture.sample(wo, bits);
    u = bits.rest();
    if (!drawn) return std::nullopt;
    return drawn->wi;
  };
}
inline OfDirection changed(OfDirection draw, std::function<Direction(Direction wo, Direction wi)> change) {
  return [draw, change](Direction wo, Pcg32& u) -> std::optional<Direction> {
    const auto wi = draw(wo, u);
    if (!wi) return wi;
    return change(wo, *wi);
  };
}

}  // namespace reflectree::catalogue
