// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/merl.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "measured_data.hpp"
#include "reflectree/brdf/material/baked_tables.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/measured_facts.hpp"

namespace reflectree {
namespace {

Vec3<double> widen(Direction w) { return {w.x, w.y, w.z}; }

// A table whose cell (h, d, p) holds its own indices.
HalfAngleTable index_table(int n_h, int n_d, int n_p, bool reciprocal) {
  HalfAngleTable table;
  table.n_h = n_h, table.n_d = n_d, table.n_p = n_p, table.reciprocal = reciprocal;
  for (int h = 0; h < n_h; ++h) {
    for (int d = 0; d < n_d; ++d) {
      for (int p = 0; p < n_p; ++p) {
        for (const int i : {h, d, p}) table.rgb.push_back(float(i));
      }
    }
  }
  return table;
}

// Positions in cells from the format's description, through the double half-angle coordinates of `math`.
struct Position {
  double h, d, p;
};
Position position(const HalfAngleTable& t, Direction wo, Direction wi) {
  const auto a = to_half_angle(widen(wo), widen(wi));
  const double right = pi_v<double> / 2, period = t.reciprocal ? pi_v<double> : 2 * pi_v<double>;
  return {t.n_h * std::sqrt(a.theta_h / right), t.n_d * a.theta_d / right,
          t.n_p * (a.phi_d < 0 ? a.phi_d + period : a.phi_d) / period};
}

TEST(HalfAngleTable, NearestFindsTheCellOfTheFormat) {
  for (const bool reciprocal : {true, false}) {
    const HalfAngleTable table = index_table(90, 90, reciprocal ? 180 : 360, reciprocal);
    const Pairs pairs = random_pairs(50000, 0.3f, 3);
    int near_border = 0;
    for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
      const Position x = position(table, pairs.wo[i], pairs.wi[i]);
      const Rgb cell = eval(table, pairs.wo[i], pairs.wi[i]);
      const auto border = [](double v) { return std::abs(v - std::round(v)) < 1e-3; };
      if (border(x.h) || border(x.d) || border(x.p) || x.d < 0.1) {
        ++near_border;
        continue;
      }
      ASSERT_EQ(cell, (Rgb{float(int(x.h)), float(int(x.d)), float(int(x.p))}));
    }
    EXPECT_LT(near_border, 2000);
  }
}

TEST(HalfAngleTable, LinearIsExactForALinearTableAndContinuous) {
  HalfAngleTable table = index_table(12, 10, 16, false);
  table.lookup = TableLookup::linear;
  const Pairs pairs = random_pairs(50000, 0.3f, 4);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Position x = position(table, pairs.wo[i], pairs.wi[i]);
    const Rgb got = eval(table, pairs.wo[i], pairs.wi[i]);
    ASSERT_NEAR(got.r, clamp(x.h - 0.5, 0.0, 11.0), 1e-4);
    ASSERT_NEAR(got.g, clamp(x.d - 0.5, 0.0, 9.0), 1e-4);
    if (x.p > 0.5 && x.p < 15.5 && x.d > 0.01) {
      ASSERT_NEAR(got.b, x.p - 0.5, 1e-2);
    }
  }
  // phi_d wraps: just below and above 0 the value is half-way between the last cell and the first.
  const auto at = [&](double phi_d) {
    const auto pair = from_half_angle(HalfAngle<double>{0.3, 0.2, 0.6, phi_d});
    const auto narrow = [](Vec3<double> w) { return Direction{float(w.x), float(w.y), float(w.z)}; };
    return eval(table, narrow(pair.wo), narrow(pair.wi)).b;
  };
  EXPECT_NEAR(at(1e-4), 7.5f, 0.02f);
  EXPECT_NEAR(at(-1e-4), 7.5f, 0.02f);
}

TEST(HalfAngleTable, CentresLieAboveTheHorizonAndInTheirCells) {
  const HalfAngleTable table = index_table(90, 90, 180, true);
  int inside = 0, pulled = 0;
  for (int h = 0; h < 90; h += 3) {
    for (int d = 0; d < 90; d += 3) {
      for (int p = 0; p < 180; p += 7) {
        const auto [wo, wi] = cell_centre(table, h, d, p);
        ASSERT_GT(wo.z, 0);
        ASSERT_GT(wi.z, 0);
        const Position x = position(table, wo, wi);
        ASSERT_NEAR(x.h, h + 0.5, 1e-2);  // roundings of grazing directions
        ASSERT_NEAR(x.p, p + 0.5, d == 0 ? 1e-2 : 1e-3);
        ASSERT_LT(x.d, d + 0.5 + 1e-3);
        (x.d > d + 0.499 ? inside : pulled) += 1;
      }
    }
  }
  EXPECT_GT(inside, 10000);
  EXPECT_GT(pulled, 1000);
}

