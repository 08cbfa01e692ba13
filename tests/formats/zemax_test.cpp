// SPDX-License-Identifier: Apache-2.0
// Zemax .bsdf files: where the table's angles lie, gaps, members, errors with their lines, and an independent
// reading of synthetic and measured files.
#include <gtest/gtest.h>

#include <algorithm>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reference_values.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/measured_facts.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

using synthetic::as_bytes;
using synthetic::zemax_file;
using synthetic::zemax_text;
using synthetic::ZemaxRecipe;

std::vector<double> steps(double first, double last, double step) {
  std::vector<double> all;
  for (double x = first; x <= last + 1e-9; x += step) all.push_back(x);
  return all;
}

AnyBrdf brdf(const ZemaxRecipe& recipe, const std::string& member = "") {
  return read_brdf(zemax_file(recipe), "m.bsdf", member);
}

float value(const AnyBrdf& f, Direction wo, Direction wi, int channel = 0) {
  return f(shading_geometry(wo, wi))[channel];
}

Direction direction(double theta, double phi) {
  const auto w = direction_from_angles(theta, phi);
  return {float(w.x), float(w.y), float(w.z)};
}

// A smooth function without any symmetry, in the surface's frame.
double smooth(Vec3<double> wo, Vec3<double> wi) {
  return 1 + 0.5 * wi.x * wo.y - 0.4 * wi.y * wi.z + 0.3 * wo.x * wi.x * wi.x + 0.2 * wo.y;
}

// The pair of a node, by turning: a sample that was turned by `rotation` under light from the side of -y,
// whose plane of incidence has the normal +x. So, in the sample's frame, wo came from -(rotation) of +y.
double smooth_at(double rotation, double incidence, double azimuth, double radial) {
  const auto turned = [rotation](Vec3<double> w) {
    const double c = std::cos(rotation), s = std::sin(rotation);
    return Vec3<double>{c * w.x + s * w.y, c * w.y - s * w.x, w.z};
  };
  const double c = std::cos(incidence), s = std::sin(incidence);
  const Vec3<double> wo{0, s, c}, mirror{0, -s, c}, up{0, c, s};
  // Counter-clockwise for somebody whom the mirror direction points at: a right-handed frame up, aside,
  // mirror.
  const Vec3<double> aside{mirror.y * up.z - mirror.z * up.y, mirror.z * up.x - mirror.x * up.z,
                           mirror.x * up.y - mirror.y * up.x};
  const Vec3<double> wi =
      std::cos(radial) * mirror + std::sin(radial) * (std::cos(azimuth) * up + std::sin(azimuth) * aside);
  return smooth(turned(wo), turned(wi));
}

// The worst difference from smooth() over random pairs above the highest and below the lowest incidence.
double worst_error(const AnyBrdf& f) {
  const Pairs pairs = random_pairs(4000, 0.5f, 3);
  double worst = 0;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Direction wo = pairs.wo[i], wi = pairs.wi[i];
    if (wo.z < 0.1f || wo.z > 0.99f) continue;
    const double wanted = smooth({wo.x, wo.y, wo.z}, {wi.x, wi.y, wi.z});
    worst = std::max(worst, std::abs(double(value(f, wo, wi)) - wanted));
  }
  return worst;
}

ZemaxRecipe fine() {
  ZemaxRecipe recipe;
  recipe.rotation = steps(0, 360, 10), recipe.incidence = steps(5, 85, 10);
  recipe.azimuth = steps(0, 360, 10), recipe.radial = steps(0, 180, 10);
  return recipe;
}

TEST(Zemax, AnglesLieWhereTheTableSays) {
  ZemaxRecipe recipe = fine();
  recipe.value = [](int, double r, double i, double a, double s) { return smooth_at(r, i, a, s); };
  EXPECT_LT(worst_error(brdf(recipe)), 0.03);
  recipe.value = [](int, double r, double i, double a, double s) { return smooth_at(-r, i, a, s); };
  EXPECT_GT(worst_error(brdf(recipe)), 0.3) << "a rotation the other way must show";
  recipe.value = [](int, double r, double i, double a, double s) { return smooth_at(r, i, -a, s); };
  EXPECT_GT(worst_error(brdf(recipe)), 0.3) << "an azimuth the other way must show";
  recipe.value = [](int, double r, double i, double a, double s) { return smooth_at(r + 0.2, i, a, s); };
  EXPECT_GT(worst_error(brdf(recipe)), 0.05) << "another zero of the rotation must show";
}

