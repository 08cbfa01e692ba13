// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree {

namespace {

struct Measured {
  double accepted = 0;  // int min(T, M)
  double target = 0;    // int T
};

PaperStatistics of_tree(const AnyBrdf& f, Target target, const PaperTree& tree, const PaperOptions& o,
                        int refine) {
  PaperStatistics s;
  s.unmet = tree.unmet, s.bytes = bytes_of(tree), s.evaluations = tree.evaluations;
  std::vector<const PaperNode*> leaves;
  for (const PaperNode& n : tree.nodes) {
    if (n.first_child < 0) leaves.push_back(&n);
  }
  s.leaves = leaves.size();
  std::vector<Measured> measured;
  std::vector<double> values;
  Measured all;
  for (const PaperNode* leaf : leaves) {
    paper_grid(f, target, tree.wo, o.map, *leaf, o.grid * refine, values);
    const double cell = double(leaf->size) * double(leaf->size) / double(values.size());
    Measured m;
    for (const double t : values) m.accepted += std::min(t, leaf->maximum) * cell, m.target += t * cell;
    all.accepted += m.accepted, all.target += m.target;
    measured.push_back(m);
  }
  const PaperNode& root = tree.nodes[0];
  if (!(root.integral > 0 && all.accepted > 0)) return s;
  s.overshoot = 1 - all.accepted / all.target;
  s.albedo_error = std::abs(root.integral / all.target - 1);
  if (o.retry_from_root) {
    const double rate = std::min(1.0, all.accepted / root.volume);
    s.lost = std::pow(1 - rate, o.max_trials), s.trials = (1 - s.lost) / rate;
    return s;
  }
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const double share = leaves[i]->integral / root.integral;
    s.integral_error += std::abs(share - measured[i].target / all.target) / 2;
    if (!(share > 0)) continue;
    // A geometric number of trials, cut off: its mean is (1 - (1 - rate)^max) / rate.
    const double rate = std::min(1.0, measured[i].accepted / leaves[i]->volume);
    const double lost = std::pow(1 - rate, o.max_trials);
    s.lost += share * lost;
    s.trials += share * (rate > 0 ? (1 - lost) / rate : o.max_trials);
  }
  return s;
}

}  // namespace

PaperStatistics paper_statistics(const AnyBrdf& f, Target target, std::span<const PaperTree> trees,
                                 const PaperOptions& options, int refine, const Host& host) {
  std::vector<PaperStatistics> each(trees.size());
  const auto work = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) each[i] = of_tree(f, target, trees[i], options, refine);
  };
  if (f.traits().concurrent) {
    host.parallel_for(trees.size(), work);
  } else {
    work(0, trees.size());
  }
  PaperStatistics sum;
  double lit = 0;
  for (const PaperStatistics& s : each) {
    sum.leaves += s.leaves, sum.unmet += s.unmet, sum.bytes += s.bytes, sum.evaluations += s.evaluations;
    sum.trials += s.trials, sum.lost += s.lost, lit += s.trials > 0;
    sum.integral_error = std::max(sum.integral_error, s.integral_error);
    sum.overshoot = std::max(sum.overshoot, s.overshoot);
    sum.albedo_error = std::max(sum.albedo_error, s.albedo_error);
  }
  if (lit > 0) sum.trials /= lit, sum.lost /= lit;
  return sum;
}

}  // namespace reflectree