TEST(HalfAngleTable, DirectionsThatAreNotFiniteDoNoHarm) {
  HalfAngleTable table = index_table(12, 10, 16, false);
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF, 1e30f}) {
    for (const Direction wo : {Direction{bad, 0, 0.5f}, Direction{0, bad, 1}, Direction{bad, bad, bad}}) {
      for (const TableLookup lookup : {TableLookup::nearest, TableLookup::linear}) {
        table.lookup = lookup;
        EXPECT_TRUE(finite_and_not_negative(eval(table, wo, {0, 0.6f, 0.8f})));
        EXPECT_TRUE(finite_and_not_negative(eval(table, {0, 0.6f, 0.8f}, wo)));
      }
    }
  }
}

TEST(Merl, BakedFileGivesTheFunctionBackAtTheCentres) {
  const Ggx ggx{0.2f, {0.9f, 0.5f, 0.2f}};
  const Bytes bytes = write_merl(tabulate_merl(ggx));
  EXPECT_EQ(bytes.size(), 34'992'012U);
  const HalfAngleTable table = read_merl(bytes, "baked");
  EXPECT_EQ(table.name, "baked");
  for (int h = 0; h < 90; h += 4) {
    for (int d = 1; d < 90; d += 4) {
      for (int p = 0; p < 180; p += 11) {
        const auto [wo, wi] = cell_centre(table, h, d, p);
        const Rgb f = eval(ggx, wo, wi);
        const float* cell = &table.rgb[((std::size_t(h) * 90 + std::size_t(d)) * 180 + std::size_t(p)) * 3];
        ASSERT_NEAR(cell[0], f.r, 1e-5f * f.r);
        ASSERT_NEAR(cell[1], f.g, 1e-5f * f.g);
        ASSERT_NEAR(cell[2], f.b, 1e-5f * f.b);
      }
    }
  }
  // Interpolated, the table follows the function between the centres too; looked up by cell, it cannot.
  HalfAngleTable linear = table;
  linear.lookup = TableLookup::linear;
  double error_linear = 0, error_nearest = 0;
  const Pairs pairs = random_pairs(5000, 0.5f, 9);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    if (min(pairs.wo[i].z, pairs.wi[i].z) < 0.3f) continue;
    const float f = eval(ggx, pairs.wo[i], pairs.wi[i]).r;
    error_linear += std::abs(eval(linear, pairs.wo[i], pairs.wi[i]).r / f - 1);
    error_nearest += std::abs(eval(table, pairs.wo[i], pairs.wi[i]).r / f - 1);
  }
  EXPECT_LT(error_linear, 0.1 * error_nearest);
}

TEST(Merl, ValuesAndPlanesAreThoseOfTheFormat) {
  Bytes bytes = write_merl(tabulate_merl(Lambert{{0.3f, 0.6f, 0.9f}}));
  const auto stored = [&](std::size_t plane, std::size_t cell) {
    ByteReader in(bytes, "");
    in.seek(12 + 8 * (plane * 1'458'000 + cell));
    return in.f64();
  };
  EXPECT_NEAR(stored(0, 7), 0.3 / pi_v<double> * 1500, 1e-4);
  EXPECT_NEAR(stored(1, 1'000'000), 0.6 / pi_v<double> * 1500 / 1.15, 1e-4);
  EXPECT_NEAR(stored(2, 1'457'999), 0.9 / pi_v<double> * 1500 / 1.66, 1e-4);
  // A missing entry, here the green one of cell (2, 3, 5), reads as 0, is counted, and stays missing.
  Bytes minus_one;
  append_f64(minus_one, -1);
  const std::size_t cell = 5 + 180 * (3 + 90 * 2);
  std::copy(minus_one.begin(), minus_one.end(), bytes.begin() + std::ptrdiff_t(12 + 8 * (1'458'000 + cell)));
  const HalfAngleTable table = read_merl(bytes, "x");
  EXPECT_EQ(measured_facts(bytes, "x")->not_measured, 1U);
  EXPECT_EQ(measured_facts(write_merl(table), "x")->not_measured, 1U) << "a copy keeps the mark";
  const auto [wo, wi] = cell_centre(table, 2, 3, 5);
  EXPECT_EQ(eval(table, wo, wi).g, 0);
  EXPECT_NEAR(eval(table, wo, wi).b, 0.9f / pi, 1e-6f);
}

