// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/build.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "build/albedo/albedo_build.hpp"
#include "build/albedo/integrals.hpp"
#include "canonical.hpp"
#include "check_options.hpp"
#include "findings.hpp"
#include "judge_density.hpp"
#include "jumps.hpp"
#include "passes.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/identity.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "subject.hpp"
#include "tighten.hpp"

namespace reflectree {

namespace {

using namespace detail;

// The places of the highest values in the slabs that cost most, where a lobe stood that nobody told of.
std::vector<FieldPoint> highest_places(const std::vector<Slab>& slabs) {
  constexpr std::size_t most = 4;
  std::vector<const Slab*> order;
  for (const Slab& slab : slabs) order.push_back(&slab);
  std::stable_sort(order.begin(), order.end(),
                   [](const Slab* a, const Slab* b) { return total_of(*a).cost > total_of(*b).cost; });
  std::vector<FieldPoint> places;
  for (std::size_t k = 0; k < order.size() && k < most; ++k) {
    const Leaf* highest = nullptr;
    for (const Node& node : order[k]->nodes) {
      if (node.split == TreeSplit::leaf && (!highest || node.leaf.seen > highest->seen)) highest = &node.leaf;
    }
    if (highest && highest->seen > 0)
      places.push_back(field_point(viewer_at(highest->seen_by), highest->seen_at));
  }
  return places;
}

// The attempt at a sampler that knows of some ridges.
struct Attempt {
  Domain domain;
  Jumps jumps;
  AlbedoTable albedo;
  std::vector<Slab> exact, one_shot;
  CrossExamination seen;
};

// Patient: lobes that the attack meets are grown around, rather than left to be followed first.
Attempt attempt_exact(const Field& field, const Examination& seen, const BuildOptions& options, bool patient,
                      Effort& effort, const Host& host, BuildReport& report) {
  Attempt attempt;
  std::vector<FieldPoint> towers;
  attempt.domain = field.domain;
  host.progress(0.1f);
  host.stage("integrating the albedo");
  Effort uncounted{0, options.max_evaluations};
  attempt.jumps = find_jumps(field, host, uncounted);
  attempt.albedo = build_albedo(field, options.albedo_error, attempt.jumps, options.seed, host, effort);
  CosineLookup guide = guide_to(attempt.albedo);
  const CosineLookup* const guided = field.frame.isotropic() && !field.family ? &guide : nullptr;
  const Survey survey{field, attempt.albedo, host, effort, &attempt.jumps, patient ? nullptr : &towers,
                      guided};
  const Survey apart{field, attempt.albedo, host, uncounted, &attempt.jumps, nullptr, guided};
  const Viewer brightest_viewer{seen.brightest_wo, seen.brightest_at};
  const FieldPoint brightest =
      field_point(brightest_viewer, field.place_of(brightest_viewer, seen.brightest_wi));
  std::vector<WrongAlbedo> stepped_over;
  std::uint64_t before = 0;
  for (int look = 1;; ++look) {
    attempt.exact = build_exact(survey, options, report);
    host.stage("judging the albedo by the trees");
    if (field.f.traits().albedo && !field.family) break;
    const TreeMarks marks = tree_marks(attempt.exact, apart);
    stepped_over = judge_by_trees(attempt.exact, marks, apart, options.seed);
    if (stepped_over.empty() || look == 2 || effort.spent()) break;
    // Lobes that can be followed are, before their albedo is integrated with the trees' help.
    if (!patient && disagrees(cross_examine(attempt.exact, apart, brightest, options.seed), attempt.albedo))
      break;
    Field informed = field;
    informed.marks = &marks;
    before = effort.evaluations,
    effort.evaluations = 0;  // what was wrong takes nothing from what replaces it
    host.stage("integrating the albedo again");
    attempt.albedo = build_albedo(informed, options.albedo_error, attempt.jumps, options.seed, host, effort);
    guide = guide_to(attempt.albedo);
  }
  effort.evaluations += before;
  host.progress(0.87f);
  host.stage("cross-examining");
  // Slivers of steps, where no local search leads: what was met is mended, and all is asked again.
  constexpr std::uint64_t rounds = 24;
  for (std::uint64_t round = 0;; ++round) {
    attempt.seen = cross_examine(attempt.exact, apart, brightest, options.seed + 7919 * round);
    std::vector<FieldPoint> met;
    bool told = true;
    for (const Surprise& s : attempt.seen.surprises)
      met.push_back(field_point(s.viewer, s.p)), told = told && std::isfinite(s.ratio);
    if (field.frame.isotropic() || met.empty() || !told || round + 1 == rounds) break;
    raise_at(attempt.exact, met, apart);
    mend_exact(attempt.exact, survey, options, report);
  }
  attempt.seen.wrong.insert(attempt.seen.wrong.end(), stepped_over.begin(), stepped_over.end());
  std::stable_sort(attempt.seen.wrong.begin(), attempt.seen.wrong.end(),
                   [](const WrongAlbedo& a, const WrongAlbedo& b) { return a.miss > b.miss; });
  attempt.seen.towers = std::move(towers);
  if (attempt.seen.towers.empty() && disagrees(attempt.seen, attempt.albedo))
    attempt.seen.towers = highest_places(attempt.exact);
  return attempt;
}

// Throws Error where the albedo is beyond the range of float in the units of f.
void refuse_albedo_out_of_range(const AlbedoTable& albedo, const Target& target, const std::string& name) {
  double largest = 0;
  for (const float a : albedo.albedo) largest = std::max(largest, double(a) / double(target.scale));
  if (largest <= 1e38) return;
  char what[96];
  std::snprintf(what, sizeof what, "the albedo is %.3g, and weights of that size leave the range of float",
                largest);
  throw Error(what, name, "divide the function by a constant and multiply the weights by it");
}

// A domain that was asked for may turn the rim of an unbounded function into an atom of rounding, which its
// own cubature takes for mass: the albedo must be that of the domain that the builder would have taken.
void refuse_unfit_domain(const AlbedoTable& albedo, const Field& fit, const Host& host) {
  constexpr double allowed = 0.02;
  const std::vector<float> cosines{0.95f, 0.6f, 0.2f};
  Effort uncounted;
  Coordinates middle{};
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    middle[i] = linear_mix(0.5f, lowest(fit.parameters[i]), highest(fit.parameters[i]));
  std::vector<Viewer> viewers;
  for (const float c : cosines) viewers.push_back({wo_from_cosine(c), middle});
  const Integrals own = integrate(fit, viewers, {1e-3, 8, 4, true, 0.86f, 0.86f}, host, uncounted);
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    const double a = double(albedo_of(fit, albedo, viewers[i])), b = own.values[i];
    if (std::abs(a - b) <= (allowed + double(albedo.relative_error) + own.error) * std::max(a, b)) continue;
    char what[128];
    std::snprintf(what, sizeof what, "the domain that was asked for sees an albedo of %.4g, %s sees %.4g", a,
                  name_of(fit.domain.kind), b);
    throw Error(what, fit.f.traits().name, "leave the domain to the builder");
  }
}

// Throws Error for a domain that is not of the kind of functions that f is.
void check_domain(const Domain& domain, const ViewerFrame& frame, const std::string& name) {
  const std::string kind = name_of(domain.kind);
  if (frame.isotropic() && domain.kind == DomainKind::slope_star) {
    throw Error("the domain " + kind + " is one of anisotropic functions, and the function is isotropic",
                name, "ask for half_vector, or leave the domain to the builder");
  }
}

SamplerData build_of(const Subject& subject, const BuildOptions& the_options, const Host& the_host) {
  const AnyBrdf& f = subject.f;
  const BrdfTraits& traits = subject.family ? subject.family->traits() : f.traits();
  check_options(the_options, f.channels());
  const Host host = completed(the_host);
  BuildOptions options = the_options;
  SamplerData data;
  data.material = traits.name;
  host.stage("examining the function");
  Examination seen = examine(subject, options);
  options.target = data.target = seen.target;
  data.report.asymmetry = seen.asymmetry;

  // What the cross-examination turns up is followed, and all is built again with it.
  constexpr int max_attempts = 3;
  std::uint64_t evaluations = 0;
  std::vector<Ridge> ridges;
  bool patient = false;
  for (int n = 1;; ++n) {
    // A quarter is left for one-shot trees, a fifth where wo has two angles.
    const std::uint64_t parts = seen.frame.isotropic() ? 4 : 5;
    Effort effort{0, options.max_evaluations / parts * (parts - 1)};
    host.stage("choosing the domain");
    if (options.domain) check_domain(*options.domain, seen.frame, traits.name);
    DomainChoice choice =
        options.domain ? DomainChoice{*options.domain} : choose_domain(subject, options, seen, ridges, host);
    if (!seen.frame.isotropic()) choice.domain.symmetry = Symmetry::none;
    const Field field = field_of(subject, seen, choice, ridges);
    check_patches(field, options.seed);
    Attempt attempt = attempt_exact(field, seen, options, patient, effort, host, data.report);
    // Whether half of the budget is left for another attempt, one-shot trees of this one included.
    const auto half_is_left = [&] { return evaluations + effort.evaluations < options.max_evaluations / 2; };
    if (evaluations < options.max_evaluations && !effort.spent() && disagrees(attempt.seen, attempt.albedo)) {
      const bool follow = n < max_attempts && add_ridges(ridges, field, attempt.seen);
      if (follow || (!patient && half_is_left())) {
        evaluations += effort.evaluations;
        if (follow) seen = examine(subject, options, ridges);
        patient = patient || !follow;
        continue;
      }
    }
    refuse_albedo_out_of_range(attempt.albedo, data.target, traits.name);
    if (options.domain) {
      const DomainChoice own = choose_domain(subject, options, seen, ridges, host);
      refuse_unfit_domain(attempt.albedo, field_of(subject, seen, own, ridges), host);
    }
    refuse_disagreement(attempt.seen, attempt.albedo, field, effort.spent());
    refuse_hopeless(attempt.exact, field, effort.spent());
    state_misses(attempt.seen, attempt.albedo);
    const bool spent = effort.spent();
    effort.limit = options.max_evaluations;
    // The attack on many slabs may take more than its share.
    const bool crowded = !seen.frame.isotropic();
    if (crowded) effort.limit = std::max(effort.limit, effort.evaluations + options.max_evaluations / 8);
    const Survey survey{field, attempt.albedo, host, effort, &attempt.jumps};
    attempt.one_shot = build_one_shot(survey, options);
    // Bounds are a density, too, whose weights vary by less than the trials beyond the first: where the effort
    // did not reach for a better one, they serve.
    const bool poor = crowded ? double(median_variance(attempt.one_shot)) > median_trials(attempt.exact) - 1
                              : worst_variance(attempt.one_shot) > options.expected_trials - 1;
    if (effort.spent() && poor) attempt.one_shot = attempt.exact;
    // A lobe that its trees stepped over costs variance, not truth: it is followed, or told of.
    Effort uncounted;
    const Survey apart{field, attempt.albedo, host, uncounted, &attempt.jumps};
    const DensityJudgement density = judge_density(attempt.one_shot, attempt.exact, options.seed, apart);
    if (much_more(density.variance, options) && n < max_attempts && half_is_left()) {
      CrossExamination met;
      met.towers = density.towers;
      if (add_ridges(ridges, field, met)) {
        evaluations += effort.evaluations;
        seen = examine(subject, options, ridges);
        continue;
      }
    }
    data.frame = seen.frame, data.domain = choice.domain;
    data.parameters = subject.parameters, data.law = choice.law;
    data.albedo = attempt.albedo;
    data.exact_partition = partition_of(attempt.exact, subject.parameters);
    for (const Slab& slab : attempt.exact) data.exact.push_back(majorant_tree(slab));
    data.one_shot_partition = partition_of(attempt.one_shot, subject.parameters);
    for (const Slab& slab : attempt.one_shot) data.one_shot.push_back(density_tree(slab));
    data.report.one_shot_variance = median_variance(attempt.one_shot);
    data.report.evaluations = evaluations + effort.evaluations;
    data.report.notes = notes_on(attempt.exact, attempt.one_shot, attempt.albedo, density, subject.parameters,
                                 options, double(data.report.overshoot_mass), spent || effort.spent());
    break;
  }
  data.probes =
      subject.family ? probe_identity(*subject.family, options.target) : probe_identity(f, options.target);
  host.progress(1);
  return data;
}

}  // namespace

SamplerData build(const AnyBrdf& f, const BuildOptions& options, const Host& host) {
  return build_of({f}, options, host);
}

SamplerData build(const AnyFamily& family, const BuildOptions& options, const Host& host) {
  return build_of(subject_of(family), options, host);
}

}  // namespace reflectree
