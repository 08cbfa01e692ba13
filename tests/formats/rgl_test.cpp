// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/rgl.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reference_values.hpp"
#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/measured_facts.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "runs_of_pairs.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

double square_u(double theta) { return std::sqrt(2 * theta / pi_v<double>); }

struct SquarePoint {
  double u, v;
};
SquarePoint half_vector_on_square(Direction wo, Direction wi) {
  const Vec3<double> a{wo.x, wo.y, wo.z}, b{wi.x, wi.y, wi.z}, h = a + b;
  double v = (phi_of(h) - phi_of(a)) / (2 * pi_v<double>)+0.5;
  return {square_u(theta_of(h)), v - std::floor(v)};
}

// The largest |got - wanted| / wanted over random pairs; `wanted` is f cos_i of the green channel.
template <class Wanted>
double worst_error(const RglTable& table, Wanted wanted, bool swap = false) {
  double worst = 0;
  const Pairs pairs = random_pairs(4000, 0.5f, 11);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Direction wo = pairs.wo[i], wi = pairs.wi[i];
    const Rgb f = swap ? eval(table, wi, wo) : eval(table, wo, wi);
    const double expected = wanted(wo, wi), got = double(f.g) * double(swap ? wo.z : wi.z);
    worst = std::max(worst, std::abs(got - expected) / expected);
  }
  return worst;
}

TEST(FastTrigonometry, MatchesTheLibraryWithin3e7) {
  Pcg32 bits(5);
  for (int i = 0; i < 200000; ++i) {
    const float scale = std::pow(10.f, 8 * to_unit_float(bits()) - 4);
    const float y = scale * (to_unit_float(bits()) - 0.5f), x = to_unit_float(bits()) - 0.5f;
    const double expected = std::atan2(double(y), double(x));
    ASSERT_NEAR(angle_of(y, x), expected, 3e-7 * std::abs(expected)) << y << " " << x;
  }
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_EQ(first_quadrant_angle(1, 0), 0.5f * pi);
  EXPECT_EQ(first_quadrant_angle(0, 1), 0);
}

// A uniform warp is the identity: the colours are read at the half vector itself.
TEST(Rgl, UniformWarpReadsTheColoursAtTheHalfVector) {
  synthetic::RglRecipe recipe;
  recipe.vndf = [](int, float, float) { return 3.f; };
  recipe.rgb = [](int, int c, float x, float y) { return 0.1f + float(c) * (0.2f + 0.5f * x + 0.1f * y); };
  recipe.sigma = [](float u) { return 1 - 0.5f * u; };
  recipe.ndf = [](float u) { return 3 - 2 * u; };
  const RglTable table = read_rgl(synthetic::rgl_file(recipe), "test");
  const auto wanted = [](Direction wo, Direction wi) {
    const auto [u, v] = half_vector_on_square(wo, wi);
    const double sigma = 1 - 0.5 * square_u(theta_of(Vec3<double>{wo.x, wo.y, wo.z}));
    return (0.3 + 0.5 * u + 0.1 * v) * (3 - 2 * u) / (4 * sigma);
  };
  EXPECT_LT(worst_error(table, wanted), 2e-5);
  EXPECT_GT(worst_error(table, wanted, true), 1e-2) << "swapped arguments must show";
}

// A density 1 + k u has the cumulative mass (u + k u^2 / 2) / (1 + k / 2); k differs between the nodes of
// theta_o, and the masses of both nodes are mixed linearly.
TEST(Rgl, WarpInvertsALinearDensity) {
  synthetic::RglRecipe recipe;
  recipe.theta_o = {0.f, 1.5707964f};
  recipe.vndf = [](int t, float u, float) { return 1 + float(4 * t) * u; };
  recipe.rgb = [](int, int, float x, float) { return 0.1f + x; };
  recipe.jacobian = false;
  const RglTable table = read_rgl(synthetic::rgl_file(recipe), "test");
  const auto expected = [](bool planted) {
    return [planted](Direction wo, Direction wi) {
      const double u = half_vector_on_square(wo, wi).u;
      const double t = theta_of(Vec3<double>{wo.x, wo.y, wo.z}) / (0.5 * pi_v<double>);
      const double upper = (u + 2 * u * u) / 3;
      return 0.1 + (planted ? u : (1 - t) * u + t * upper);
    };
  };
  EXPECT_LT(worst_error(table, expected(false)), 2e-5);
  EXPECT_GT(worst_error(table, expected(true)), 1e-2) << "a missing warp must show";
}