// Fives with a hole in one channel: the mark -1 is never mixed with them.
HalfAngleTable holed_table(const std::vector<std::array<int, 3>>& hole, int channel) {
  HalfAngleTable table = index_table(12, 10, 16, false);
  table.lookup = TableLookup::linear;
  for (float& v : table.rgb) v = 5;
  for (const auto& [h, d, p] : hole) {
    table.rgb[((std::size_t(h) * 10 + std::size_t(d)) * 16 + std::size_t(p)) * 3 + std::size_t(channel)] = -1;
  }
  return table;
}

TEST(HalfAngleTable, MissingEntriesAreLeftOut) {
  std::vector<std::array<int, 3>> hole;
  for (int h = 3; h < 6; ++h) {
    for (int d = 2; d < 5; ++d) {
      for (int p = 0; p < 16; ++p) hole.push_back({h, d, p});
    }
  }
  const HalfAngleTable table = holed_table(hole, 1), whole_table = holed_table({}, 1);
  int whole = 0, bridged = 0, dark = 0;
  const Pairs pairs = random_pairs(20000, 0.5f, 6);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Rgb f = eval(table, pairs.wo[i], pairs.wi[i]);
    const Rgb missing = table.unmeasured(shading_geometry(pairs.wo[i], pairs.wi[i]));
    const Rgb unholed = eval(whole_table, pairs.wo[i], pairs.wi[i]);
    ASSERT_EQ(f.r, unholed.r) << "another channel";
    ASSERT_EQ(missing.r, 0);
    const Position x = position(table, pairs.wo[i], pairs.wi[i]);
    // Inside the hole's centres nothing was measured; outside its neighbours' everything was.
    const bool inside = x.h > 3.501 && x.h < 5.499 && x.d > 2.501 && x.d < 4.499;
    const bool outside = x.h < 2.499 || x.h > 6.501 || x.d < 1.499 || x.d > 5.501;
    if (inside) {
      ASSERT_EQ(f.g, 0);
      ASSERT_NEAR(missing.g, 1, 1e-5);
      ++dark;
    } else if (outside) {
      ASSERT_EQ(f.g, unholed.g);
      ASSERT_EQ(missing.g, 0);
      ++whole;
    } else if (missing.g > 1e-3f && missing.g < 0.999f) {
      ASSERT_NEAR(f.g, 5, 1e-3) << "no fading towards the hole";
      ++bridged;
    }
  }
  EXPECT_GT(whole, 1000);
  EXPECT_GT(bridged, 100);
  EXPECT_GT(dark, 100);
  HalfAngleTable nearest = table;
  nearest.lookup = TableLookup::nearest;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const float g = eval(nearest, pairs.wo[i], pairs.wi[i]).g;
    ASSERT_TRUE(g == 0 || g == 5) << g;
    ASSERT_EQ(g == 0, nearest.unmeasured(shading_geometry(pairs.wo[i], pairs.wi[i])).g == 1);
  }
}

TEST(Merl, FactsTellWhatWasNotMeasured) {
  HalfAngleTable table = tabulate_merl(Lambert{{0.3f, 0.6f, 0.9f}});
  // Blue beyond 60 degrees of theta_d.
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < table.rgb.size(); i += 3) {
    if (i / 3 / 180 % 90 >= 60) table.rgb[i + 2] = -1, ++missing;
  }
  const Bytes bytes = write_merl(table);
  for (const std::string member : {"nearest", "linear"}) {
    const MeasuredFacts facts = *measured_facts(bytes, "m.binary", member);
    EXPECT_EQ(facts.not_measured, missing);
    EXPECT_EQ(facts.entries, 3U * 1'458'000);
    EXPECT_EQ(facts.negative, 0U);
    EXPECT_EQ(facts.dark[0] + facts.bridged[0] + facts.dark[1] + facts.bridged[1], 0U);
    EXPECT_GT(facts.dark[2], facts.pairs / 20);
    EXPECT_EQ(facts.bridged[2] > 0, member == "linear");
    // Such pairs have a low direction: theta_d is no more than the larger elevation. Linear look-ups meet the
    // gap half a degree earlier.
    EXPECT_EQ(facts.touched_in_band[0], 0U);
    EXPECT_LE(facts.touched_in_band[1], member == "linear" ? facts.pairs_in_band[1] / 50 : 0U);
    EXPECT_GT(facts.touched_in_band[4], 0U);
  }
}

// f(wo, wi) != f(wi, wo).
Rgb one_sided(Direction wo, Direction wi) { return {0.1f + 0.2f * wo.z, 0.1f + 0.2f * wi.z, 0.3f}; }

