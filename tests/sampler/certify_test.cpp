// SPDX-License-Identifier: Apache-2.0
// Certified bounds: who gets them, that nothing exceeds them, and that a wrong bound is found and raised.
#include "reflectree/sampler/certify.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "functions.hpp"
#include "reflectree/brdf/material/mixture.hpp"
#include "reflectree/brdf/tables/half_angle_table.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/verify/attack.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree {
namespace {

bool all_certified(const SamplerData& data) {
  return std::all_of(data.exact.begin(), data.exact.end(),
                     [](const MajorantTree& t) { return t.status == BoundStatus::certified; });
}

// The largest T / (albedo M q) at random viewers and points.
double largest_share(const SamplerData& data, const AnyBrdf& f, int points, std::uint64_t seed) {
  const PackedSampler packed = pack(data);
  Pcg32 u(seed);
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const double theta = 1.5707 * std::pow(to_unit_double(u()), i % 2 ? 1 : 0.1);
    const float c = max(float(std::cos(theta)), min_cos_theta_o);
    const Direction wo{float(std::sin(theta)), 0, c};
    const PackedSlab& slab = packed.exact.slab_at(c);
    const PackedLeaf& leaf = packed.exact.leaves[slab.first + u() % slab.count];
    // Often at the borders of the leaf.
    const auto across = [&u] { return clamp(1.1f * to_unit_float(u()) - 0.05f, 0.f, 1.f); };
    const detail::PointInLeaf at = detail::point_at(leaf, packed.domain.half(), across(), across());
    const DomainPoint point = lift(packed.domain, wo, at.p, u() & 1U);
    const double target = double(packed.target(f(point.geometry)) * point.projected_area);
    largest = std::max(largest, target / double(packed.viewer.albedo.at(c) * at.height));
  }
  return largest;
}

class Certified : public testing::TestWithParam<const char*> {};

TEST_P(Certified, EverySlabAndNothingExceedsIt) {
  const AnyBrdf f = material(GetParam());
  const SamplerData estimated = build(f);
  SamplerData data = estimated;
  const Certification c = certify(data, f, {.tolerance = 0.03, .trials = 16});
  EXPECT_EQ(c.certified_slabs, c.slabs);
  EXPECT_EQ(c.proved_leaves, c.leaves);
  EXPECT_TRUE(all_certified(data));
  EXPECT_NO_THROW(validate(data));
  EXPECT_EQ(data.report.overshoot_mass, 0);
  EXPECT_GE(c.largest_ratio, 1);
  for (std::size_t s = 0; s < data.exact.size(); ++s) {
    EXPECT_EQ(data.exact[s].nodes, estimated.exact[s].nodes) << "leaves stay where they are";
    EXPECT_GE(data.exact[s].volume, 0.99999f * estimated.exact[s].volume);
    EXPECT_LE(data.exact[s].volume, 1.08f * estimated.exact[s].volume);
  }
  EXPECT_LE(largest_share(data, f, 200000, 3), 1);
}
INSTANTIATE_TEST_SUITE_P(Materials, Certified,
                         testing::Values("lambert", "oren_nayar:sigma=0.5", "0.5*lambert + 0.3*phong:n=3",
                                         "ggx:alpha=0.6", "ggx:alpha=1", "plastic:alpha=0.3"));

// Where raised bounds cost more trials than were promised, a sharper proof takes them back.
TEST(Certify, TrialsStayBelowWhatWasPromised) {
  const AnyBrdf f = material("oren_nayar:sigma=1.5");
  const SamplerData estimated = build(f);
  ASSERT_LE(estimated.report.expected_trials, 1.25f);
  SamplerData data = estimated, once = estimated;
  certify(data, f);
  EXPECT_TRUE(all_certified(data));
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_LE(largest_share(data, f, 200000, 3), 1);
  certify(once, f, {.trials = 16});
  EXPECT_GT(once.report.expected_trials, 1.25f) << "or there was nothing to take back";
}

// Proofs that end early leave looser bounds; leaves are halved until they are paid for.
TEST(Certify, HalvedLeavesPayForLooseBounds) {
  const AnyBrdf f = material("phong:n=3");
  const SamplerData estimated = build(f);
  SamplerData data = estimated, unpaid = estimated;
  const CertifyOptions early{.boxes_per_leaf = 300};
  certify(data, f, early);
  EXPECT_TRUE(all_certified(data));
  EXPECT_NO_THROW(validate(data));
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_LE(largest_share(data, f, 200000, 3), 1);
  CertifyOptions never = early;
  never.trials = 16;
  certify(unpaid, f, never);
  EXPECT_GT(unpaid.report.expected_trials, 1.25f) << "or there was nothing to pay for";
  std::size_t leaves = 0, before = 0;
  for (const MajorantTree& tree : data.exact) leaves += tree.mass.size();
  for (const MajorantTree& tree : estimated.exact) before += tree.mass.size();
  EXPECT_GT(leaves, before);
  EXPECT_LE(leaves, 3 * before / 2);
}

