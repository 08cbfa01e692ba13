// SPDX-License-Identifier: Apache-2.0
#include "passes.hpp"

#include <algorithm>
#include <cmath>

#include "grow.hpp"
#include "knots.hpp"
#include "tighten.hpp"

namespace reflectree::detail {

std::vector<Slab> first_slabs(const Survey& survey) {
  const Field& field = survey.field;
  const std::vector<float> thetas = theta_borders(field, survey.jumps);
  std::vector<Slab> slabs;
  KnownBox box = field.whole();
  for (std::size_t i = 0; i + 1 < thetas.size(); ++i) {
    box.lo[0] = thetas[i], box.hi[0] = thetas[i + 1];
    const std::vector<float> phis = azimuth_borders(field, survey.jumps, thetas[i], thetas[i + 1]);
    for (std::size_t k = 0; k + 1 < phis.size(); ++k) {
      box.lo[1] = phis[k], box.hi[1] = phis[k + 1];  // of isotropic functions no axis
      slabs.push_back(make_slab(box, survey.albedo, field));
    }
  }
  return slabs;
}

namespace {

std::size_t leaf_count(const std::vector<Slab>& slabs) {
  std::size_t count = 0;
  for (const Slab& slab : slabs) count += (slab.nodes.size() + 1) / 2;
  return count;
}

// Single functions for which wo has two angles, but for those whose bounds need no attack, and for tables of several
// rotations, which tell their albedo: they are noise, whose closest bounds miss five times as much.
bool is_bounded_closely(const Survey& survey) {
  const Field& field = survey.field;
  return !field.frame.isotropic() && !field.family && field.patches.empty() && !field.f.traits().albedo;
}

// Of the trials allowed, by which goals fall after each pass of an attack. Where slabs are many only dear ones
// grow again, and small steps leave each as near as can be to what was asked for.
float attack_takes(const Survey& survey) { return is_bounded_closely(survey) ? 0.02f : 0.06f; }

// Whether slabs may be spared and halved after an attack. Of isotropic functions all are grown and attacked again.
bool is_crowded(const Survey& survey) { return survey.field.family || is_bounded_closely(survey); }

GrowthRules exact_rules(const Survey& survey, const BuildOptions& options) {
  // Of the budget: the attack will use the rest.
  const float spare = is_bounded_closely(survey) ? 0.98f : 0.96f;
  GrowthRules rules{1 + (options.expected_trials - 1) * spare, 0.4f, 60000, true, true, analyse_exact};
  // Where wo has two angles slabs are many, and their attack costs as much as their growth.
  if (!survey.field.frame.isotropic()) rules.effort_share = 0.5f, rules.leaves_kept = 400;
  if (is_bounded_closely(survey)) rules.analyse = analyse_exact_closely, rules.of_all_mass = true;
  return rules;
}

bool is_dear(const Slab& slab, const BuildOptions& options) {
  return total_of(slab).cost > double(options.expected_trials);
}
bool any_is_dear(const std::vector<Slab>& slabs, const BuildOptions& options) {
  return std::any_of(slabs.begin(), slabs.end(), [&](const Slab& slab) { return is_dear(slab, options); });
}

// What grows after an attack is attacked, too.
void grow_dear(std::vector<Slab>& slabs, const Survey& survey, const BuildOptions& options,
               GrowthRules& rules) {
  const float lower = attack_takes(survey) * (options.expected_trials - 1);
  if (is_bounded_closely(survey)) {
    for (Slab& slab : slabs) slab.lowered += is_dear(slab, options) ? lower : 0.f;
  } else {
    rules.goal -= lower;
  }
  grow(slabs, survey, rules);
  for (Slab& slab : slabs) {
    if (slab.nodes.size() > slab.attacked) slab.overshoot = 1;
  }
}

// Where the effort ended an attack, slabs of two angles that miss much and are dear anyway get a margin: of a table of
// noise most of what is above a bound is so by a few hundredths.
void widen_unfinished(std::vector<Slab>& slabs, const Survey& survey, float missed) {
  constexpr float margin = 0.03f;
  constexpr double dear = 1.5;
  if (!survey.effort.spent() || survey.field.frame.isotropic() || survey.field.family) return;
  for (Slab& slab : slabs) {
    if (slab.overshoot <= missed || total_of(slab).cost < dear) continue;
    for (Node& node : slab.nodes) {
      if (node.split == TreeSplit::leaf) node.leaf.raise((1 + margin) * node.leaf.height);
    }
  }
}

// Attacks, and grows again what is too dear then.
void attack(std::vector<Slab>& slabs, const Survey& survey, const BuildOptions& options, GrowthRules rules,
            BuildReport& report) {
  constexpr float accepted_overshoot = 2e-7f;
  const int max_passes = is_bounded_closely(survey) ? 16 : 8;  // late ones look at a few slabs
  for (int pass = 0; pass < max_passes; ++pass) {
    // A lobe that was met by chance is better looked at from the start than grown around blindly, where ridges
    // can be followed.
    const bool follows = survey.towers && survey.field.whole().axes == 1;
    if (follows && !survey.towers->empty() && report.overshoot_mass > 0.02f) break;
    maximise(slabs, survey);
    // However many leaves there are, a pass has an end.
    const auto leaves = float(leaf_count(slabs));
    const float per_leaf = min(clamp(1.5e6f / leaves, 400.f, 20000.f), max(6e7f / leaves, 40.f));
    probe(slabs, per_leaf, options.seed + 1000003ULL * std::uint64_t(pass), accepted_overshoot, survey);
    report.overshoot_mass = 0;
    for (const Slab& slab : slabs) report.overshoot_mass = max(report.overshoot_mass, slab.overshoot);
    const bool dear = any_is_dear(slabs, options);
    if (survey.effort.spent() || (!dear && report.overshoot_mass <= accepted_overshoot)) break;
    if (dear && pass + 1 < max_passes) grow_dear(slabs, survey, options, rules);
  }
  widen_unfinished(slabs, survey, accepted_overshoot);
  report.expected_trials = 0;
  for (const Slab& slab : slabs)
    report.expected_trials = max(report.expected_trials, float(total_of(slab).cost));
}

// What is dear for its width alone is halved still.
GrowthRules rules_of_attack(const Survey& survey, const BuildOptions& options) {
  GrowthRules rules = exact_rules(survey, options);
  rules.split_slabs = is_crowded(survey);
  if (is_crowded(survey)) rules.enough = options.expected_trials;
  rules.progress = 0.6f, rules.progress_end = 0.85f;
  return rules;
}

}  // namespace

std::vector<Slab> build_exact(const Survey& survey, const BuildOptions& options, BuildReport& report) {
  std::vector<Slab> slabs = first_slabs(survey);
  GrowthRules rules = exact_rules(survey, options);
  rules.progress = 0.4f, rules.progress_end = 0.6f;
  survey.host.stage("growing exact trees");
  grow(slabs, survey, rules);
  survey.host.stage("attacking the bounds");
  attack(slabs, survey, options, rules_of_attack(survey, options), report);
  return slabs;
}

void mend_exact(std::vector<Slab>& slabs, const Survey& survey, const BuildOptions& options,
                BuildReport& report) {
  if (survey.effort.spent() || !any_is_dear(slabs, options)) return;
  GrowthRules rules = rules_of_attack(survey, options);
  grow_dear(slabs, survey, options, rules);
  attack(slabs, survey, options, rules, report);
}

namespace {

// Where wo has two angles most slabs stand near grazing, where viewers see little of a surface: there one-shot
// mode may have more variance than was asked for.
constexpr float more_at_grazing = 4;
// At a corner of a slab weights vary by up to six times as much as on average. Twice is promised to viewers, and
// few stand at a corner: with this the worst of 150 keep it.
constexpr float worst_to_asked = 2.3f;
bool is_loose(const Slab& slab) { return slab.box.axes > 1 && slab.box.slot[1] == 1 && is_grazing(slab); }

}  // namespace

std::vector<Slab> build_one_shot(const Survey& survey, const BuildOptions& options) {
  std::vector<Slab> slabs = first_slabs(survey);
  constexpr int max_passes = 4;
  // Leaves are dearer where wo has two angles. All of it where weights themselves are asked (probe_density).
  const float share = survey.field.frame.isotropic() ? 0.8f : is_bounded_closely(survey) ? 1 : 0.88f;
  GrowthRules rules{sqrt(1 + share * options.one_shot_variance), 0.45f, 60000, true, false, analyse_one_shot};
  if (!survey.field.frame.isotropic()) {
    rules.leaves_kept = 150, rules.of_all_mass = is_bounded_closely(survey);
    rules.grazing_goal = sqrt(1 + more_at_grazing * share * options.one_shot_variance);
    rules.worst_view = worst_to_asked * options.one_shot_variance;
  }
  rules.progress = 0.9f, rules.progress_end = 0.99f;
  survey.host.stage("growing one-shot trees");
  for (int pass = 0; pass < max_passes; ++pass) {
    grow(slabs, survey, rules);
    probe_density(slabs, options.seed + 2000003ULL * std::uint64_t(pass + 1), survey);
    const bool met = std::all_of(slabs.begin(), slabs.end(), [&](const Slab& slab) {
      const SlabTotal total = total_of(slab);
      return total.cost <= double(rules.goal_of(slab)) * total.ideal;
    });
    if (met || survey.effort.spent()) break;
  }
  return slabs;
}

namespace {

// Over the slabs where something is to be seen and that are to keep what was asked for.
template <class Value>
double median(const std::vector<Slab>& slabs, const Value& value) {
  std::vector<double> all;
  for (const Slab& slab : slabs) {
    const SlabTotal sum = total_of(slab);
    if (!is_loose(slab) && sum.ideal > 0) all.push_back(value(sum));
  }
  if (all.empty()) return 0;
  std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
  return all[all.size() / 2];
}

}  // namespace

float median_variance(const std::vector<Slab>& slabs) {
  return float(median(slabs, [](const SlabTotal& sum) { return sum.variance(); }));
}

double median_trials(const std::vector<Slab>& slabs) {
  return median(slabs, [](const SlabTotal& sum) { return sum.cost; });
}

double worst_variance(const std::vector<Slab>& slabs) {
  double worst = 0;
  for (const Slab& slab : slabs) worst = std::max(worst, total_of(slab).variance());
  return worst;
}

}  // namespace reflectree::detail
