// SPDX-License-Identifier: Apache-2.0
// Every way into a sampler is judged by bins, channels and lanes; each check has a twin that it must reject.
#include <cmath>

#include "reflectree/verify/faults.hpp"
#include "reflectree/verify/way_tally.hpp"
#include "reflectree/verify/ways.hpp"
#include "simple_samplers.hpp"
#include "suspects.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t samples = 200'000;
const Direction wo = direction_at(40, 200);

ChiSquareOptions options() {
  ChiSquareOptions o;
  o.tests = 200;
  return o;
}
const Bins& bins() {
  static const Bins b = equal_mass_bins(target_function(coloured()), wo);
  return b;
}
WayTally tally(const WayIn& way, std::uint64_t seed = 1) {
  return tally_of(built().suspect(), way, bins(), samples, seed);
}
WayIn way(const std::string& name) {
  for (WayIn& w : built().suspect().ways) {
    if (w.name == name) return w;
  }
  ADD_FAILURE() << "no way named " << name;
  return {};
}

TEST(Ways, EveryOneDrawsAsItShould) {
  const Suspect s = built().suspect();
  ASSERT_EQ(s.ways.size(), 8u);
  const auto references = channel_references(s.f, wo, 1);
  for (const WayIn& w : s.ways) {
    const WayTally t = tally(w);
    EXPECT_EQ(t.samples, samples);
    std::vector<CheckResult> results{
        check_weights(t, bins(), options()), check_mean_weight(t, bins(), options(), 2e-4),
        check_channel_weights(t, references, options()), check_alive(t, w.exact)};
    if (w.exact) results.push_back(check_counts(t, bins(), options()));
    if (w.name.find("batch") != std::string::npos) results.push_back(check_lanes(t, options()));
    expect_all_pass(results);
  }
}

TEST(WaysTwin, BentDensities) {
  for (const WayIn& w : built().suspect().ways) {
    const WayTally t = tally(bent(w, 1, 0.06));
    EXPECT_FALSE(check_weights(t, bins(), options()).passed) << w.name;
  }
}

// Turned back by minus phi: invisible in the plane of azimuth 0.
TEST(WaysTwin, TurnedBackTheWrongWay) {
  const auto mirror = [](Direction viewer, Direction w) {
    const float s = std::sqrt(viewer.x * viewer.x + viewer.y * viewer.y);
    const float c = s > 0 ? viewer.x / s : 1, n = s > 0 ? viewer.y / s : 0;
    const Direction local{w.x * c + w.y * n, w.y * c - w.x * n, w.z};
    return Direction{local.x * c + local.y * n, local.y * c - local.x * n, w.z};
  };
  const WayIn turned =
      spoiled(way("exact"), "turned",
              [&](Direction v, Pcg32&, DrawnAt& d, std::span<float>) { d.wi = mirror(v, d.wi); });
  EXPECT_FALSE(check_counts(tally(turned), bins(), options()).passed);
  const Direction in_plane = direction_at(40, 0);
  const Bins there = equal_mass_bins(target_function(coloured()), in_plane);
  const WayTally unseen = tally_of(built().suspect(), turned, there, samples, 1);
  EXPECT_TRUE(check_counts(unseen, there, options()).passed);
}

TEST(WaysTwin, ChannelsExchanged) {
  const auto references = channel_references(AnyBrdf(coloured()), wo, 1);
  const WayIn swapped =
      spoiled(way("exact, batch"), "exchanged",
              [](Direction, Pcg32&, DrawnAt&, std::span<float> w) { std::swap(w[0], w[2]); });
  const WayTally t = tally(swapped);
  EXPECT_TRUE(check_mean_weight(t, bins(), options()).passed) << "the norm does not see it";
  EXPECT_FALSE(check_channel_weights(t, references, options()).passed);
}

