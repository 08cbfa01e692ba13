// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/build.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "albedo_build.hpp"
#include "albedo_integrals.hpp"
#include "check_options.hpp"
#include "examine.hpp"
#include "field.hpp"
#include "findings.hpp"
#include "grow.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/identity.hpp"
#include "theta_jumps.hpp"
#include "tighten.hpp"

namespace reflectree {

namespace {

using namespace detail;

constexpr float theta_max = 1.5707887f;  // cos = min_cos_theta_o, rounded outwards

std::vector<Slab> first_slabs(const std::vector<float>& jumps, const AlbedoTable& albedo,
                              const Field& field) {
  std::vector<float> borders{0, theta_max}, knots = field.f.traits().theta_o_knots;
  knots.insert(knots.end(), jumps.begin(), jumps.end());
  for (const float theta : knots) {
    if (theta > 1e-4f && theta < theta_max - 1e-4f) borders.push_back(theta);
  }
  std::sort(borders.begin(), borders.end());
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
  std::vector<Slab> slabs;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i)
    slabs.push_back(make_slab(borders[i], borders[i + 1], albedo, field));
  return slabs;
}

// The borders between slabs as a balanced tree.
void add_borders(const std::vector<Slab>& slabs, std::size_t begin, std::size_t end, Partition& partition) {
  if (end - begin == 1) {
    partition.axis.push_back(Partition::leaf);
    return;
  }
  const std::size_t mid = (begin + end) / 2;
  partition.axis.push_back(0);
  partition.split.push_back(slabs[mid].theta_lo);
  add_borders(slabs, begin, mid, partition);
  add_borders(slabs, mid, end, partition);
}

Partition partition_of(const std::vector<Slab>& slabs) {
  Partition partition;
  partition.coordinates = {{"theta_o", 0, theta_max}};
  add_borders(slabs, 0, slabs.size(), partition);
  return partition;
}

std::vector<TreeSplit> preorder(const Slab& slab) {
  std::vector<TreeSplit> order;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const Node& node = slab.nodes[stack.back()];
    stack.pop_back();
    order.push_back(node.split);
    if (node.split != TreeSplit::leaf) stack.push_back(node.child + 1), stack.push_back(node.child);
  }
  return order;
}

// Integer masses, rounded up, that sum to less than 2^32; returns the unit.
double quantise(const std::vector<double>& cost, std::vector<std::uint32_t>& mass) {
  double total = 0;
  for (const double c : cost) total += c;
  const double unit = max(total, 1e-30) / (4294967295. - 2. * double(cost.size()) - 2);
  for (const double c : cost) mass.push_back(std::uint32_t(max(std::ceil(c / unit), 1.)));
  return unit;
}

// Nodes, slopes and quantised masses; returns the unit of mass. No leaf loses support, whatever its grid saw.
double fill(CanonicalTree& tree, const Slab& slab) {
  tree.nodes = preorder(slab);
  std::vector<double> cost;
  for (const std::uint32_t i : leaves_in_order(slab)) {
    const Leaf& leaf = slab.nodes[i].leaf;
    cost.push_back(double(area_share(leaf.cell)) * double(max(leaf.height, floor_share)));
    tree.slope_x.push_back(std::int8_t(std::lround(leaf.slope_x * 128)));
    tree.slope_y.push_back(std::int8_t(std::lround(leaf.slope_y * 128)));
  }
  return quantise(cost, tree.mass);
}

MajorantTree majorant_tree(const Slab& slab) {
  MajorantTree tree;
  const double unit = fill(tree, slab);
  double sum = 0;
  for (const std::uint32_t m : tree.mass) sum += m;
  tree.volume = std::nextafter(float(unit * sum), 1e30f);
  return tree;
}

DensityTree density_tree(const Slab& slab) {
  DensityTree tree;
  fill(tree, slab);
  return tree;
}

std::size_t leaf_count(const std::vector<Slab>& slabs) {
  std::size_t count = 0;
  for (const Slab& slab : slabs) count += (slab.nodes.size() + 1) / 2;
  return count;
}

// Cost and ideal of a slab's leaves together; in exact mode the cost is the volume under the bounds.
struct Total {
  double cost = 0, ideal = 0;
};
Total total_of(const Slab& slab) {
  Total total;
  for (const Node& node : slab.nodes) {
    if (node.split == TreeSplit::leaf)
      total.cost += double(node.leaf.cost), total.ideal += double(node.leaf.ideal);
  }
  return total;
}