// The twin: bounds that are too low are raised to where they must be.
TEST(CertifyTwin, AWrongBoundIsRaised) {
  const AnyBrdf f = material("oren_nayar");
  const SamplerData good = build(f);
  SamplerData bad = with_halved_bounds(good);
  ASSERT_GT(largest_share(bad, f, 200000, 3), 1.2) << "the planted fault must be one";
  const Certification c = certify(bad, f);
  EXPECT_GT(c.raised_leaves, 0U);
  EXPECT_TRUE(all_certified(bad));
  EXPECT_LE(largest_share(bad, f, 200000, 3), 1);
}

// A function whose enclosure is that of another one is caught, not certified.
struct Impostor {
  AnyBrdf honest = material("oren_nayar");
  Spectrum operator()(const ShadingGeometry<float>& g) const { return scaled_value(honest(g), 1.05f); }
  BrdfTraits traits() const {
    BrdfTraits traits = honest.traits();
    traits.name = "impostor";
    return traits;
  }
};
TEST(CertifyTwin, AForeignEnclosureIsFound) {
  const AnyBrdf f = Impostor();
  SamplerData data = build(f);
  const SamplerData before = data;
  EXPECT_THROW(certify(data, f), Error);
  EXPECT_EQ(data, before);
}

TEST(Certify, WhatHasNoFormIsRefused) {
  const AnyBrdf black_box = [](Direction, Direction) { return 0.3f; };
  SamplerData data = build(black_box);
  const SamplerData before = data;
  try {
    certify(data, black_box);
    ADD_FAILURE() << "a black box was certified";
  } catch (const Error& error) {
    EXPECT_NE(error.wrong().find("no interval form"), std::string::npos) << error.what();
  }
  EXPECT_EQ(data, before);
  EXPECT_EQ(no_proof(material("ggx:alpha=0.2")), "");
  EXPECT_EQ(no_proof(material("ggx:alpha_x=0.1,alpha_y=0.3")), "");
  EXPECT_NE(no_proof(mixture({{0.5f, material("ggx:alpha=0.2")}, {0.5f, black_box}})), "")
      << "one term has none";
}

// Too few boxes: the bounds stay estimates, and the report says so.
TEST(Certify, OpenLeavesKeepTheirEstimates) {
  const AnyBrdf f = material("oren_nayar");
  const SamplerData before = build(f);
  SamplerData data = before;
  const Certification c = certify(data, f, {.boxes_per_leaf = 1});
  EXPECT_LT(c.certified_slabs, c.slabs);
  EXPECT_FALSE(all_certified(data));
  ASSERT_EQ(data.report.notes.size(), before.report.notes.size() + 1);
  EXPECT_NE(data.report.notes.back().find("leaves are open"), std::string::npos);
  for (std::size_t s = 0; s < data.exact.size(); ++s) {
    if (data.exact[s].status == BoundStatus::certified) continue;
    EXPECT_EQ(data.exact[s].nodes, before.exact[s].nodes);
    // What is seen above a bound raises it all the same.
    EXPECT_GE(data.exact[s].volume, 0.99999f * before.exact[s].volume);
    EXPECT_LE(data.exact[s].volume, 1.01f * before.exact[s].volume);
  }
  certify(data, f);
  EXPECT_TRUE(all_certified(data));
  EXPECT_EQ(data.report.notes, before.report.notes) << "the note goes when the leaves are proved";
}

TEST(Certify, ResultsDoNotDependOnThreads) {
  const AnyBrdf f = material("oren_nayar");
  SamplerData one = build(f), two = one;
  certify(one, f);
  certify(two, f, {}, uneven_threads(2));
  EXPECT_EQ(one, two);
}

TEST(Certify, CancelLeavesTheDataAlone) {
  const AnyBrdf f = material("lambert");
  SamplerData data = build(f);
  const SamplerData before = data;
  Host host;
  host.cancelled = [] { return true; };
  EXPECT_THROW(certify(data, f, {}, host), Cancelled);
  EXPECT_EQ(data, before);
  EXPECT_THROW(certify(data, f, {.tolerance = 0}), Error);
}

