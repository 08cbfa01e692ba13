// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "../../../tests/sampler/majorant_field.hpp"
#include "measurement.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/verify/attack.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/furnace.hpp"
#include "reflectree/verify/trials.hpp"

namespace reflectree::study {

namespace {

constexpr double degree = pi_v<double> / 180;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of all threads.
double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

Direction wo_at(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

// A seed of the material's own, so that no result depends on the order or the choice of materials.
std::uint64_t seed_of(const std::string& name) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (const char c : name) hash = (hash ^ std::uint8_t(c)) * 1099511628211ULL;
  return hash;
}

struct Study {
  const AnyBrdf& f;
  const StudyOptions& options;
  const Host& host;
  const Sampler<AnyBrdf>& sampler;
  std::uint64_t seed;
  Measurement& result;
  TargetFunction target = target_function(f);

  void note(const CheckResult& check, const std::string& where) {
    result.verdicts.push_back({check.name, check.passed, check.p_value, where + to_line(check)});
  }

  // Any azimuth where the function depends on it.
  double azimuth(Pcg32& u) const { return options.anisotropic ? 2 * pi_v<double> * to_unit_double(u()) : 0; }

  void goodness_of_fit() {
    Pcg32 u(seed, 1);
    std::vector<double> angles = options.angles_deg;
    for (int i = 0; i < options.random_angles; ++i) angles.push_back(89.9 * to_unit_double(u()));
    ChiSquareOptions chi;
    chi.samples = options.samples;
    chi.family_significance = options.significance;
    chi.tests = options.tests;
    std::uint64_t drawn = 0, dead_exact = 0, dead_one_shot = 0, none = 0;
    for (const double angle : angles) {
      const Direction wo = wo_at(angle * degree, 2 * pi_v<double> * to_unit_double(u()));
      char where[64];
      std::snprintf(where, sizeof where, "theta_o %.4f deg: ", angle);
      const Bins bins = equal_mass_bins(target, wo, {}, host);
      chi.seed = seed + 2 * std::uint64_t(&angle - angles.data());
      const Tally exact = tally_of(erase(sampler.exact, {}, "exact"), bins, chi, host);
      note(check_counts(exact, bins, chi), where);
      note(check_weights(exact, bins, chi), where);
      ++chi.seed;
      const ErasedSampler one_shot_sampler = erase(sampler.one_shot, {}, "one-shot");
      const Tally one_shot = tally_of(one_shot_sampler, bins, chi, host);
      note(check_counts(one_shot, density_masses(one_shot_sampler, bins, 1e-3, host), chi), where);
      note(check_weights(one_shot, bins, chi), where);
      note(check_mean_weight(one_shot, bins, chi), where);
      drawn += options.samples, dead_exact += exact.dead, dead_one_shot += one_shot.dead;
      none += exact.none + one_shot.none;
    }
    result.dead_exact = double(dead_exact) / double(drawn);
    result.dead_one_shot = double(dead_one_shot) / double(drawn);
    result.none = double(none) / double(2 * drawn);
  }

  void albedo() {
    FurnaceOptions furnace;
    furnace.directions = options.albedo_directions;
    furnace.seed = seed;
    if (options.anisotropic) {
      // An albedo that f tells is a sum over a table's entries; the cubature that judges it here is deceived by
      // steps and kinks more often than by the tolerance, unless f tells where they are.
      constexpr double seen_of_steps = 1e-3;
      const bool deceived = f.traits().albedo && target.patches.empty();
      furnace.tolerance = std::max(furnace.tolerance, deceived ? seen_of_steps : result.albedo_stated);
      furnace.grazing_tolerance = 10 * furnace.tolerance;
    }
    const CheckResult table = check_albedo_table(
        [&](Direction wo) { return double(sampler.exact.albedo(wo)); }, target, furnace, host);
    result.albedo_missed = table.statistic * furnace.tolerance;
    note(table, "");
    Pcg32 u(seed, 2);
    const Direction wo = wo_at(80 * degree * to_unit_double(u()), 1);
    const double unit = double(sampler.exact.expected_trials(wo)) * double(sampler.exact.albedo(wo));
    note(check_albedo_estimates(
             "accepted_trials",
             [&](Direction w, Pcg32& random) {
               FirstTrial first;
               sampler.exact.sample(w, random, first);
               return first.accepted ? unit : 0.;
             },
             target, wo, options.albedo_trials, seed, host),
         "");
    note(check_albedo_estimates(
             "sample_once",
             [&](Direction w, Pcg32& random) {
               const auto s = sampler.exact.sample_once(w, random);
               return s ? double(Target{}(s->weight)) : 0.;
             },
             target, wo, options.albedo_trials, seed + 1, host),
         "");
  }