TEST(Zemax, CirclesCloseThemselvesAndMirrorsFold) {
  ZemaxRecipe recipe = fine();
  recipe.value = [](int, double r, double i, double a, double s) { return smooth_at(r, i, a, s); };
  const AnyBrdf whole = brdf(recipe);
  recipe.rotation.pop_back(), recipe.azimuth.pop_back();
  const AnyBrdf open = brdf(recipe);
  ZemaxRecipe flat = fine();
  flat.rotation = {0};
  flat.value = [](int, double, double i, double a, double s) { return 1 + std::cos(a) * std::sin(s) * i; };
  const AnyBrdf both = brdf(flat);
  flat.symmetry = "PlaneSymmetrical", flat.azimuth = steps(0, 180, 10);
  const AnyBrdf half = brdf(flat);
  const Pairs pairs = random_pairs(500, 0.5f, 4);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    EXPECT_EQ(value(whole, pairs.wo[i], pairs.wi[i]), value(open, pairs.wo[i], pairs.wi[i]));
    EXPECT_NEAR(value(both, pairs.wo[i], pairs.wi[i]), value(half, pairs.wo[i], pairs.wi[i]), 1e-5);
  }
  EXPECT_FALSE(whole.traits().isotropic);
  EXPECT_TRUE(half.traits().isotropic && half.traits().isotropic_by_formula);
  EXPECT_EQ(half.traits().theta_o_knots.size(), flat.incidence.size());
  EXPECT_EQ(half.channels(), 1);
  EXPECT_EQ(half.traits().name, "m.bsdf");
}

TEST(Zemax, BeyondTheLastNodesTheyStand) {
  ZemaxRecipe recipe;
  recipe.rotation = {0}, recipe.incidence = {30, 40}, recipe.azimuth = {0, 180}, recipe.radial = {0, 10};
  recipe.symmetry = "PlaneSymmetrical";
  recipe.value = [](int, double, double i, double, double s) { return i + s; };
  const AnyBrdf f = brdf(recipe);
  const double degree = pi_v<double> / 180;
  const auto at = [&](double theta_o, double theta_i) {  // in the plane of incidence
    return double(value(f, direction(theta_o * degree, 0), direction(theta_i * degree, pi_v<double>))) /
           degree;
  };
  EXPECT_NEAR(at(10, 10), 30, 1e-3);
  EXPECT_NEAR(at(35, 35), 35, 1e-3);
  EXPECT_NEAR(at(80, 80), 40, 1e-3);
  EXPECT_NEAR(at(35, 31), 39, 1e-3);
  EXPECT_NEAR(at(35, 5), 45, 1e-3);
}

// 1 up to 80 degrees from the normal, 0 beyond; a hole in the middle is a measured 0.
TEST(Zemax, GapsAtTheRimAreHeldAndHolesAreNot) {
  ZemaxRecipe recipe;
  recipe.rotation = {0}, recipe.incidence = {0, 40}, recipe.symmetry = "PlaneSymmetrical";
  recipe.azimuth = steps(0, 180, 15), recipe.radial = steps(0, 180, 5);
  recipe.value = [](int, double, double i, double a, double s) {
    const double z = std::cos(i) * std::cos(s) + std::sin(i) * std::sin(s) * std::cos(a);
    return z < 0.1735 || (s > 0.3 && s < 0.4) ? 0.0 : 1.0;
  };
  const AnyBrdf held = brdf(recipe), zeros = brdf(recipe, "zeros");
  double darkest = 1, darkest_of_zeros = 1;
  int holes = 0;
  const Pairs pairs = random_pairs(4000, 0.5f, 5);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Direction wo = pairs.wo[i], wi = pairs.wi[i];
    const double radial = std::acos(std::clamp(double(-wo.x * wi.x - wo.y * wi.y + wo.z * wi.z), -1.0, 1.0));
    if (radial > 0.25 && radial < 0.45) {
      holes += value(held, wo, wi) < 0.9f ? 1 : 0;
      continue;
    }
    darkest = std::min(darkest, double(value(held, wo, wi)));
    darkest_of_zeros = std::min(darkest_of_zeros, double(value(zeros, wo, wi)));
  }
  EXPECT_NEAR(darkest, 1, 1e-5);
  EXPECT_LT(darkest_of_zeros, 0.1);
  EXPECT_GT(holes, 100);
  EXPECT_EQ(held.traits().name, "m.bsdf");
  EXPECT_EQ(zeros.traits().name, "m.bsdf#zeros");

  const MeasuredFacts facts = *measured_facts(zemax_file(recipe), "m.bsdf");
  EXPECT_EQ(facts.channels, 1);
  EXPECT_GT(facts.not_measured, 0U);
  EXPECT_LT(facts.not_measured, facts.entries / 4);
  EXPECT_LT(facts.entries, 2U * 13 * 37);
  EXPECT_GT(facts.bridged[0], 0U);
  EXPECT_LT(facts.bridged[0], facts.pairs / 2);
  EXPECT_FALSE(facts.notes.empty());
  const MeasuredFacts bare = *measured_facts(zemax_file(recipe), "m.bsdf", "zeros");
  EXPECT_EQ(bare.not_measured, 0U);
  EXPECT_EQ(bare.bridged[0], 0U);
}

