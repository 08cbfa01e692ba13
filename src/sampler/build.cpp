// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/build.hpp"

#include <algorithm>
#include <cmath>

#include "albedo_build.hpp"
#include "examine.hpp"
#include "field.hpp"
#include "grow.hpp"
#include "reflectree/sampler/albedo.hpp"
#include "reflectree/sampler/identity.hpp"
#include "tighten.hpp"

namespace reflectree {

namespace {

using namespace detail;

constexpr float theta_max = 1.5707887f;  // cos = min_cos_theta_o, rounded outwards

std::vector<Slab> first_slabs(const std::vector<float>& knots, const AlbedoTable& albedo,
                              const Domain& domain) {
  std::vector<float> borders{0, theta_max};
  for (const float theta : knots) {
    if (theta > 1e-4f && theta < theta_max - 1e-4f) borders.push_back(theta);
  }
  std::sort(borders.begin(), borders.end());
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
  std::vector<Slab> slabs;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i)
    slabs.push_back(make_slab(borders[i], borders[i + 1], albedo, domain));
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

std::vector<Split> preorder(const Slab& slab) {
  std::vector<Split> order;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const Node& node = slab.nodes[stack.back()];
    stack.pop_back();
    order.push_back(node.split);
    if (node.split != Split::leaf) stack.push_back(node.child + 1), stack.push_back(node.child);
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
double fill(Tree& tree, const Slab& slab) {
  tree.nodes = preorder(slab);
  std::vector<double> cost;
  for (const std::uint32_t i : leaves_in_order(slab)) {
    const Leaf& leaf = slab.nodes[i].leaf;
    cost.push_back(double(area_share(leaf.cell)) * double(max(leaf.share, floor_share)));
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
    if (node.split == Split::leaf)
      total.cost += double(node.leaf.cost), total.ideal += double(node.leaf.ideal);
  }
  return total;
}

// Grows, attacks the bounds, and grows again while the raised bounds cost more trials than allowed.
std::vector<Slab> build_exact(std::vector<Slab> slabs, const Field& field, const AlbedoTable& albedo,
                              const BuildOptions& options, const Host& host, BuildReport& report) {
  constexpr float accepted_overshoot = 2e-7f;
  constexpr int max_passes = 8;
  const float spare = 0.96f;  // of the budget: the attack will use the rest
  GrowthRules rules{1 + (options.expected_trials - 1) * spare, 0.4f, 60000, true, true, analyse_exact};
  rules.progress = 0.4f;
  grow(slabs, field, albedo, rules, host, &report.evaluations);
  rules.split_slabs = false;
  std::vector<std::size_t> first_new(slabs.size(), 0);
  std::vector<float> overshoot(slabs.size(), 1);  // as last estimated; slabs that are good are left alone
  for (int pass = 0; pass < max_passes; ++pass) {
    maximise(slabs, first_new, field, albedo, host, &report.evaluations);
    const float per_leaf = clamp(1.5e6f / float(leaf_count(slabs)), 400.f, 20000.f);
    probe(slabs, per_leaf, options.seed + 1000003ULL * std::uint64_t(pass), accepted_overshoot, field, albedo,
          host, &report.evaluations, overshoot);
    report.overshoot_mass = *std::max_element(overshoot.begin(), overshoot.end());
    bool dear = false;
    for (std::size_t s = 0; s < slabs.size(); ++s) {
      first_new[s] = slabs[s].nodes.size();
      dear = dear || total_of(slabs[s]).cost > double(options.expected_trials);
    }
    if (!dear && report.overshoot_mass <= accepted_overshoot) break;
    if (dear && pass + 1 < max_passes) {  // what grows last is attacked, too
      rules.goal -= 0.06f * (options.expected_trials - 1);
      grow(slabs, field, albedo, rules, host, &report.evaluations);
      for (std::size_t s = 0; s < slabs.size(); ++s) {
        if (slabs[s].nodes.size() > first_new[s]) overshoot[s] = 1;
      }
    }
  }
  for (const Slab& slab : slabs)
    report.expected_trials = max(report.expected_trials, float(total_of(slab).cost));
  return slabs;
}

// Grows, looks between the points of the grids, and grows again where a slab shows more variance than
// allowed.
std::vector<Slab> build_one_shot(std::vector<Slab> slabs, const Field& field, const AlbedoTable& albedo,
                                 const BuildOptions& options, const Host& host, BuildReport& report) {
  constexpr int max_passes = 4;
  GrowthRules rules{sqrt(1 + 0.8f * options.one_shot_variance), 0.45f, 60000, true, false, analyse_one_shot};
  rules.progress = 0.9f;
  for (int pass = 0; pass < max_passes; ++pass) {
    grow(slabs, field, albedo, rules, host, &report.evaluations);
    probe_density(slabs, options.seed + 2000003ULL * std::uint64_t(pass + 1), field, albedo, host,
                  &report.evaluations);
    const bool met = std::all_of(slabs.begin(), slabs.end(), [&](const Slab& slab) {
      const Total total = total_of(slab);
      return total.cost <= double(rules.goal) * total.ideal;
    });
    if (met) break;
  }
  return slabs;
}

float median_variance(const std::vector<Slab>& slabs) {
  std::vector<double> variance;
  for (const Slab& slab : slabs) {
    const Total total = total_of(slab);
    if (total.ideal > 0) variance.push_back(sqr(total.cost / total.ideal) - 1);
  }
  if (variance.empty()) return 0;
  std::nth_element(variance.begin(), variance.begin() + std::ptrdiff_t(variance.size() / 2), variance.end());
  return float(variance[variance.size() / 2]);
}

}  // namespace

SamplerData build(const AnyBrdf& f, const BuildOptions& options, const Host& host) {
  SamplerData data;
  data.material = f.traits().name;
  data.target = options.target;
  const Examination seen = examine(f, options, host);
  data.domain = options.domain ? *options.domain : choose_domain(f, options, seen, host);
  data.report.asymmetry = seen.asymmetry;
  const Field field{f, options.target, data.domain, data.domain.half && !seen.mirror_symmetric};
  host.progress(0.1f);

  data.albedo = build_albedo(field, options.albedo_error, host, &data.report.evaluations);
  host.progress(0.4f);
  const std::vector<Slab> slabs = first_slabs(f.traits().theta_o_knots, data.albedo, data.domain);

  const std::vector<Slab> exact = build_exact(slabs, field, data.albedo, options, host, data.report);
  data.exact_partition = partition_of(exact);
  for (const Slab& slab : exact) data.exact.push_back(majorant_tree(slab));
  host.progress(0.9f);

  const std::vector<Slab> one_shot = build_one_shot(slabs, field, data.albedo, options, host, data.report);
  data.one_shot_partition = partition_of(one_shot);
  for (const Slab& slab : one_shot) data.one_shot.push_back(density_tree(slab));
  data.report.one_shot_variance = median_variance(one_shot);

  data.probes = probe_identity(f, options.target);
  host.progress(1);
  return data;
}

}  // namespace reflectree