// More channels than are judged one by one: combinations.
TEST(WaysTwin, TwoOfTwelveChannelsExchanged) {
  const auto f = [](Direction, Direction wi) {
    Spectrum v(12);
    for (int c = 0; c < 12; ++c) v[c] = (1 + 0.1f * float(c) * wi.z) / 20;
    return v;
  };
  struct Twelve {
    decltype(f) call;
    Spectrum operator()(Direction o, Direction i) const { return call(o, i); }
    BrdfTraits traits() const {
      BrdfTraits t;
      t.channels = 12;
      return t;
    }
  };
  const AnyBrdf twelve(Twelve{f});
  const auto sampler = make_sampler(twelve);
  const Suspect s = suspect(sampler, twelve);
  const Bins there = equal_mass_bins(target_function(twelve), wo);
  const auto references = channel_references(s.f, wo, 3);
  EXPECT_EQ(references.size(), 4u);
  const WayTally right = tally_of(s, s.ways[0], there, samples, 1);
  EXPECT_TRUE(check_channel_weights(right, references, options()).passed);
  const WayIn swapped = spoiled(
      s.ways[0], "exchanged", [](Direction, Pcg32&, DrawnAt&, std::span<float> w) { std::swap(w[1], w[9]); });
  EXPECT_FALSE(check_channel_weights(tally_of(s, swapped, there, samples, 1), references, options()).passed);
}

// One lane of 64 draws from something else: a share of the whole that no chi-square over all sees.
TEST(WaysTwin, OneLaneOfABatchIsWrong) {
  const WayIn batch = way("exact, batch"), other = way("one-shot");
  WayIn one_lane = spoiled(batch, "lane 63", [](Direction, Pcg32& u, DrawnAt& d, std::span<float>) {
    if (d.lane == 63 && u() % 4 == 0) d.wi.y = -std::abs(d.wi.y);
  });
  const WayTally t = tally(one_lane);
  EXPECT_TRUE(check_counts(t, bins(), options()).passed);
  EXPECT_FALSE(check_lanes(t, options()).passed);
  const WayIn silent = spoiled(
      batch, "lane 5 silent", [](Direction, Pcg32&, DrawnAt& d, std::span<float>) { d.drawn = d.lane != 5; });
  EXPECT_FALSE(check_lanes(tally(silent), options()).passed);
}

TEST(WaysTwin, DyingAndDeadDirections) {
  EXPECT_FALSE(check_alive(tally(dying(way("exact"), 20'000)), true).passed);
  const WayIn dead = spoiled(way("one-shot"), "dead", [](Direction, Pcg32& u, DrawnAt&, std::span<float> w) {
    if (u() % 10'000 == 0) std::fill(w.begin(), w.end(), 0.f);
  });
  EXPECT_FALSE(check_alive(tally(dead), false).passed);
  const WayIn below =
      spoiled(way("one-shot"), "below", [](Direction, Pcg32& u, DrawnAt& d, std::span<float>) {
        if (u() % 10'000 == 0) d.wi.z = -d.wi.z;
      });
  EXPECT_FALSE(check_alive(tally(below), false).passed);
}

// Where f itself is 0, one-shot mode may draw: no fault (decision 0018).
TEST(Ways, DirectionsOfWeightZeroWhereFIsZeroAreNoFault) {
  const AnyBrdf f = [](Direction, Direction wi) { return wi.z > 0.4f ? 0.5f + 0.1f * wi.z : 0.f; };
  const auto sampler = make_sampler(f);
  const Suspect s = suspect(sampler, f);
  const Direction view = direction_at(30, 77);
  const Bins there = equal_mass_bins(target_function(f), view);
  const WayTally one_shot = tally_of(s, s.ways[3], there, samples, 1);
  EXPECT_GT(one_shot.dead, 0u) << "the case is none";
  EXPECT_TRUE(check_alive(one_shot, false).passed) << to_line(check_alive(one_shot, false));
  const WayTally exact = tally_of(s, s.ways[0], there, samples, 1);
  EXPECT_EQ(exact.dead, 0u);
  // In exact mode it would be one.
  EXPECT_FALSE(check_alive(one_shot, true).passed);
}

TEST(Ways, ThreadsDoNotMatter) {
  const Suspect s = built().suspect();
  for (const WayIn& w : s.ways) {
    EXPECT_EQ(tally_of(s, w, bins(), 50'000, 3).count,
              tally_of(s, w, bins(), 50'000, 3, threaded_host()).count);
  }
}

}  // namespace
}  // namespace reflectree
