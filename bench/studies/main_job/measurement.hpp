// SPDX-License-Identifier: Apache-2.0
// What the study measures of one material.
#pragma once

#include <nlohmann/json.hpp>

#include "material_list.hpp"
#include "reflectree/host.hpp"

namespace reflectree::study {

struct StudyOptions {
  std::uint64_t samples = 1'000'000;  // per chi-square test
  std::vector<double> angles_deg{0, 15, 30, 45, 60, 75, 85, 89};
  int random_angles = 8;
  int albedo_directions = 200;
  std::uint64_t albedo_trials = 10'000'000;
  std::uint64_t overshoot_trials = 100'000'000;
  int probed_wo = 200;  // for the mean trials
  // Viewers at any azimuth rather than at 0; an albedo is judged by what its table states, if that is more.
  bool anisotropic = false;
  double significance = 1e-4;  // of the family of all chi-square tests of the run
  int tests = 1;               // how many that are
};
// Chi-square and mean-weight tests of one material.
inline int tests_of_material(const StudyOptions& o) {
  return 5 * (int(o.angles_deg.size()) + o.random_angles);
}

struct Verdict {
  std::string check;
  bool passed = false;
  double p_value = 1;
  std::string line;  // as verify prints it
};

struct Measurement {
  std::string material, group, domain;
  double build_seconds = 0, build_processor_seconds = 0, kib = 0;
  std::uint64_t exact_slabs = 0, exact_leaves = 0, one_shot_slabs = 0, one_shot_leaves = 0;
  std::vector<Verdict> verdicts;
  double dead_exact = 0, dead_one_shot = 0, none = 0;  // shares of the samples; weight 0, no sample
  double worst_trials = 0;                             // largest sum(V) over the probed wo
  double mean_trials = 0;                              // of the probed wo
  double measured_trials = 0;                          // at the worst wo
  double albedo_stated = 0, albedo_missed = 0;         // relative errors; missed: the largest that was found
  double overshoot_estimate = 0, overshoot_upper = 0, attack_ratio = 0;
  std::uint64_t overshoots = 0;
  std::vector<double> variance;      // one-shot, at 0, 10, ..., 80 degrees; of anisotropic ones at 4 azimuths
  double variance_grazing = 0;       // at 89.9 degrees
  double seconds = 0;                // of the whole study of this material
  std::vector<double> part_seconds;  // build, chi-square, albedo, trials, overshoot, variance
  std::vector<std::string> notes;    // what the sampler itself says is not kept
};

Measurement measure(const StudyMaterial& material, const AnyBrdf& f, const StudyOptions& options,
                    const Host& host);

// Times the build of a material measured before: the median of three. Throws Error where the sampler is not
// the one that was measured.
void time_build(const AnyBrdf& f, const Host& host, Measurement& m);

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Verdict, check, passed, p_value, line)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Measurement, material, group, domain, build_seconds,
                                   build_processor_seconds, kib, exact_slabs, exact_leaves, one_shot_slabs,
                                   one_shot_leaves, verdicts, dead_exact, dead_one_shot, none, worst_trials,
                                   mean_trials, measured_trials, albedo_stated, albedo_missed,
                                   overshoot_estimate, overshoot_upper, attack_ratio, overshoots, variance,
                                   variance_grazing, seconds, part_seconds, notes)

}  // namespace reflectree::study