TEST(Merl, OnlyTheLongVariantKeepsANonReciprocalFunction) {
  const HalfAngleTable full = read_merl(write_merl(tabulate_merl(one_sided, false)), "x");
  const HalfAngleTable folded = tabulate_merl(one_sided, true);
  EXPECT_FALSE(full.reciprocal);
  EXPECT_EQ(full.n_p, 360);
  const auto [wo, wi] = cell_centre(full, 30, 40, 100);
  const Rgb f = one_sided(wo, wi), mean = 0.5f * (f + one_sided(wi, wo));
  EXPECT_NEAR(eval(full, wo, wi).r, f.r, 1e-5f);
  EXPECT_NEAR(eval(full, wi, wo).r, one_sided(wi, wo).r, 2e-3f);
  EXPECT_NEAR(eval(folded, wo, wi).r, mean.r, 2e-3f);
}

struct Anisotropic {
  float operator()(Direction, Direction) const { return 1; }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.isotropic = false;
    return traits;
  }
};

struct SevenChannels {
  Spectrum operator()(Direction, Direction) const { return Spectrum(7); }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.channels = 7;
    return traits;
  }
};

TEST(Merl, BakingRefusesWhatTheFormatCannotHold) {
  EXPECT_THROW(tabulate_merl(Anisotropic{}), Error);
  EXPECT_THROW(tabulate_merl(SevenChannels{}), Error);
  EXPECT_THROW(tabulate_merl([](Direction, Direction wi) { return wi.z - 0.5f; }), Error);
  EXPECT_THROW(tabulate_merl([](Direction, Direction wi) { return 1 / (wi.z - wi.z); }), Error);
}

TEST(Merl, BakingUsesTheHostsThreadsReportsAndStops) {
  std::vector<float> fractions;
  Host host;
  host.progress = [&](float f) { fractions.push_back(f); };
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::thread other(body, n / 2, n);
    body(0, n / 2);
    other.join();
  };
  const HalfAngleTable threaded = tabulate_merl(Ggx{}, true, host);
  EXPECT_EQ(threaded.rgb, tabulate_merl(Ggx{}).rgb);
  ASSERT_EQ(fractions.size(), 15U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1);
  int asked = 0;
  host.cancelled = [&] { return ++asked == 3; };
  EXPECT_THROW(tabulate_merl(Ggx{}, true, host), Cancelled);
}

// The table's albedo per channel at theta_o, midpoints over the projected disk.
Rgb albedo(const HalfAngleTable& table, float theta_o) {
  const Direction wo{sin(theta_o), 0, cos(theta_o)};
  Rgb sum;
  const int n = 400;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const float r2 = (float(i) + 0.5f) / float(n), phi = 2 * pi * (float(j) + 0.5f) / float(n);
      const Direction wi{sqrt(r2) * cos(phi), sqrt(r2) * sin(phi), sqrt(1 - r2)};
      sum = sum + pi / float(n * n) * eval(table, wo, wi);
    }
  }
  return sum;
}

TEST(BakedTables, AreRepeatableAndPassForMeasurements) {
  EXPECT_EQ(baked_tables().size(), 3U);
  for (const BakedTable& entry : baked_tables()) {
    const HalfAngleTable table = bake_table(entry.name);
    EXPECT_EQ(table.rgb, bake_table(entry.name).rgb);
    EXPECT_EQ(table.name, entry.name);
    double asymmetry = 0;
    const Pairs pairs = random_pairs(5000, 0.3f, 2);
    for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
      const Rgb f = eval(table, pairs.wo[i], pairs.wi[i]), swapped = eval(table, pairs.wi[i], pairs.wo[i]);
      ASSERT_TRUE(finite_and_not_negative(f));
      asymmetry += double(std::abs(f.g - swapped.g) / (f.g + swapped.g)) / 5000;
    }
    EXPECT_GT(asymmetry, 0.005) << entry.name << " must not be reciprocal";
    EXPECT_LT(asymmetry, 0.1) << entry.name;
    for (const float theta_o : {0.f, 0.8f, 1.3f, 1.55f}) {
      const Rgb a = albedo(table, theta_o);
      EXPECT_GT(a.g, 0.03f) << entry.name;
      EXPECT_LT(max(a.r, max(a.g, a.b)), 1.f) << entry.name << " at " << theta_o;
    }
  }
  EXPECT_THROW(bake_table("baked_nothing"), Error);
}

TEST(BakedTables, PeakWhereTheirNamesSay) {
  const Direction wo = normalize(Direction{0.8f, 0, 1}), mirror{-wo.x, 0, wo.z};
  const Direction normal{0, 0, 1};
  const auto green = [&](const char* name, Direction wi) { return eval(bake_table(name), wo, wi).g; };
  EXPECT_GT(green("baked_glossy", mirror), 10 * green("baked_glossy", normal));
  EXPECT_GT(green("baked_retro", wo), 4 * green("baked_retro", mirror));
  EXPECT_LT(green("baked_matt", mirror), 2 * green("baked_matt", normal));
}

}  // namespace
}  // namespace reflectree