  void trials() {
    Pcg32 u(seed, 3);
    Direction worst_wo{0, 0, 1};
    for (int i = 0; i < options.probed_wo; ++i) {
      // Half of them closer and closer to the horizon.
      const double x = to_unit_double(u());
      const double theta = i % 2 ? 90 * x : 90 - 90 * std::pow(1e-5, x);
      const Direction wo = wo_at(min(theta, 89.999) * degree, azimuth(u));
      const auto trials = double(sampler.exact.expected_trials(wo));
      result.mean_trials += trials / options.probed_wo;
      if (trials > result.worst_trials) result.worst_trials = trials, worst_wo = wo;
    }
    SampleStatistics statistics;
    for (int i = 0; i < 200'000; ++i) sampler.exact.sample(worst_wo, u, statistics);
    result.measured_trials = double(statistics.trials) / double(statistics.accepted);
  }

  void overshoot(const SamplerData& data) {
    AttackOptions attacks;
    attacks.coordinates = attack_coordinates(data);
    const MajorantField field(data, f);
    const AttackResult attacked =
        attack(options.anisotropic ? bound_ratio(f, data) : field.ratio_function(), attacks, host);
    result.attack_ratio = attacked.worst;
    const OvershootMass mass = overshoot_mass(
        [&](Pcg32& random) {
          const double theta = pi_v<double> / 2 * to_unit_double(random());
          Direction wo{float(std::sin(theta)), 0, max(float(std::cos(theta)), 2e-5f)};
          if (options.anisotropic) {
            const double phi = azimuth(random);
            wo = {wo.x * float(std::cos(phi)), wo.x * float(std::sin(phi)), wo.z};
          }
          FirstTrial first;
          sampler.exact.sample(wo, random, first);
          return first.ratio;
        },
        options.overshoot_trials, attacked.worst, seed, host);
    result.overshoot_estimate = mass.estimate, result.overshoot_upper = mass.upper;
    result.overshoots = mass.overshoots;
  }

  void variance() {
    const auto at = [&](double theta, double phi) {
      Pcg32 u(seed, 5);
      const Direction wo = wo_at(theta * degree, phi);
      double sum = 0, square = 0;
      const int n = 100'000;
      for (int i = 0; i < n; ++i) {
        const auto s = sampler.one_shot.sample(wo, u);
        const double w = s ? double(Target{}(s->weight)) : 0.;
        sum += w, square += w * w;
      }
      return sum > 0 ? n * square / (sum * sum) - 1 : 0.;
    };
    const int azimuths = options.anisotropic ? 4 : 1;
    Pcg32 turns(seed, 6);
    for (int k = 0; k < azimuths; ++k) {
      for (int theta = 0; theta <= 80; theta += 10) result.variance.push_back(at(theta, azimuth(turns)));
      result.variance_grazing = std::max(result.variance_grazing, at(89.9, azimuth(turns)));
    }
  }
};

}  // namespace

namespace {

// Counts of slabs and leaves, which identify a build among versions.
void describe(const SamplerData& data, Measurement& m) {
  m.domain = reflectree::name_of(data.domain.kind);
  m.exact_slabs = data.exact.size(), m.one_shot_slabs = data.one_shot.size();
  m.exact_leaves = m.one_shot_leaves = 0;
  for (const auto& tree : data.exact) m.exact_leaves += tree.mass.size();
  for (const auto& tree : data.one_shot) m.one_shot_leaves += tree.mass.size();
}

}  // namespace

void time_build(const AnyBrdf& f, const Host& host, Measurement& m) {
  std::vector<double> seconds;
  for (int i = 0; i < 3; ++i) {
    const auto start = Clock::now();
    const SamplerData data = build(f, {}, host);
    seconds.push_back(seconds_since(start));
    Measurement now;
    describe(data, now);
    if (now.exact_leaves != m.exact_leaves || now.one_shot_leaves != m.one_shot_leaves) {
      throw Error("another sampler than the one measured", m.material, "empty the folder of --resume");
    }
  }
  std::sort(seconds.begin(), seconds.end());
  m.build_seconds = seconds[1];
}

Measurement measure(const StudyMaterial& material, const AnyBrdf& f, const StudyOptions& options,
                    const Host& host) {
  Measurement m;
  m.material = material.name;
  m.group = name_of(material.group);
  const auto start = Clock::now();
  const double processor_before = processor_seconds();
  const SamplerData data = build(f, {}, host);
  m.build_seconds = seconds_since(start);
  m.build_processor_seconds = processor_seconds() - processor_before;
  m.albedo_stated = double(data.albedo.relative_error), m.notes = data.report.notes;
  describe(data, m);
  const Sampler<AnyBrdf> sampler = make_sampler(f, data);
  m.kib = double(bytes_of(sampler.exact.packed())) / 1024;
  Study study{f, options, host, sampler, seed_of(material.name), m};
  m.part_seconds.push_back(m.build_seconds);
  const auto timed = [&](auto&& part) {
    const auto begin = Clock::now();
    part();
    m.part_seconds.push_back(seconds_since(begin));
  };
  timed([&] { study.goodness_of_fit(); });
  timed([&] { study.albedo(); });
  timed([&] { study.trials(); });
  timed([&] { study.overshoot(data); });
  timed([&] { study.variance(); });
  m.seconds = seconds_since(start);
  return m;
}

}  // namespace reflectree::study
