// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_choice.hpp"

namespace reflectree {

namespace {

// Which of n parts u falls into, in proportion to their masses; u becomes its place in that part. A part
// without mass is never chosen.
template <std::size_t n>
std::size_t part_of(double& u, const std::array<double, n>& mass) {
  double total = 0, lower = 0, width = 0;
  for (const double m : mass) total += m;
  std::size_t chosen = 0;
  for (std::size_t c = 0; c < n; ++c) {
    if (!(mass[c] > 0)) continue;
    lower += width, width = mass[c], chosen = c;
    if (u * total < lower + width) break;
  }
  u = width > 0 ? std::clamp((u * total - lower) / width, 0.0, 0x1.fffffffffffffp-1) : 0;
  return chosen;
}

std::size_t by_alias(const PaperTree& tree, double& u) {
  const double scaled = u * double(tree.buckets.size());
  const PaperBucket& b = tree.buckets[std::size_t(scaled)];
  u = scaled - std::floor(scaled);
  const std::uint32_t leaves[] = {b.own, b.other};
  return leaves[part_of<2>(u, {b.keep, 1 - b.keep})];
}

}  // namespace

std::size_t choose_paper_leaf(const PaperTree& tree, const PaperOptions& options, double& u, double& v) {
  if (options.choice == PaperChoice::alias) return by_alias(tree, u);
  std::size_t i = 0;
  while (tree.nodes[i].first_child >= 0) {
    const auto first = std::size_t(tree.nodes[i].first_child);
    std::array<double, 4> m;
    for (std::size_t c = 0; c < 4; ++c) m[c] = paper_mass(tree.nodes[first + c], options.retry_from_root);
    if (options.choice == PaperChoice::cdf) {
      i = first + part_of(u, m);
    } else {
      const std::size_t column = part_of<2>(u, {m[0] + m[2], m[1] + m[3]});
      i = first + column + 2 * part_of<2>(v, {m[column], m[column + 2]});
    }
  }
  return i;
}

std::vector<PaperBucket> make_paper_buckets(const PaperTree& tree, bool by_volume) {
  std::vector<PaperBucket> buckets;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (tree.nodes[i].first_child >= 0) continue;
    const auto leaf = std::uint32_t(i);
    buckets.push_back({paper_mass(tree.nodes[i], by_volume), leaf, leaf});
  }
  double total = 0;
  for (const PaperBucket& b : buckets) total += b.keep;
  if (!(total > 0)) return {};
  std::vector<std::size_t> small, large;
  for (std::size_t i = 0; i < buckets.size(); ++i) {
    buckets[i].keep *= double(buckets.size()) / total;
    (buckets[i].keep < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    PaperBucket &low = buckets[small.back()], &high = buckets[large.back()];
    small.pop_back();
    low.other = high.own, high.keep -= 1 - low.keep;
    if (high.keep < 1) small.push_back(large.back()), large.pop_back();
  }
  // Rounding alone is left.
  for (const auto* rest : {&small, &large}) {
    for (const std::size_t i : *rest) buckets[i].keep = 1;
  }
  return buckets;
}

}  // namespace reflectree