TEST(Zemax, NoiseIsInterpolatedAndTheValueCut) {
  ZemaxRecipe recipe;
  recipe.rotation = {0}, recipe.incidence = {0}, recipe.symmetry = "PlaneSymmetrical";
  recipe.azimuth = {0}, recipe.radial = {0, 90};
  recipe.value = [](int, double, double, double, double s) { return s > 0 ? -1 : 1; };
  const AnyBrdf f = brdf(recipe);
  const auto at = [&](double degrees) {
    return value(f, {0, 0, 1}, direction(degrees * pi_v<double> / 180, 1));
  };
  EXPECT_NEAR(at(30), 1.0 / 3, 1e-5);
  EXPECT_EQ(at(60), 0);
  const MeasuredFacts facts = *measured_facts(zemax_file(recipe), "m.bsdf");
  EXPECT_EQ(facts.negative, 0U) << "the node at the horizon is no direction of reflection";
  EXPECT_GT(facts.clipped[0], 0U);
}

// The integral of f cos_i by a lattice, equal shares of the disk.
double lattice_albedo(const AnyBrdf& f, Direction wo) {
  constexpr int rings = 300, sectors = 480;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double theta = std::asin(std::sqrt((i + 0.5) / rings));
    for (int k = 0; k < sectors; ++k)
      sum += double(value(f, wo, direction(theta, 2 * pi_v<double> * (k + 0.5) / sectors)));
  }
  return pi_v<double> * sum / (rings * sectors);
}
double worst_told(const AnyBrdf& f, const AnyBrdf& teller) {
  double worst = 0;
  for (const double theta : {0.1, 0.6, 1.2, 1.5}) {
    for (const double phi : {0.3, 2.5, 4.}) {
      const Direction wo = direction(theta, phi);
      worst = std::max(worst, std::abs(teller.traits().albedo(wo) / lattice_albedo(f, wo) - 1));
    }
  }
  return worst;
}
TEST(Zemax, SeveralRotationsTellTheirAlbedo) {
  ZemaxRecipe recipe;
  const AnyBrdf whole = brdf(recipe);
  EXPECT_LT(worst_told(whole, whole), 2e-4);
  // Nodes that begin late, and azimuths of half a circle.
  recipe.symmetry = "PlaneSymmetrical", recipe.azimuth = {0, 45, 180}, recipe.radial = {10, 35, 80};
  const AnyBrdf half = brdf(recipe);
  EXPECT_LT(worst_told(half, half), 2e-4);
}
TEST(Zemax, NobodyTellsWhatIsCutOrKnownAnyway) {
  ZemaxRecipe recipe;
  recipe.value = [](int, double, double, double, double s) { return s > 1 ? -0.01 : 1; };
  EXPECT_FALSE(brdf(recipe).traits().albedo) << "values are cut at 0";
  recipe.rotation = {0};
  recipe.value = ZemaxRecipe{}.value;
  EXPECT_FALSE(brdf(recipe).traits().albedo) << "isotropic";
}
// The judge can fail: the albedo of a file with other entries.
TEST(ZemaxTwin, AnAlbedoOfAnotherFile) {
  ZemaxRecipe other;
  other.value = [](int c, double r, double i, double a, double s) {
    return ZemaxRecipe{}.value(c, r, i, a, s) * (s > 1 ? 1.01 : 1);
  };
  EXPECT_GT(worst_told(brdf({}), brdf(other)), 1e-3);
}

