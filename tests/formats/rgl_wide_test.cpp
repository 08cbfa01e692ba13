// SPDX-License-Identifier: Apache-2.0
// RGL files of several azimuths or wavelengths: where azimuths lie, their symmetries, colours of spectra, and
// an independent reading.
#include <gtest/gtest.h>

#include <algorithm>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reference_values.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/measured_facts.hpp"
#include "reflectree/formats/rgl.hpp"
#include "runs_of_pairs.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

using synthetic::azimuths;
using synthetic::rgl_wide_file;
using synthetic::RglWideRecipe;

RglWideRecipe recipe_of(int count, int reduction) {
  RglWideRecipe recipe;
  recipe.phi_o = azimuths(count, reduction);
  return recipe;
}

RglWideTable table_of(const RglWideRecipe& recipe) {
  return RglWideTable(read_rgl_wide_fields(rgl_wide_file(recipe), "test"));
}

double azimuth_on_square(Direction w) {
  return std::atan2(double(w.y), double(w.x)) / (2 * pi_v<double>)+0.5;
}

// A uniform warp is the identity: the colours are read at the half vector, with the surface's own azimuths.
TEST(RglWide, AzimuthsAreTheSurfaces) {
  RglWideRecipe recipe = recipe_of(5, 1);
  recipe.vndf = [](int, int, float, float) { return 3.f; };
  recipe.jacobian = false;
  recipe.colour = [](int p, int, int c, float x, float y) { return c == 0 ? x : c == 1 ? y : float(p); };
  const RglWideTable table = table_of(recipe);
  const Pairs pairs = random_pairs(2000, 0.5f, 3);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const ShadingGeometry<float> g = shading_geometry(pairs.wo[i], pairs.wi[i]);
    const Spectrum f = table(g);
    const double theta_h = std::acos(std::min(double(g.wh.z), 1.0));
    if (theta_h > 0.01) {
      EXPECT_NEAR(double(f[0] * g.wi.z), std::sqrt(2 * theta_h / pi_v<double>), 1e-4);
      EXPECT_NEAR(double(f[1] * g.wi.z), azimuth_on_square(g.wh), 1e-4);
    }
    EXPECT_NEAR(double(f[2] * g.wi.z), 4 * azimuth_on_square(g.wo), 1e-4);
  }
}

TEST(RglWide, ReductionsAreSymmetries) {
  const auto half_turn = [](Direction w) { return Direction{-w.x, -w.y, w.z}; };
  const auto mirror_x = [](Direction w) { return Direction{-w.x, w.y, w.z}; };
  const Pairs pairs = random_pairs(1000, 0.5f, 5);
  for (const int reduction : {1, 2, 4}) {
    const RglWideTable table = table_of(recipe_of(4, reduction));
    double turned = 0, mirrored = 0, sum = 0;
    for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
      const Direction wo = pairs.wo[i], wi = pairs.wi[i];
      const auto f = [&](Direction a, Direction b) { return double(table(shading_geometry(a, b))[1]); };
      sum += f(wo, wi);
      turned += std::abs(f(wo, wi) - f(half_turn(wo), half_turn(wi)));
      mirrored += std::abs(f(wo, wi) - f(mirror_x(wo), mirror_x(wi)));
    }
    EXPECT_EQ(turned / sum < 1e-5, reduction >= 2) << reduction << " " << turned / sum;
    EXPECT_EQ(mirrored / sum < 1e-5, reduction == 4) << reduction << " " << mirrored / sum;
    EXPECT_EQ(table.traits().axis.has_value(), reduction == 4);
    EXPECT_FALSE(table.traits().isotropic);
  }
}