// Blocks, look-ups shared by neighbours of one wo, and pairs below the surface.
TEST(Rgl, BatchesAreOneByOne) {
  const RglTable table = read_rgl(synthetic::rgl_file(), "test");
  const auto [wo, wi] = runs_of_pairs();
  std::vector<float> values(3 * wo.size(), -1);
  table.eval(wo, wi, values);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const Rgb alone = wo[i].z > 0 && wi[i].z > 0 ? eval(table, wo[i], wi[i]) : Rgb{};
    EXPECT_EQ(alone, (Rgb{values[3 * i], values[3 * i + 1], values[3 * i + 2]})) << i;
  }
}

// A colour that falls linearly through 0: entries are interpolated as they are, so that the value stays
// linear up to where it is cut, beside and beyond the negative entries.
TEST(Rgl, NegativeEntriesAreInterpolatedAndValuesCut) {
  synthetic::RglRecipe recipe;
  recipe.vndf = [](int, float, float) { return 1.f; };
  recipe.rgb = [](int, int c, float x, float) { return c == 1 ? 0.65f - x : 1.f; };
  recipe.jacobian = false;
  const RglTable table = read_rgl(synthetic::rgl_file(recipe), "test");
  const auto difference = [&](const auto& wanted) {
    double worst = 0;
    int cut = 0;
    const Pairs pairs = random_pairs(4000, 0.5f, 11);
    for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
      const double u = half_vector_on_square(pairs.wo[i], pairs.wi[i]).u;
      const double got = double(eval(table, pairs.wo[i], pairs.wi[i]).g) * double(pairs.wi[i].z);
      const double signed_value =
          double(table.unclipped(shading_geometry(pairs.wo[i], pairs.wi[i])).g) * double(pairs.wi[i].z);
      EXPECT_NEAR(signed_value, 0.65 - u, 2e-5);
      worst = std::max(worst, std::abs(got - wanted(u)));
      cut += got == 0 ? 1 : 0;
    }
    EXPECT_GT(cut, 100);
    return worst;
  };
  EXPECT_LT(difference([](double u) { return std::max(0.65 - u, 0.0); }), 2e-5);
  // The fault: the nodes at u = 3/4 and 1 cut to 0 first.
  const auto entries_cut = [](double u) { return u < 0.5 ? 0.65 - u : std::max(0.15 * (3 - 4 * u), 0.0); };
  EXPECT_GT(difference(entries_cut), 2e-2) << "cut entries must show";
}

TEST(Rgl, ANegativeDistributionOfNormalsIsCutWhereItIsRead) {
  synthetic::RglRecipe recipe;
  recipe.vndf = [](int, float, float) { return 1.f; };
  recipe.rgb = [](int, int c, float, float) { return c == 0 ? -1.f : 1.f; };
  recipe.sigma = [](float) { return 0.25f; };
  recipe.ndf = [](float u) { return 0.65f - u; };
  const RglTable table = read_rgl(synthetic::rgl_file(recipe), "test");
  const Pairs pairs = random_pairs(4000, 0.5f, 12);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const double u = half_vector_on_square(pairs.wo[i], pairs.wi[i]).u;
    const Rgb f = eval(table, pairs.wo[i], pairs.wi[i]);
    ASSERT_NEAR(double(f.g) * double(pairs.wi[i].z), std::max(0.65 - u, 0.0), 2e-5);
    ASSERT_EQ(f.r, 0) << "two negative factors make no light";
  }
  recipe.vndf = [](int, float u, float) { return u > 0.95f ? -1e-3f : 1.f; };
  EXPECT_THROW(read_rgl(synthetic::rgl_file(recipe), "test"), Error) << "a negative density";
}

TEST(Rgl, FactsCountEntriesAndValues) {
  synthetic::RglRecipe recipe;
  recipe.rgb = [](int t, int c, float x, float) { return c == 1 && (t > 1 || x == 0) ? -1.f : 1.f; };
  const MeasuredFacts facts = *measured_facts(synthetic::rgl_file(recipe), "m.bsdf");
  EXPECT_EQ(facts.entries, std::uint64_t(8 + 4 * 3 * 25));
  EXPECT_EQ(facts.negative, std::uint64_t(5 + 5 + 25 + 25));
  EXPECT_EQ(facts.negative_at, (std::vector<std::uint64_t>{5, 5, 25, 25}));
  EXPECT_EQ(facts.not_measured, 0U);
  EXPECT_EQ(facts.clipped[0], 0U);
  EXPECT_EQ(facts.clipped[2], 0U);
  // From theta_o = 1.1 on all of green is negative; below 0.5 little of it.
  const double share = double(facts.clipped[1]) / double(facts.pairs);
  EXPECT_GT(share, std::cos(1.1));
  EXPECT_LT(share, 0.8);
  EXPECT_EQ(facts.bridged, (std::array<std::uint64_t, 3>{}));
  std::uint64_t pairs = 0, touched = 0;
  for (std::size_t i = 0; i < facts.pairs_in_band.size(); ++i)
    pairs += facts.pairs_in_band[i], touched += facts.touched_in_band[i];
  EXPECT_EQ(pairs, facts.pairs);
  EXPECT_EQ(touched, facts.clipped[1]);
  EXPECT_THROW(measured_facts(synthetic::rgl_file(recipe), "m.bsdf", "linear"), Error);
  const MeasuredFacts clean = *measured_facts(synthetic::rgl_file(), "m.bsdf");
  EXPECT_EQ(clean.negative, 0U);
  EXPECT_EQ(clean.clipped, (std::array<std::uint64_t, 3>{}));
}

