// SPDX-License-Identifier: Apache-2.0
// Figures of a sampler that verify and demo share.
#pragma once

#include "reflectree/verify/attack.hpp"
#include "subject.hpp"

namespace reflectree::cli {

// wo in the x-z plane, uniform in theta_o from 0 to 89.9 degrees.
Direction random_viewer(Pcg32& u);
// A list of elevations in degrees, such as "0,45,80", each in [0, 90); throws Error.
std::vector<double> parse_theta_o(const std::string& text);

// An attack, then trials.
struct Overshoot {
  AttackResult attack;
  OvershootMass mass;
};
Overshoot measure_overshoot(const OpenedSampler& subject, std::uint64_t trials, std::uint64_t seed,
                            const Host& host);

// Over random wo, one thread, the function called through AnyBrdf, evaluation and random numbers included.
struct Speed {
  double mean_trials = 0;  // of exact mode
  double exact_ns = 0, one_shot_ns = 0;
};
Speed measure_speed(const OpenedSampler& subject, std::uint64_t seed);

}  // namespace reflectree::cli