// Grows, attacks the bounds, and grows again while the raised bounds cost more trials than allowed.
std::vector<Slab> build_exact(std::vector<Slab> slabs, const Survey& survey, const BuildOptions& options,
                              BuildReport& report) {
  constexpr float accepted_overshoot = 2e-7f;
  constexpr int max_passes = 8;
  const float spare = 0.96f;  // of the budget: the attack will use the rest
  GrowthRules rules{1 + (options.expected_trials - 1) * spare, 0.4f, 60000, true, true, analyse_exact};
  rules.progress = 0.4f, rules.progress_end = 0.6f;
  survey.host.stage("growing exact trees");
  grow(slabs, survey, rules);
  rules.split_slabs = false;
  rules.progress = 0.6f, rules.progress_end = 0.85f;
  survey.host.stage("attacking the bounds");
  std::vector<std::size_t> first_new(slabs.size(), 0);
  std::vector<float> overshoot(slabs.size(), 1);  // as last estimated; slabs that are good are left alone
  for (int pass = 0; pass < max_passes; ++pass) {
    // A lobe that was met by chance is better looked at from the start than grown around blindly.
    if (survey.towers && !survey.towers->empty() && report.overshoot_mass > 0.02f) break;
    maximise(slabs, first_new, survey);
    // However many leaves there are, a pass has an end.
    const auto leaves = float(leaf_count(slabs));
    const float per_leaf = min(clamp(1.5e6f / leaves, 400.f, 20000.f), max(6e7f / leaves, 40.f));
    probe(slabs, per_leaf, options.seed + 1000003ULL * std::uint64_t(pass), accepted_overshoot, survey,
          overshoot);
    report.overshoot_mass = *std::max_element(overshoot.begin(), overshoot.end());
    bool dear = false;
    for (std::size_t s = 0; s < slabs.size(); ++s) {
      first_new[s] = slabs[s].nodes.size();
      dear = dear || total_of(slabs[s]).cost > double(options.expected_trials);
    }
    if (survey.effort.spent() || (!dear && report.overshoot_mass <= accepted_overshoot)) break;
    if (dear && pass + 1 < max_passes) {  // what grows last is attacked, too
      rules.goal -= 0.06f * (options.expected_trials - 1);
      grow(slabs, survey, rules);
      for (std::size_t s = 0; s < slabs.size(); ++s) {
        if (slabs[s].nodes.size() > first_new[s]) overshoot[s] = 1;
      }
    }
  }
  report.expected_trials = 0;
  for (const Slab& slab : slabs)
    report.expected_trials = max(report.expected_trials, float(total_of(slab).cost));
  return slabs;
}

// Grows, looks between the points of the grids, and grows again where a slab shows more variance than
// allowed.
std::vector<Slab> build_one_shot(std::vector<Slab> slabs, const Survey& survey, const BuildOptions& options) {
  constexpr int max_passes = 4;
  GrowthRules rules{sqrt(1 + 0.8f * options.one_shot_variance), 0.45f, 60000, true, false, analyse_one_shot};
  rules.progress = 0.9f, rules.progress_end = 0.99f;
  survey.host.stage("growing one-shot trees");
  for (int pass = 0; pass < max_passes; ++pass) {
    grow(slabs, survey, rules);
    probe_density(slabs, options.seed + 2000003ULL * std::uint64_t(pass + 1), survey);
    const bool met = std::all_of(slabs.begin(), slabs.end(), [&](const Slab& slab) {
      const Total total = total_of(slab);
      return total.cost <= double(rules.goal) * total.ideal;
    });
    if (met || survey.effort.spent()) break;
  }
  return slabs;
}

double variance_of(const Slab& slab) {
  const Total total = total_of(slab);
  return total.ideal > 0 ? sqr(total.cost / total.ideal) - 1 : 0;
}

float median_variance(const std::vector<Slab>& slabs) {
  std::vector<double> variance;
  for (const Slab& slab : slabs) {
    if (total_of(slab).ideal > 0) variance.push_back(variance_of(slab));
  }
  if (variance.empty()) return 0;
  std::nth_element(variance.begin(), variance.begin() + std::ptrdiff_t(variance.size() / 2), variance.end());
  return float(variance[variance.size() / 2]);
}

double worst_variance(const std::vector<Slab>& slabs) {
  double worst = 0;
  for (const Slab& slab : slabs) worst = std::max(worst, variance_of(slab));
  return worst;
}

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
    if (highest && highest->seen > 0) places.push_back({cos(highest->seen_theta), highest->seen_at});
  }
  return places;
}

// The attempt at a sampler that knows of some ridges.
struct Attempt {
  Domain domain;
  std::vector<float> jumps;
  AlbedoTable albedo;
  std::vector<Slab> exact, one_shot;
  CrossExamination seen;
};

