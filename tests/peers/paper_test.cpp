// SPDX-License-Identifier: Apache-2.0
// The paper's sampler does what the paper says, and its limits are seen.
#include "reflectree/peers/paper_sampler.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "reflectree/brdf/material.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

AnyBrdf brdf(const char* text) { return make_brdf(parse_material(text)); }
Direction at(double theta_deg) { return direction_from_angles(float(theta_deg * pi_v<double> / 180), 0.f); }

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

// Against random points: none of the disk's lies outside of the clipped rectangle, and no side could shrink.
TEST(PaperTree, ClippingKeepsTheDiskAndIsTight) {
  Pcg32 u(1);
  for (int k = 0; k < 200; ++k) {
    const float size = 1.f / float(1 << (u() % 5));
    const auto cells = std::uint32_t(2 / size);
    const PaperNode node{-1 + size * float(u() % cells), -1 + size * float(u() % cells), size};
    const PaperBox box = clip_to_disk(node);
    double x0 = 9, x1 = -9, y0 = 9, y1 = -9;
    for (int i = 0; i <= 400; ++i) {
      for (int j = 0; j <= 400; ++j) {
        const double x = double(node.x) + i / 400. * double(size),
                     y = double(node.y) + j / 400. * double(size);
        if (x * x + y * y > 1) continue;
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
      }
    }
    if (x0 > x1) continue;
    const double step = double(size) / 200;
    const double spare[] = {x0 - box.x0, box.x1 - x1, y0 - box.y0, box.y1 - y1};
    for (const double d : spare) {
      EXPECT_GE(d, -1e-9);
      EXPECT_LE(d, step);
    }
  }
}

Tally tally(const PaperSampler& sampler, const Bins& bins, const ChiSquareOptions& options) {
  const ErasedSampler erased = erase(sampler);
  return tally_of(erased, bins, options);
}

// Fine estimates, one wo: the density is proportional to f, by both ways of retrying; with a halved bound it
// is not.
TEST(PaperSampler, DrawsInProportionToTheFunction) {
  const AnyBrdf f = brdf("plastic:alpha=0.4");
  const Direction wo = at(40);
  const Bins bins = equal_mass_bins(target_function(f), wo, {100, 1e-3});
  ChiSquareOptions chi;
  chi.samples = 100'000;
  chi.tests = 3;
  for (const auto& [area, root] : {std::pair{false, false}, {false, true}, {true, true}}) {
    PaperOptions options;
    options.grid = 32;
    options.area_preserving = area, options.retry_from_root = root;
    const PaperSampler sampler(f, {}, wo, options);
    const CheckResult counts = check_counts(tally(sampler, bins, chi), bins, chi);
    EXPECT_TRUE(counts.passed) << area << root << " " << to_line(counts);

    PaperTree spoiled = sampler.trees()[0];
    std::size_t heaviest = 0;
    for (std::size_t i = 0; i < spoiled.nodes.size(); ++i) {
      // The last of four children takes what the others leave: its own mass is not looked at.
      if (spoiled.nodes[i].first_child >= 0 || i % 4 == 0) continue;
      if (spoiled.nodes[heaviest].first_child >= 0 ||
          spoiled.nodes[i].integral > spoiled.nodes[heaviest].integral)
        heaviest = i;
    }
    spoiled.nodes[heaviest].integral *= 1.6, spoiled.nodes[heaviest].volume *= 1.6;
    const PaperSampler twin(f, {}, {spoiled}, true, options);
    const CheckResult rejected = check_counts(tally(twin, bins, chi), bins, chi);
    EXPECT_FALSE(rejected.passed) << area << root << " " << to_line(rejected);
  }
}

TEST(PaperSampler, DividesManyDirectionsByTheirMass) {
  const AnyBrdf f = brdf("ggx:alpha=0.3");
  const PaperTree tree = build_paper_tree(f, {}, at(30));
  std::vector<std::size_t> counts(tree.nodes.size()), sum(tree.nodes.size());
  Pcg32 rest(5);
  UniformBits u(rest);
  constexpr std::size_t rounds = 2000, n = 100;
  for (std::size_t r = 0; r < rounds; ++r) {
    divide_paper_count(tree, n, u, false, counts);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t(0)), n);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[i];
  }
  double worst = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (tree.nodes[i].first_child >= 0) continue;
    const double mean = tree.nodes[i].integral / tree.nodes[0].integral * n * rounds;
    worst = std::max(worst, std::abs(double(sum[i]) - mean) / std::sqrt(mean + 1));
  }
  EXPECT_LT(worst, 5);

  const PaperSampler sampler(f, {}, at(30));
  std::vector<DirectionSample<Spectrum>> out(n);
  EXPECT_EQ(sampler.sample_n(at(30), u, out), n);
}

// The limit that the registry's flag stands for: between tabulated elevations the mean weight is not the
// albedo.
TEST(PaperSampler, IsBiasedBetweenTabulatedElevations) {
  const AnyBrdf f = brdf("ashikhmin_shirley:n_x=50,n_y=50,kd=0.02");
  PaperOptions options;
  options.thetas = 8;
  const PaperSampler sampler(f, {}, options);
  const double width = 90. / 8;
  const auto bias = [&](double theta) {
    Pcg32 u(2);
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto drawn = sampler.sample(at(theta), u);
      if (drawn) sum += double(Target()(drawn->weight)) / 2000;
    }
    return std::abs(sum / reference_albedo(target_function(f), at(theta)).value - 1);
  };
  EXPECT_LT(bias(6.5 * width), 0.02);
  EXPECT_GT(bias(6.95 * width), 0.05);
}

}  // namespace
}  // namespace reflectree