TEST(Rgl, TellsItsKnots) {
  const synthetic::RglRecipe recipe;
  const RglTable table = read_rgl(synthetic::rgl_file(recipe), "name");
  const BrdfTraits traits = traits_of(table);
  EXPECT_EQ(traits.theta_o_knots, recipe.theta_o);
  EXPECT_EQ(traits.name, "name");
  EXPECT_EQ(traits.channels, 3);
  EXPECT_TRUE(traits.isotropic);
}

TEST(Rgl, FiniteContinuousAndIsotropicUpToGrazing) {
  const RglTable table = read_rgl(synthetic::rgl_file(), "test");
  for (const double degrees : {0.0, 1e-4, 30.0, 89.0, 89.999, 89.99999}) {
    for (const double other : {0.0, 1e-4, 45.0, 89.999, 89.99999}) {
      for (int k = 0; k < 24; ++k) {
        const double phi = k * pi_v<double> / 12;
        const auto direction = [](double deg, double azimuth) {
          const auto w = direction_from_angles(deg * pi_v<double> / 180, azimuth);
          return Direction{float(w.x), float(w.y), float(w.z)};
        };
        const Direction wo = direction(degrees, 0.3), wi = direction(other, phi);
        const Rgb f = eval(table, wo, wi);
        ASSERT_TRUE(finite_and_not_negative(f));
        if (degrees < 1) continue;  // at the pole the azimuth is a convention
        const Rgb turned = eval(table, direction(degrees, 1.3), direction(other, phi + 1));
        const Rgb moved = eval(table, wo, direction(other, phi + 1e-5));
        const float scale = f.g + 1e-3f;
        // Near the pole of the half vector the azimuth of a pair of nearly opposite grazing directions is
        // noise.
        if (wo.z + wi.z > 1e-3f) {
          EXPECT_NEAR(turned.g / scale, f.g / scale, 1e-3f);
          EXPECT_NEAR(moved.g / scale, f.g / scale, 1e-3f);
        }
      }
    }
  }
}

TEST(Rgl, DirectionsThatAreNotFiniteDoNoHarm) {
  const RglTable table = read_rgl(synthetic::rgl_file(), "test");
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF, 1e30f}) {
    for (const Direction wo : {Direction{bad, 0, 0.5f}, Direction{0, bad, 1}, Direction{bad, bad, bad}}) {
      EXPECT_TRUE(finite_and_not_negative(eval(table, wo, {0, 0.6f, 0.8f})));
      EXPECT_TRUE(finite_and_not_negative(eval(table, {0, 0.6f, 0.8f}, wo)));
    }
  }
}

// Values of another renderer: f cos_i, not clipped, 200 pairs per file.
struct Reference {
  std::vector<Direction> wo, wi;
  std::vector<Rgb> f_cos;
};
Reference renderer_values(const std::string& material) {
  std::ifstream in(measured_data() + "/reference/mitsuba_values.csv");
  Reference reference;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(material + ",", 0) != 0) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line.substr(material.size()));
    Direction wo, wi;
    Rgb f;
    fields >> wo.x >> wo.y >> wo.z >> wi.x >> wi.y >> wi.z >> f.r >> f.g >> f.b;
    reference.wo.push_back(wo);
    reference.wi.push_back(wi);
    reference.f_cos.push_back(f);
  }
  return reference;
}

// Empty where there is no interpreter with NumPy.
std::vector<double> numpy_values(const std::string& file, const Pairs& pairs) {
  if (std::string(REFLECTREE_PYTHON).empty()) return {};
  return reference_values("rgl_reference.py", {file}, pairs, {}, REFLECTREE_PYTHON);
}