// Functions that bound themselves, in the three ways that there are.
struct Chalk {
  float operator()(Direction wo, Direction wi) const { return 0.2f + 0.1f * wo.z * wi.z; }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.isotropic_by_formula = true;
    return traits;
  }
};
struct BoundedChalk : Chalk {
  float scale = 1;
  float bound(const DirectionCell& cell) const {
    return scale * (0.2f + 0.1001f * float(cell.wo.z.hi * cell.wi.z.hi));
  }
};
struct EnclosedChalk : Chalk {
  RealInterval bound(const DirectionCell& cell) const {
    return RealInterval(0.2f) + RealInterval(0.0999, 0.1001) * (cell.wo.z * cell.wi.z);
  }
};
struct SteepChalk : Chalk {
  double constant = 0.101;
  double lipschitz() const { return constant; }
};
TEST(Certify, OwnBoundsAreDetectedAndProve) {
  static_assert(BoundedBrdf<BoundedChalk> && BoundedBrdf<EnclosedChalk> && LipschitzBrdf<SteepChalk>);
  static_assert(!BoundedBrdf<Chalk> && !LipschitzBrdf<Chalk>);
  EXPECT_NE(no_proof(Chalk()), "");
  for (const AnyBrdf& f : {AnyBrdf(BoundedChalk()), AnyBrdf(EnclosedChalk()), AnyBrdf(SteepChalk())}) {
    SamplerData data = build(f);
    const SamplerData before = data;
    certify(data, f);
    EXPECT_TRUE(all_certified(data));
    EXPECT_LE(data.report.expected_trials, 1.25f);
    EXPECT_LE(largest_share(data, f, 100000, 3), 1);
    EXPECT_EQ(build(Chalk()).exact, before.exact) << "an own bound changes no build";
  }
}
struct SerialChalk : BoundedChalk {
  std::shared_ptr<std::atomic<int>> inside = std::make_shared<std::atomic<int>>(0);
  std::shared_ptr<std::atomic<int>> overlaps = std::make_shared<std::atomic<int>>(0);
  float bound(const DirectionCell& cell) const {
    if (inside->fetch_add(1) > 0) ++*overlaps;
    const float most = BoundedChalk::bound(cell);
    --*inside;
    return most;
  }
  BrdfTraits traits() const {
    BrdfTraits traits = Chalk::traits();
    traits.concurrent = false;
    return traits;
  }
};
TEST(Certify, AsksAFunctionOfOneThreadFromOneThread) {
  const SerialChalk chalk;
  SamplerData data = build(chalk);
  certify(data, chalk, {}, uneven_threads(4));
  EXPECT_EQ(*chalk.overlaps, 0);
}
// The twin: bounds that are contradicted by values at points.
TEST(CertifyTwin, OwnBoundsThatLieAreFound) {
  BoundedChalk low;
  low.scale = 0.97f;
  SteepChalk flat;
  flat.constant = 0.02;
  for (const AnyBrdf& f : {AnyBrdf(low), AnyBrdf(flat)}) {
    SamplerData data = build(f);
    const SamplerData before = data;
    try {
      certify(data, f);
      ADD_FAILURE() << "a bound that lies was believed";
    } catch (const Error& error) {
      EXPECT_NE(error.wrong().find("does not hold"), std::string::npos) << error.what();
    }
    EXPECT_EQ(data, before);
  }
}

// Tables: both look-ups, as exactly the floats that are sampled. Cells that are constant differ by 4 % at most.
AnyBrdf small_table(TableLookup lookup) {
  HalfAngleTable table;
  table.n_h = 3, table.n_d = 2, table.n_p = 2, table.lookup = lookup;
  const float rough = lookup == TableLookup::linear ? 0.1f : 0.01f;
  for (int i = 0; i < table.n_h * table.n_d * table.n_p * 3; ++i)
    table.rgb.push_back(0.25f + rough * float(i * 7 % 5) / 4);
  return enclosed(table);
}
TEST(Certify, TablesOfBothLookUps) {
  for (const TableLookup lookup : {TableLookup::linear, TableLookup::nearest}) {
    const AnyBrdf f = small_table(lookup);
    SamplerData data = build(f);
    const Certification c = certify(data, f, {.tolerance = 0.05, .trials = 16});
    EXPECT_EQ(c.proved_leaves, c.leaves);
    EXPECT_TRUE(all_certified(data));
    EXPECT_LE(largest_share(data, f, 200000, 3), 1);
  }
}

}  // namespace
}  // namespace reflectree