// |f cos_i - reference| / (|reference| + 1e-3), sorted.
std::vector<double> errors(const AnyBrdf& f, const Pairs& pairs, const std::vector<double>& reference) {
  const auto channels = std::size_t(f.channels());
  std::vector<double> all;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Spectrum v = f(shading_geometry(pairs.wo[i], pairs.wi[i]));
    for (std::size_t c = 0; c < channels; ++c) {
      const double wanted = std::max(reference[i * channels + c], 0.0);
      all.push_back(std::abs(double(v[int(c)] * pairs.wi[i].z) - wanted) / (wanted + 1e-3));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(RglWide, SyntheticFilesAgreeWithAnIndependentReading) {
  const TemporaryFolder folder("rgl_wide");
  const Pairs pairs = random_pairs(600, 0.3f, 7);
  const auto compare = [&](const RglWideRecipe& recipe, const char* what) {
    write_file_atomically(folder / "m.bsdf", rgl_wide_file(recipe));
    const auto reference = reference_values("rgl_wide_reference.py", {folder / "m.bsdf"}, pairs);
    const auto sorted = errors(load_brdf(folder / "m.bsdf"), pairs, reference);
    EXPECT_LT(sorted[sorted.size() * 99 / 100], 1e-4) << what;
    EXPECT_LT(sorted.back(), 5e-3) << what;
    RglWideRecipe other = recipe;
    other.vndf = [&](int p, int t, float u, float v) { return recipe.vndf(p + 1, t, u, v); };
    const AnyBrdf fault = RglWideTable(read_rgl_wide_fields(rgl_wide_file(other), "test"));
    EXPECT_GT(errors(fault, pairs, reference).back(), 1e-2) << what << ": a neighbour's warp must show";
  };
  compare(recipe_of(5, 1), "no symmetry");
  compare(recipe_of(4, 2), "half a turn");
  compare(recipe_of(3, 4), "two planes");
  RglWideRecipe spectral = recipe_of(3, 4);
  spectral.wavelengths = {400, 450, 500, 550, 600, 650, 700};
  compare(spectral, "spectral");
  spectral.phi_o = {0};
  spectral.sigma = [](float u, float) { return 1 - 0.8f * u; };
  spectral.ndf = [](float u, float) { return 3 - 2 * u; };
  compare(spectral, "isotropic, spectral");
}

TEST(RglWide, IsotropicFilesAreReadAlike) {
  std::vector<Bytes> files{synthetic::rgl_file()};
  if (!measured_data().empty()) {
    for (const char* name : {"chm_mint_rgb", "irid_flake_paint1_rgb", "cg_sunflower_rgb"})
      files.push_back(read_file(measured_data() + "/rgl/" + name + ".bsdf", max_rgl_bytes));
  }
  const Pairs pairs = random_pairs(5000, 0.3f, 11);
  for (const Bytes& bytes : files) {
    const RglTable narrow = read_rgl(bytes, "m");
    const RglWideTable wide(read_rgl_wide_fields(bytes, "m"));
    EXPECT_TRUE(wide.traits().isotropic_by_formula);
    int differ = 0;
    for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
      const ShadingGeometry<float> g = shading_geometry(pairs.wo[i], pairs.wi[i]);
      const Rgb a = narrow(g);
      const Spectrum b = wide(g);
      for (int c = 0; c < 3; ++c)
        differ += std::abs(channel_value(a, c) - b[c]) > 1e-4f * (channel_value(a, c) + 1e-3f) ? 1 : 0;
    }
    EXPECT_LT(differ, 10);
  }
}

TEST(RglWide, BatchesAreOneByOne) {
  for (const int count : {1, 3}) {
    RglWideRecipe recipe = recipe_of(std::max(count, 3), 4);
    if (count == 1) recipe.phi_o = {0}, recipe.wavelengths = {400, 500, 600, 700};
    const AnyBrdf f = table_of(recipe);
    const auto [wo, wi] = runs_of_pairs();
    const auto channels = std::size_t(f.channels());
    std::vector<float> values(channels * wo.size(), -1);
    f.eval(wo, wi, values);
    for (std::size_t i = 0; i < wo.size(); ++i) {
      Spectrum alone(f.channels());
      if (wo[i].z > 0 && wi[i].z > 0) alone = f(shading_geometry(wo[i], wi[i]));
      for (std::size_t c = 0; c < channels; ++c) EXPECT_EQ(alone[int(c)], values[i * channels + c]) << i;
    }
  }
}

TEST(RglWide, SpectraHaveTheirWavelengthsOrAColour) {
  RglWideRecipe recipe = recipe_of(3, 4);
  for (float nm = 380; nm <= 780; nm += 20) recipe.wavelengths.push_back(nm);
  recipe.vndf = [](int, int, float, float) { return 1.f; };
  recipe.jacobian = false;
  recipe.colour = [](int, int, int, float, float) { return 0.5f; };
  const Bytes grey = rgl_wide_file(recipe);
  const ShadingGeometry<float> g = shading_geometry(Direction{0, 0, 1}, Direction{0, 0, 1});
  const AnyBrdf spectrum = read_brdf(grey, "m.bsdf"), rgb = read_brdf(grey, "m.bsdf", "rgb");
  EXPECT_EQ(spectrum.channels(), 21);
  EXPECT_EQ(read_brdf(grey, "m.bsdf", "spectrum").traits().name, "m.bsdf#spectrum");
  ASSERT_EQ(rgb.channels(), 3);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb(g)[c], 0.5, 2e-3);
  recipe.colour = [](int, int, int c, float, float) { return c > 11 ? 0.5f : 0.f; };  // 620 nm and more
  const Spectrum red = read_brdf(rgl_wide_file(recipe), "m.bsdf", "rgb")(g);
  EXPECT_GT(red[0], 5 * red[1]);
  EXPECT_EQ(red[2], 0) << "outside of the colours that RGB holds";
  recipe.wavelengths.clear();
  for (int i = 0; i < 300; ++i) recipe.wavelengths.push_back(400 + float(i));
  EXPECT_EQ(read_brdf(rgl_wide_file(recipe), "m.bsdf").channels(), 3) << "more than fit";

  EXPECT_THROW(read_brdf(grey, "m.bsdf", "xyz"), Error);
  EXPECT_THROW(read_brdf(rgl_wide_file(recipe_of(3, 4)), "m.bsdf", "rgb"), Error) << "it is one material";
  const TemporaryFolder folder("rgl_wide");
  write_file_atomically(folder / "m.bsdf", grey);
  EXPECT_EQ(list_members(folder / "m.bsdf"), (std::vector<std::string>{"spectrum", "rgb"}));
}