// |f cos_i - reference| / (|reference| + 1e-3), the worst channel, sorted, with references below 0 read as 0;
// 1e-3 sr^-1 is 1/300 of white paper.
std::vector<double> errors(const RglTable& table, const Pairs& pairs, const std::vector<double>& reference) {
  std::vector<double> all;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Rgb f = eval(table, pairs.wo[i], pairs.wi[i]);
    double difference = 0, size = 0;
    for (int c = 0; c < 3; ++c) {
      const double wanted = std::max(reference[3 * i + std::size_t(c)], 0.0);
      difference =
          std::max(difference, std::abs(double(channel_value(f, c)) * double(pairs.wi[i].z) - wanted));
      size = std::max(size, std::abs(wanted));
    }
    all.push_back(difference / (size + 1e-3));
  }
  std::sort(all.begin(), all.end());
  return all;
}

// In float the half vector of the sharpest file's grazing pairs is conditioned so badly that roundings of the
// directions alone move the reference by 2e-2; the bulk is what tells a right formula.
void expect_close(const std::vector<double>& sorted, const std::string& file) {
  EXPECT_LT(sorted[sorted.size() * 999 / 1000], 1e-4) << file;
  EXPECT_LT(sorted.back(), 5e-3) << file;
}

TEST(Rgl, SyntheticFileAgreesWithNumpy) {
  const TemporaryFolder folder("rgl");
  write_file_atomically(folder / "m.bsdf", synthetic::rgl_file());
  const Pairs pairs = random_pairs(20000, 0.1f, 7);
  const std::vector<double> reference = numpy_values(folder / "m.bsdf", pairs);
  if (reference.empty()) GTEST_SKIP() << "no python3 with numpy";
  const RglTable table = read_rgl(read_file(folder / "m.bsdf", max_rgl_bytes), "m");
  expect_close(errors(table, pairs, reference), "synthetic");
}

TEST(Rgl, MeasuredFilesAgreeWithNumpyAndAnotherRenderer) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  const Pairs pairs = random_pairs(100000, 0.1f, 7);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(measured_data() + "/rgl")) {
    const std::string file = entry.path().string(), material = entry.path().stem().string();
    const RglTable table = read_rgl(read_file(file, max_rgl_bytes), file);
    ++files;

    const Reference renderer = renderer_values(material);
    ASSERT_EQ(renderer.wo.size(), 200U) << material;
    // Every channel, cut at 0 as a value; and as it is, negative where the data is.
    double worst = 0, worst_signed = 0, worst_swapped = 0;
    for (std::size_t i = 0; i < 200; ++i) {
      const auto error = [](float got, float wanted) {
        return double(std::abs(got - wanted) / (std::abs(wanted) + 1e-3f));
      };
      const Direction wo = renderer.wo[i], wi = renderer.wi[i];
      const Rgb f = eval(table, wo, wi), as_it_is = table.unclipped(shading_geometry(wo, wi));
      for (int c = 0; c < 3; ++c) {
        const float wanted = channel_value(renderer.f_cos[i], c);
        worst = std::max(worst, error(channel_value(f, c) * wi.z, std::max(wanted, 0.f)));
        worst_signed = std::max(worst_signed, error(channel_value(as_it_is, c) * wi.z, wanted));
      }
      worst_swapped = std::max(worst_swapped, error(eval(table, wi, wo).g * wo.z, renderer.f_cos[i].g));
    }
    EXPECT_LT(worst, 1e-3) << material;
    EXPECT_LT(worst_signed, 1e-3) << material;
    EXPECT_GT(worst_swapped, 0.1) << material << ": swapped arguments must show";

    const std::vector<double> reference = numpy_values(file, pairs);
    if (!reference.empty()) expect_close(errors(table, pairs, reference), material);
  }
  EXPECT_EQ(files, 16);
  if (std::string(REFLECTREE_PYTHON).empty()) std::printf("no python3 with numpy: that half was left out\n");
}

TEST(Rgl, NamesWhatItDoesNotSupport) {
  const auto error_of = [](std::vector<synthetic::Field> fields) -> std::string {
    return error_words([&] { read_rgl(synthetic::tensor_file(fields), "m.bsdf"); });
  };
  auto fields = synthetic::rgl_fields({});
  fields[0] = synthetic::floats("phi_i", {3}, {0, 1, 2});
  EXPECT_NE(error_of(fields).find("m.bsdf: unsupported: an anisotropic material; "), std::string::npos);
  fields = synthetic::rgl_fields({});
  fields[5].name = "spectra";
  EXPECT_NE(error_of(fields).find("a spectral material"), std::string::npos);
  fields = synthetic::rgl_fields({});
  fields.erase(fields.begin() + 3);
  EXPECT_NE(error_of(fields).find("no field 'ndf'"), std::string::npos);
  fields = synthetic::rgl_fields({});
  fields[5].type = 11;
  fields[5].shape = {1, 4, 3, 5, 2};
  EXPECT_NE(error_of(fields).find("not of 32-bit floats"), std::string::npos);
}

}  // namespace
}  // namespace reflectree
