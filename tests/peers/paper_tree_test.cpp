// SPDX-License-Identifier: Apache-2.0
// The paper's trees do what the paper says, and their limits are seen.
#include "reflectree/peers/paper_tree.hpp"

#include <gtest/gtest.h>

#include "paper_fixture.hpp"
#include "reflectree/peers/paper_sampler.hpp"
#include "reflectree/peers/paper_statistics.hpp"

namespace reflectree {
namespace {

TEST(PaperTree, LeavesMeetTheirTest) {
  PaperOptions options;
  options.n_max = 3;
  const PaperTree tree = build_paper_tree(brdf("ggx:alpha=0.3"), {}, at(40), options);
  std::size_t failing = 0;
  for (const PaperNode& n : tree.nodes) failing += n.first_child < 0 && 3 * n.integral < n.volume;
  EXPECT_EQ(failing, tree.unmet);
  options.max_depth = 3;  // the twin: too shallow for the lobe
  EXPECT_GT(build_paper_tree(brdf("ggx:alpha=0.05"), {}, at(40), options).unmet, 0U);
}

// Against points of the node in the disk: does the box lose none of them, and could no side shrink?
struct Fit {
  bool keeps = true, tight = true;
};
Fit fit_of(const PaperNode& node, const PaperBox& box) {
  double x0 = 9, x1 = -9, y0 = 9, y1 = -9;
  for (int i = 0; i <= 400; ++i) {
    for (int j = 0; j <= 400; ++j) {
      const double x = double(node.x) + i / 400. * double(node.size),
                   y = double(node.y) + j / 400. * double(node.size);
      if (x * x + y * y > 1) continue;
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
  }
  Fit fit;
  if (x0 > x1) return fit;
  const double step = double(node.size) / 200;
  for (const double spare : {x0 - box.x0, box.x1 - x1, y0 - box.y0, box.y1 - y1})
    fit.keeps = fit.keeps && spare >= -1e-9, fit.tight = fit.tight && spare <= step;
  return fit;
}

TEST(PaperTree, ClippingKeepsTheDiskAndIsTight) {
  Pcg32 u(1);
  int lossy = 0, loose = 0;  // twins that were seen
  for (int k = 0; k < 200; ++k) {
    const float size = 1.f / float(1 << (u() % 5));
    const auto cells = std::uint32_t(2 / size);
    const PaperNode node{-1 + size * float(u() % cells), -1 + size * float(u() % cells), size};
    const PaperBox box = clip_to_disk(node);
    const Fit fit = fit_of(node, box);
    EXPECT_TRUE(fit.keeps && fit.tight) << node.x << " " << node.y << " " << size;
    PaperBox twin = box;  // the whole node, unclipped
    twin.x0 = double(node.x), twin.x1 = double(node.x + size);
    twin.y0 = double(node.y), twin.y1 = double(node.y + size);
    loose += !fit_of(node, twin).tight;
    twin = box, twin.x1 -= 0.02 * double(size);  // one side too far in
    lossy += !fit_of(node, twin).keeps;
  }
  EXPECT_GT(loose, 20);
  EXPECT_GT(lossy, 100);
}

// Off the paper's disk, T falls to 0 along a line; what is negligible there is not split without end.
TEST(PaperTree, LeavesNegligibleNodesAlone) {
  const AnyBrdf f = brdf("plastic:alpha=0.4");
  for (const PaperMap map : {PaperMap::equal_area, PaperMap::half_vector}) {
    PaperOptions options;
    options.map = map;
    const PaperTree endless = build_paper_tree(f, {}, at(40), options);
    options.negligible = 1e-3;
    const PaperTree tree = build_paper_tree(f, {}, at(40), options);
    EXPECT_LT(tree.nodes.size(), 250U);
    EXPECT_GT(endless.nodes.size(), 10 * tree.nodes.size());
    const double trials = paper_statistics(f, {}, {&tree, 1}, options).trials;
    EXPECT_NEAR(trials, paper_statistics(f, {}, {&endless, 1}, options, 1).trials, 0.05 * trials);
  }
}

TEST(PaperTree, DividesManyDirectionsByTheirMass) {
  const AnyBrdf f = brdf("ggx:alpha=0.3");
  const PaperTree tree = build_paper_tree(f, {}, at(30));
  std::vector<std::size_t> sum(tree.nodes.size());
  Pcg32 rest(5);
  UniformBits u(rest);
  constexpr std::size_t rounds = 2000, n = 100;
  for (std::size_t r = 0; r < rounds; ++r) {
    std::size_t all = 0;
    divide_paper_count(tree, n, u, false,
                       [&](std::size_t leaf, std::size_t count) { sum[leaf] += count, all += count; });
    EXPECT_EQ(all, n);
  }
  double worst = 0, twin = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (tree.nodes[i].first_child >= 0) continue;
    const double mean = tree.nodes[i].integral / tree.nodes[0].integral * n * rounds;
    worst = std::max(worst, std::abs(double(sum[i]) - mean) / std::sqrt(mean + 1));
    twin = std::max(twin, std::abs(double(sum[i]) - 1.1 * mean) / std::sqrt(mean + 1));
  }
  EXPECT_LT(worst, 5);
  EXPECT_GT(twin, 5);
}

// Rejection as predicted: every trial takes five words, the first ones included.
TEST(PaperStatistics, PredictsTheTrials) {
  const AnyBrdf f = brdf("ggx:alpha=0.2");
  const Direction wo = at(50);
  for (const bool restart : {false, true}) {
    PaperOptions options;
    options.retry_from_root = restart;
    const PaperSampler sampler(f, {}, wo, options);
    const PaperStatistics s = paper_statistics(f, {}, sampler.trees(), options);
    Pcg32 u(3);
    constexpr int n = 20'000;
    double trials = 0;
    for (int i = 0; i < n; ++i) {
      Pcg32 walk = u;
      ASSERT_TRUE(sampler.sample(wo, u).has_value());
      const auto there = [&] {
        Pcg32 a = walk, b = u;
        return a() == b() && a() == b();
      };
      for (; !there(); ++trials) walk.advance(5);
    }
    EXPECT_NEAR(trials / n, s.trials, 0.03 * s.trials) << restart;
    PaperOptions finer = options;  // the twin: another tree needs others
    finer.n_max = 2;
    const PaperSampler other(f, {}, wo, finer);
    const double twin = paper_statistics(f, {}, other.trees(), finer).trials;
    EXPECT_GT(std::abs(trials / n - twin), 0.03 * s.trials);
    EXPECT_LE(s.trials, options.n_max);
    EXPECT_EQ(s.bytes, sampler.bytes());
    EXPECT_EQ(s.unmet, 0U);
    EXPECT_LT(s.lost, 1e-9);
  }
}

TEST(PaperStatistics, SeesWrongEstimates) {
  const AnyBrdf f = brdf("plastic:alpha=0.2");
  PaperOptions options;
  options.grid = 16;
  const PaperTree tree = build_paper_tree(f, {}, at(40), options);
  const PaperStatistics fine = paper_statistics(f, {}, {&tree, 1}, options);
  EXPECT_LT(fine.integral_error, 2e-3);
  EXPECT_LT(fine.overshoot, 2e-3);
  EXPECT_LT(fine.albedo_error, 2e-3);
  EXPECT_GE(fine.evaluations, tree.nodes.size() * 16 * 16 / 2);

  PaperTree wrong = spoiled(tree, options);
  EXPECT_GT(paper_statistics(f, {}, {&wrong, 1}, options).integral_error, 2e-3);
  for (PaperNode& n : wrong.nodes) n.maximum /= 2, n.volume /= 2;
  EXPECT_GT(paper_statistics(f, {}, {&wrong, 1}, options).overshoot, 0.1);
  wrong = tree, wrong.nodes[0].integral *= 1.01;
  EXPECT_GT(paper_statistics(f, {}, {&wrong, 1}, options).albedo_error, 5e-3);
}

}  // namespace
}  // namespace reflectree