TEST(Zemax, ThreeCurvesAreOneColourOrThreeFiles) {
  ZemaxRecipe recipe;
  recipe.content = "XYZ";
  const double white[] = {0.95047, 1, 1.08883};  // D65
  recipe.value = [&](int c, double, double, double, double) { return 0.4 * white[c]; };
  const Bytes bytes = zemax_file(recipe);
  const AnyBrdf rgb = read_brdf(bytes, "m.bsdf");
  ASSERT_EQ(rgb.channels(), 3);
  const Direction wo = direction(0.7, 1), wi = direction(0.3, 2);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value(rgb, wo, wi, c), 0.4, 1e-4);
  const char* names[] = {"x", "y", "z"};
  for (int c = 0; c < 3; ++c) {
    const AnyBrdf one = read_brdf(bytes, "m.bsdf", names[c]);
    EXPECT_EQ(one.channels(), 1);
    EXPECT_NEAR(value(one, wo, wi), 0.4 * white[c], 1e-6);
  }
  EXPECT_EQ(read_brdf(bytes, "m.bsdf", "x-zeros").traits().name, "m.bsdf#x-zeros");
  EXPECT_THROW(read_brdf(bytes, "m.bsdf", "held"), Error);
  EXPECT_THROW(read_brdf(zemax_file(), "m.bsdf", "x"), Error);
}

std::string error_of(const std::string& text) {
  return error_words([&] { read_brdf(as_bytes(text), "m.bsdf"); });
}

std::string flat_text() {
  ZemaxRecipe recipe;
  recipe.value = [](int, double, double, double, double) { return 0.25; };
  return zemax_text(recipe);
}

// The file with one text replaced by another, once.
std::string with(const std::string& from, const std::string& to, std::string text = flat_text()) {
  const std::size_t at = text.find(from);
  if (at == text.npos) throw std::runtime_error("the file has no " + from);
  return text.replace(at, from.size(), to);
}

TEST(Zemax, ErrorsNameTheLine) {
  const std::string mend = "; mend the line or fetch the file again";
  EXPECT_EQ(error_of(flat_text()), "no error");
  EXPECT_EQ(error_of(with("BRDF", "BTDF")),
            "m.bsdf: a BTDF: light that passes through is not sampled; name a file of a BRDF");
  EXPECT_EQ(error_of(with("Asymmetrical4D", "Cubic")),
            "m.bsdf: line 3: symmetry 'Cubic' is not known" + mend);
  EXPECT_EQ(error_of(with("Monochrome", "Sepia")),
            "m.bsdf: line 4: spectral content 'Sepia' is not known" + mend);
  EXPECT_EQ(error_of(with("AngleOfIncidence\t2", "AngleOfIncidence\t-2")),
            "m.bsdf: line 8: not a count of angles" + mend);
  EXPECT_EQ(error_of(with("AngleOfIncidence\t2", "AngleOfIncidence\t3")),
            "m.bsdf: line 10: 'ScatterAzimuth' is not a finite number" + mend);
  EXPECT_EQ(error_of(with("AngleOfIncidence\t2", "AngleOfIncidence\t1")),
            "m.bsdf: line 9: '50' follows what the line should hold" + mend);
  EXPECT_EQ(error_of(with("10\t50", "50\t10")), "m.bsdf: line 9: angles that do not ascend" + mend);
  EXPECT_EQ(error_of(with("10\t50", "10\t91")), "m.bsdf: line 9: an angle out of range" + mend);
  EXPECT_EQ(error_of(with("ScatterRadial", "Radial")), "m.bsdf: line 12: 'Radial' is not known" + mend);
  EXPECT_EQ(error_of(with("ScatterType BRDF\r\n", "")),
            "m.bsdf: line 14: the data begins without ScatterType" + mend);
  EXPECT_EQ(error_of(with("TIS", "TIR")), "m.bsdf: line 17: 'TIR' where TIS should stand" + mend);
  EXPECT_EQ(error_of(with("TIS\t0.5", "TIS\t0.5 7")),
            "m.bsdf: line 17: '7' follows what the line should hold" + mend);
  EXPECT_EQ(error_of(with("0.25\t0.25", "0.25")), "m.bsdf: line 18: fewer values than radial angles" + mend);
  EXPECT_EQ(error_of(with("0.25\t0.25", "0.25\t0.25\t0.5")),
            "m.bsdf: line 18: '0.25' follows what the line should hold" + mend);
  EXPECT_EQ(error_of(with("0.25\t0.25", "0.25\tnan")),
            "m.bsdf: line 18: 'nan' is not a finite number" + mend);
  EXPECT_EQ(error_of(with("0.25\t0.25", "0.25\t1e20")), "m.bsdf: line 18: an impossible value" + mend);
  EXPECT_EQ(error_of(with("DataEnd", "Monochrome")),
            "m.bsdf: line 65: 'Monochrome' where DataEnd should stand" + mend);
  EXPECT_EQ(error_of(with("DataEnd", "")),
            "m.bsdf: line 65: the file ends where DataEnd should follow" + mend);
  EXPECT_EQ(error_of(flat_text() + "x"), "m.bsdf: line 66: something follows the data" + mend);
  ZemaxRecipe quarter;
  quarter.rotation = {0, 30, 60, 90};
  EXPECT_EQ(error_of(zemax_text(quarter)),
            "m.bsdf: SampleRotation does not go round; give angles from 0 to 360");
  quarter.rotation = {0}, quarter.azimuth = {0, 30, 60, 90};
  EXPECT_EQ(error_of(zemax_text(quarter)),
            "m.bsdf: ScatterAzimuth does not go round; give angles from 0 to 360");
}