Attempt attempt_exact(const Field& field, const Examination& seen, const BuildOptions& options,
                      Effort& effort, const Host& host, BuildReport& report) {
  Attempt attempt;
  std::vector<FieldPoint> towers;
  attempt.domain = field.domain;
  host.progress(0.1f);
  host.stage("integrating the albedo");
  Effort uncounted{0, options.max_evaluations};
  attempt.jumps = find_theta_jumps(field, host, uncounted);
  attempt.albedo = build_albedo(field, options.albedo_error, attempt.jumps, options.seed, host, effort);
  const Survey survey{field, attempt.albedo, host, effort, &attempt.jumps, &towers};
  attempt.exact = build_exact(first_slabs(attempt.jumps, attempt.albedo, field), survey, options, report);
  host.progress(0.87f);
  host.stage("cross-examining");
  const Survey apart{field, attempt.albedo, host, uncounted, &attempt.jumps};
  const Direction wi = fold(field.domain.symmetry, seen.brightest_wi);
  const FieldPoint brightest{seen.brightest_wo.z,
                             lower(field.domain, wo_from_cosine(seen.brightest_wo.z), wi)};
  attempt.seen = cross_examine(attempt.exact, apart, brightest, options.seed);
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
  const Integrals own = integrate(fit, cosines, {1e-3, 8, 4, true, 0.86f, 0.86f}, host, uncounted);
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    const double a = double(albedo_at(albedo, cosines[i])), b = own.values[i];
    if (std::abs(a - b) <= (allowed + double(albedo.relative_error) + own.error) * std::max(a, b)) continue;
    char what[128];
    std::snprintf(what, sizeof what, "the domain that was asked for sees an albedo of %.4g, %s sees %.4g", a,
                  name_of(fit.domain.kind), b);
    throw Error(what, fit.f.traits().name, "leave the domain to the builder");
  }
}

}  // namespace

SamplerData build(const AnyBrdf& f, const BuildOptions& the_options, const Host& the_host) {
  check_options(the_options, f.channels());
  const Host host = completed(the_host);
  BuildOptions options = the_options;
  SamplerData data;
  data.material = f.traits().name;
  host.stage("examining the function");
  Examination seen = examine(f, options);
  options.target = data.target = seen.target;
  data.report.asymmetry = seen.asymmetry;

  // What the cross-examination turns up is followed, and all is built again with it.
  constexpr int max_attempts = 3;
  std::uint64_t evaluations = 0;
  std::vector<Ridge> ridges;
  for (int n = 1;; ++n) {
    // A quarter is left for one-shot trees.
    Effort effort{0, options.max_evaluations / 4 * 3};
    host.stage("choosing the domain");
    const Domain domain = options.domain ? *options.domain : choose_domain(f, options, seen, ridges, host);
    const Field field{f, options.target, domain, domain.half() && !seen.mirror_symmetric, ridges};
    Attempt attempt = attempt_exact(field, seen, options, effort, host, data.report);
    if (n < max_attempts && evaluations < options.max_evaluations && !effort.spent() &&
        disagrees(attempt.seen, attempt.albedo)) {
      evaluations += effort.evaluations;
      if (add_ridges(ridges, field, attempt.seen)) {
        seen = examine(f, options, ridges);
        continue;
      }
    }
    refuse_albedo_out_of_range(attempt.albedo, data.target, f.traits().name);
    if (options.domain) {
      const Domain own = choose_domain(f, options, seen, ridges, host);
      const Field fit{f, options.target, own, own.half() && !seen.mirror_symmetric, ridges};
      refuse_unfit_domain(attempt.albedo, fit, host);
    }
    refuse_disagreement(attempt.seen, attempt.albedo, field, effort.spent());
    const bool spent = effort.spent();
    effort.limit = options.max_evaluations;
    const Survey survey{field, attempt.albedo, host, effort, &attempt.jumps};
    attempt.one_shot = build_one_shot(first_slabs(attempt.jumps, attempt.albedo, field), survey, options);
    // Bounds are a density, too: where the effort did not reach for a better one, they serve.
    if (effort.spent() && worst_variance(attempt.one_shot) > options.expected_trials - 1)
      attempt.one_shot = attempt.exact;
    data.domain = domain;
    data.albedo = attempt.albedo;
    data.exact_partition = partition_of(attempt.exact);
    for (const Slab& slab : attempt.exact) data.exact.push_back(majorant_tree(slab));
    data.one_shot_partition = partition_of(attempt.one_shot);
    for (const Slab& slab : attempt.one_shot) data.one_shot.push_back(density_tree(slab));
    data.report.one_shot_variance = median_variance(attempt.one_shot);
    data.report.evaluations = evaluations + effort.evaluations;
    data.report.notes =
        notes_on(attempt.exact, attempt.one_shot, attempt.albedo, options, spent || effort.spent());
    break;
  }
  data.probes = probe_identity(f, options.target);
  host.progress(1);
  return data;
}

}  // namespace reflectree
