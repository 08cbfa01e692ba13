// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/verify_suspect.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "elevations.hpp"
#include "parallel.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/verify/agreement.hpp"
#include "reflectree/verify/furnace.hpp"
#include "reflectree/verify/leaf_places.hpp"
#include "reflectree/verify/packing.hpp"
#include "reflectree/verify/reciprocity.hpp"
#include "reflectree/verify/reference_target.hpp"
#include "reflectree/verify/trials.hpp"
#include "reflectree/verify/way_tally.hpp"

namespace reflectree {
namespace {

template <class Report>
std::vector<std::string> notes_of(const Report& report) {
  if constexpr (requires { report.notes; }) {
    return {report.notes.begin(), report.notes.end()};
  } else {
    return {};
  }
}

std::string in_degrees(Direction wo) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "theta_o %.4g deg", double(theta_of(wo)) * 180 / pi_v<double>);
  return buffer;
}

class Hearing {
 public:
  Hearing(const Suspect& suspect, const VerifyOptions& options, const Host& host)
      : s_(suspect), o_(options), host_(host), f_(target_function(suspect.f, suspect.target)) {
    if (s_.family) member_ = to_text(s_.family->ranges(), s_.at);
    const int viewers = int(o_.theta_o_deg.size()) + std::max(o_.random_elevations, 0);
    chi_.family_significance = o_.family_significance;
    // Chi-square, weights, mean, channels, lanes: of each way at each viewer; and what comes once.
    chi_.tests = viewers * int(s_.ways.size()) * 5 + 80;
    chi_.samples = scaled_count(o_.samples, 20'000);
  }

  VerifyReport run() {
    if (s_.data) report_.notes = notes_of(s_.data->report);
    const std::vector<Direction> viewers = chosen_viewers();
    for (std::size_t i = 0; i < viewers.size(); ++i) {
      where_ = in_degrees(viewers[i]);
      if (i < o_.theta_o_deg.size()) {
        char buffer[64];
        std::snprintf(buffer, sizeof buffer, "theta_o %g deg", o_.theta_o_deg[i]);
        where_ = buffer;
      }
      at_viewer(viewers[i], i);
      host_.progress(float(i + 1) / float(viewers.size() + 4));
    }
    where_ = "every theta_o";
    together();
    directions();
    trials();
    albedo();
    if (s_.once) once();
    physics();
    return std::move(report_);
  }

 private:
  std::uint64_t scaled_count(std::uint64_t count, std::uint64_t least) const {
    return std::max(std::uint64_t(o_.effort * double(count)), std::min(count, least));
  }

  void add(CheckResult result) {
    result.where = s_.family ? member_ + ", " + where_ : where_;
    o_.on_check(result);
    report_.checks.push_back(std::move(result));
  }
  void inform(const char* name, double value) {
    report_.figures.push_back({name, s_.family ? member_ + ", " + where_ : where_, value});
    o_.on_figure(report_.figures.back());
  }

  std::vector<Direction> chosen_viewers() {
    Pcg32 u = detail::part_generator(o_.seed, 1);
    std::vector<Direction> viewers;
    constexpr double lowest = 1.01 * double(min_cos_theta_o);  // below, no sample is promised
    for (const double theta : o_.theta_o_deg) {
      viewers.push_back(detail::viewer(std::max(std::sin((90 - theta) * pi_v<double> / 180), lowest),
                                       2 * pi_v<double> * to_unit_double(u())));
    }
    for (const Direction wo : detail::stratified_viewers(std::size_t(std::max(o_.random_elevations, 0)), u)) {
      viewers.push_back(wo);
    }
    return viewers;
  }

  // How often exact mode may run out of trials in n draws.
  double expected_none(Direction wo, std::uint64_t n) const {
    Incidence in;
    if (!find_incidence(*s_.packed, wo, s_.at, in)) return 0;
    const double volume = double(slab_at(*s_.packed, s_.packed->exact, in).volume);
    return volume > 1 ? double(n) * std::pow(1 - 1 / (1.02 * volume), 256) : 0;
  }

  void at_viewer(Direction wo, std::size_t number) {
    const Bins bins = equal_mass_bins(f_, wo, {}, host_);
    const std::vector<ChannelReference> references =
        channel_references(s_.f, wo, detail::mixed_seed(o_.seed, 2, number), host_);
    // A density that the ways of one-shot mode share; that of exact mode is f's own.
    ErasedSampler one_shot;
    one_shot.name = "one-shot";
    one_shot.pdf = s_.one_shot_pdf;
    one_shot.concurrent = s_.concurrent();
    const std::vector<double> density = density_masses(one_shot, bins, 1e-3, host_);
    bool density_judged = false;
    for (std::size_t w = 0; w < s_.ways.size(); ++w) {
      const WayIn& way = s_.ways[w];
      const bool first = w == 0 || (!way.exact && !density_judged);
      const WayTally tally = tally_of(s_, way, bins, first ? chi_.samples : chi_.samples / 2,
                                      detail::mixed_seed(o_.seed, 3 + w, number), host_);
      const auto add_way = [&](CheckResult result) {
        result.way = way.name;
        if (result.name.find("chi_square") == 0) p_values_[{w, result.name}].push_back(result.p_value);
        add(std::move(result));
      };
      if (!(bins.total > 0)) {  // nothing to reflect, nothing to draw
        CheckResult none = check_counts(tally, bins, chi_);
        none.way = way.name;
        add(std::move(none));
        continue;
      }
      add_way(way.exact ? check_counts(tally, bins, chi_) : check_counts(tally, density, chi_));
      add_way(check_weights(tally, bins, chi_));
      add_way(check_mean_weight(tally, bins, chi_, way.exact ? stated_error() : 1e-4 + bins.worst_error / 3));
      if (tally.channel.size() > 1) {
        add_way(check_channel_weights(tally, references, chi_, way.exact ? stated_error() : 1e-4));
      }
      if (*std::max_element(tally.lane_count.begin(), tally.lane_count.end()) > 0) {
        add_way(check_lanes(tally, chi_));
      }
      add_way(check_alive(tally, way.exact, way.exact ? expected_none(wo, tally.samples) : 0));
      if (w == 0) inform("no_sample_share", double(tally.none) / double(tally.samples));
      if (!way.exact && !density_judged) {
        density_judged = true;
        add_way(integral_of_pdf(density));
        inform("one_shot_relative_variance", relative_variance(tally));
        if (tally.dead > 0) inform("weight_0_where_f_is_0", double(tally.dead) / double(tally.samples));
      }
    }
  }

  void together() {
    for (const auto& [key, p_values] : p_values_) {
      CheckResult result = check_together(key.second + "_together", p_values, chi_);
      result.way = s_.ways[key.first].name;
      add(std::move(result));
    }
  }

  static CheckResult integral_of_pdf(std::span<const double> density) {
    double integral = 0;
    for (const double m : density) integral += m;
    CheckResult r;
    r.name = "pdf_integral";
    r.statistic = std::abs(integral - 1);
    r.threshold = 2e-3;
    r.passed = r.statistic <= r.threshold;
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "integral of pdf %.6f", integral);
    r.detail = buffer;
    return r;
  }