TEST(RglWide, FactsTellTheKind) {
  RglWideRecipe recipe = recipe_of(4, 2);
  recipe.colour = [](int p, int t, int c, float, float) { return p == 1 && t == 2 && c == 0 ? -1.f : 1.f; };
  const MeasuredFacts facts = *measured_facts(rgl_wide_file(recipe), "m.bsdf");
  EXPECT_EQ(facts.kind, "RGL tensor_file of 4 azimuths, half a turn alike");
  EXPECT_EQ(facts.negative, 25U);
  EXPECT_EQ(facts.negative_at, (std::vector<std::uint64_t>{0, 0, 25, 0}));
  EXPECT_GT(facts.clipped[0], 0U);
  EXPECT_EQ(facts.clipped[1], 0U);
  recipe.phi_o = {0}, recipe.wavelengths = {400, 700};
  const Bytes spectral = rgl_wide_file(recipe);
  EXPECT_EQ(measured_facts(spectral, "m.bsdf")->kind, "RGL tensor_file, 2 wavelengths, 400 to 700 nm");
  EXPECT_EQ(measured_facts(spectral, "m.bsdf")->channels, 1);
  EXPECT_EQ(measured_facts(spectral, "m.bsdf", "rgb")->notes.size(), 1U);
}

TEST(RglWide, NamesWhatItDoesNotSupport) {
  const auto error_of = [](const std::vector<synthetic::Field>& fields) -> std::string {
    return error_words([&] { read_brdf(synthetic::tensor_file(fields), "m.bsdf"); });
  };
  const auto with = [&](std::size_t index, const synthetic::Field& field) {
    auto fields = synthetic::rgl_wide_fields(recipe_of(3, 4));
    fields[index] = field;
    return error_of(fields);
  };
  const std::string how = "; use a file of the RGL database";
  EXPECT_EQ(error_of(synthetic::rgl_wide_fields(recipe_of(3, 4))), "no error");
  EXPECT_EQ(
      with(0, synthetic::floats("phi_i", {3}, {0, 0.7f, 1.5707964f})),
      "m.bsdf: unsupported: azimuths that do not go from -pi over a turn, a half or a quarter of one" + how);
  EXPECT_EQ(with(0, synthetic::floats("phi_i", {3}, {-3, -3, 0})),
            "m.bsdf: damaged: 'phi_i' does not ascend; fetch the file again");
  EXPECT_EQ(with(0, synthetic::floats("phi_i", {4}, azimuths(4, 4))),
            "m.bsdf: damaged: field 'vndf' has an unexpected shape; fetch the file again");
  EXPECT_EQ(with(5, synthetic::floats("colours", {1}, {0})), "m.bsdf: unsupported: no field 'rgb'" + how);
  EXPECT_EQ(with(6, synthetic::floats("jacobian", {1}, {0})),
            "m.bsdf: damaged: field 'jacobian' has an unexpected shape; fetch the file again");
  RglWideRecipe two = recipe_of(3, 4);
  two.phi_o = {0, 1};
  EXPECT_EQ(error_of(synthetic::rgl_wide_fields(two)), "m.bsdf: unsupported: two azimuths that differ" + how);
  two.vndf = [](int, int, float, float) { return 1.f; };
  two.colour = [](int, int, int, float, float) { return 1.f; };
  EXPECT_EQ(error_of(synthetic::rgl_wide_fields(two)), "no error");
  RglWideRecipe falling = recipe_of(3, 4);
  falling.wavelengths = {500, 400, 600};
  EXPECT_EQ(error_of(synthetic::rgl_wide_fields(falling)),
            "m.bsdf: damaged: 'wavelengths' does not ascend; fetch the file again");
  // The typed reader of the quick table still says what it cannot hold.
  EXPECT_THROW(read_rgl(rgl_wide_file(recipe_of(3, 4)), "m.bsdf"), Error);
}

TEST(RglWide, GrazingAndOddDirectionsDoNoHarm) {
  for (const int reduction : {1, 2, 4}) {
    const RglWideTable table = table_of(recipe_of(3, reduction));
    const auto sound = [&](Direction wo, Direction wi) {
      const Spectrum f = table(shading_geometry(wo, wi));
      for (int c = 0; c < 3; ++c) EXPECT_TRUE(f[c] >= 0 && std::isfinite(f[c]));
    };
    for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF, 1e30f}) {
      for (const Direction wo : {Direction{bad, 0, 0.5f}, Direction{0, bad, 1}, Direction{bad, bad, bad}})
        sound(wo, {0, 0.6f, 0.8f}), sound({0, 0.6f, 0.8f}, wo);
    }
    for (const float z : {1e-7f, 1e-4f, 1.f}) {
      const float r = std::sqrt(1 - z * z);
      for (const Direction w :
           {Direction{r, 0, z}, Direction{-r, 0, z}, Direction{0, r, z}, Direction{0, -r, z}})
        sound(w, {0, 0, 1}), sound({0, 0, 1}, w), sound(w, {-w.x, -w.y, w.z});
    }
  }
}

}  // namespace
}  // namespace reflectree