// |f - reference| / (|reference| + 1e-4), sorted.
std::vector<double> errors(const AnyBrdf& f, const Pairs& pairs, const std::vector<double>& reference) {
  std::vector<double> all;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    all.push_back(std::abs(double(value(f, pairs.wo[i], pairs.wi[i])) - reference[i]) /
                  (reference[i] + 1e-4));
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Zemax, SyntheticFileAgreesWithAnIndependentReading) {
  const TemporaryFolder folder("zemax");
  ZemaxRecipe recipe = fine();
  std::mt19937 bits(9);
  recipe.value = [&bits](int, double, double, double, double s) {
    return s > 1.4 || bits() % 9 == 0 ? 0.0 : double(bits() % 1000) / 1000;
  };
  write_file_atomically(folder / "m.bsdf", zemax_file(recipe));
  const Pairs pairs = random_pairs(3000, 0.3f, 7);
  for (const bool zeros : {false, true}) {
    const std::vector<double> reference =
        reference_values("zemax_reference.py", {folder / "m.bsdf"}, pairs,
                         zeros ? std::vector<std::string>{"zeros"} : std::vector<std::string>{});
    const auto sorted = errors(load_brdf(folder / "m.bsdf", zeros ? "zeros" : ""), pairs, reference);
    EXPECT_LT(sorted[sorted.size() * 99 / 100], 1e-4);
    EXPECT_LT(sorted.back(), 1e-2);
    EXPECT_GT(errors(load_brdf(folder / "m.bsdf", zeros ? "" : "zeros"), pairs, reference).back(), 0.1)
        << "the other way must show";
  }
}

TEST(Zemax, MeasuredFilesAgreeWithAnIndependentReading) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  const Pairs pairs = random_pairs(3000, 0.3f, 8);
  int read = 0, refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(measured_data() + "/zemax")) {
    const std::string file = entry.path().string();
    if (file.find("btdf") != file.npos) {
      EXPECT_THROW(load_brdf(file), Error);
      ++refused;
      continue;
    }
    const auto sorted = errors(load_brdf(file), pairs, reference_values("zemax_reference.py", {file}, pairs));
    EXPECT_LT(sorted[sorted.size() * 99 / 100], 1e-4) << file;
    EXPECT_LT(sorted.back(), 1e-2) << file;
    ++read;
  }
  EXPECT_EQ(read, 5);
  EXPECT_EQ(refused, 1);
}

TEST(Zemax, FactsOfTheAnisotropicSample) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  const std::string file = measured_data() + "/zemax/IMX455.bsdf";
  const MeasuredFacts facts = *measured_facts(read_file(file, 1U << 24U), file);
  EXPECT_EQ(facts.kind, "Zemax BSDF of 37 rotations, 4 incidences, 37 azimuths and 21 radial angles");
  EXPECT_EQ(facts.entries, 63196U);
  EXPECT_EQ(facts.not_measured, 6993U);
  EXPECT_EQ(facts.negative, 0U);
  EXPECT_EQ(facts.theta_o.size(), 4U);
  EXPECT_FALSE(load_brdf(file).traits().isotropic);
}

}  // namespace
}  // namespace reflectree