  // Of exact mode's albedo, which is the mean of its weights; what floats can say at least.
  double stated_error() const {
    return std::max(s_.data ? double(s_.data->albedo.relative_error) : 1e-4, 1e-6) + 3e-5;
  }

  void directions() {
    Pcg32 u = detail::part_generator(o_.seed, 4);
    std::vector<Direction> viewers = detail::stratified_viewers(scaled_count(64, 24), u);
    for (const Direction wo : detail::border_viewers(*s_.packed, scaled_count(32, 12), u))
      viewers.push_back(wo);
    AgreementOptions options;
    options.seed = detail::mixed_seed(o_.seed, 5);
    for (CheckResult& r : check_agreement(s_, viewers, options, host_)) add(std::move(r));
    add(check_round_trip(s_, viewers, options, host_));
    for (CheckResult& r : check_leaf_places(s_, scaled_count(4'000'000, 400'000),
                                            detail::mixed_seed(o_.seed, 6), chi_, host_)) {
      add(std::move(r));
    }
    if (s_.data) {
      for (CheckResult& r : check_packing(*s_.data, *s_.packed)) add(std::move(r));
    }
  }

  // Trials are shared among the ways: most go to the first.
  void trials() {
    OvershootSums sums;
    for (std::size_t w = 0, exact = 0; w < s_.ways.size(); ++w) {
      const WayIn& way = s_.ways[w];
      if (!way.exact || !way.watch) continue;
      const std::uint64_t share = scaled_count(o_.trials, 100'000) * (exact++ == 0 ? 7 : 1) / 10;
      const TrialLog log = watch_trials(s_, way, share, detail::mixed_seed(o_.seed, 7, w), host_);
      add(check_acceptance(way.name, log, chi_));
      add(check_giving_up(way));
      sums.add(log.sums);
    }
    double attacked = 1;
    if (s_.data) {
      AttackOptions options;
      options.seed = detail::mixed_seed(o_.seed, 8);
      options.coordinates = attack_coordinates(*s_.data);
      if (o_.effort < 1) options.probes = std::size_t(scaled_count(options.probes, 1 << 14));
      attacked =
          attack(s_.family ? bound_ratio(*s_.family, *s_.data) : bound_ratio(s_.f, *s_.data), options, host_)
              .worst;
      inform("worst_ratio_under_attack", attacked);
    }
    if (sums.trials == 0) return;
    const double stated = s_.data ? double(s_.data->report.overshoot_mass) : 0;
    CheckResult r = check_overshoot(overshoot_mass(sums, attacked), std::max(1e-6, stated));
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "; the build states %.2g", stated);
    if (s_.data) r.detail += buffer;
    add(std::move(r));
  }

  void albedo() {
    FurnaceOptions furnace;
    furnace.seed = detail::mixed_seed(o_.seed, 9);
    furnace.tolerance = std::max(s_.data ? double(s_.data->albedo.relative_error) : 1e-4, 1e-6);
    furnace.grazing_tolerance = 10 * furnace.tolerance;
    const auto count = std::size_t(scaled_count(std::uint64_t(std::max(o_.albedo_directions, 1)), 24));
    Pcg32 u = detail::part_generator(o_.seed, 10);
    furnace.cosines = detail::table_places(*s_.packed, count, u);
    furnace.directions = int(count / 3);
    add(check_albedo_table(s_.albedo, f_, furnace, host_));
    inform("albedo_stated_error", furnace.tolerance);
  }

  void once() {
    const Direction wo = detail::viewer(std::cos(0.8), 2.5);
    const auto estimate = [&](Direction w, Pcg32& u) {
      std::array<float, std::size_t(max_channels)> weights;
      const std::span<float> used(weights.data(), s_.channels());
      s_.once(w, u, used);
      return reference_target(s_.target, used);
    };
    add(check_albedo_estimates("sample_once", estimate, f_, wo, scaled_count(o_.trials / 4, 100'000),
                               detail::mixed_seed(o_.seed, 11), host_));
  }

  void physics() {
    const PhysicsReport report =
        measure_physics(f_, int(std::min<std::uint64_t>(scaled_count(20'000, 2'000), 20'000)),
                        detail::mixed_seed(o_.seed, 12));
    if (s_.packed->viewer.frame.isotropic()) {
      add(check_isotropy(report, 1e-2));
    } else {
      inform("mean_anisotropy", report.isotropy.mean);
    }
    inform("mean_mirror_asymmetry", report.mirror.mean);
    inform("mean_miss_of_reciprocity", report.reciprocity.mean);
    inform("largest_albedo", report.max_albedo);
  }

  const Suspect& s_;
  const VerifyOptions& o_;
  const Host& host_;
  TargetFunction f_;
  ChiSquareOptions chi_;
  std::string where_;
  std::string member_;                                                           // of a family: which one
  std::map<std::pair<std::size_t, std::string>, std::vector<double>> p_values_;  // by way and check
  VerifyReport report_;
};

}  // namespace

VerifyReport verify(const Suspect& suspect, const VerifyOptions& options, const Host& host) {
  return Hearing(suspect, options, host).run();
}

}  // namespace reflectree
