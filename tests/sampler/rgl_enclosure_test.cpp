// SPDX-License-Identifier: Apache-2.0
// The enclosure of RGL tables where proofs used to stay open: about the mirror
// direction and the normal, where the azimuth of the half vector may be any, at
// the rim, and where directions cancel at grazing; with rows of the warp in
// which nothing is visible. All data is random.
#include <gtest/gtest.h>

#include <cmath>

#include "random_boxes.hpp"
#include "random_rgl.hpp"

namespace reflectree {
namespace {

// `bright`: of one node of the colours in five; `visible`: of one row of the warp in five.
AnyBrdf random_table(Pcg32& bits, float bright = 0, float visible = 1, bool steep = false) {
  RglFields f = random_rgl_fields(bits, {{0.f, 0.4f, 1.1f, 1.5707964f}, 24, 48, 8, 9}, 0.2);
  for (std::size_t row = 0; row < 4 * 48; ++row) {
    const float scale = row / 48 == 3 && row % 48 > 30 ? 0.f : row % 5 == 0 ? visible : 1.f;
    for (std::size_t i = 0; i < 24; ++i) f.vndf[24 * row + i] *= scale * (row % 7 == 0 && i < 12 ? 0.f : 1.f);
  }
  for (std::size_t i = 0; i < f.rgb.size(); ++i) {
    if (steep) f.rgb[i] = 0.2f + 0.7f * float(i % 8);
    if (i % 5 == 0) f.rgb[i] += bright;
  }
  return RglTable(f);
}

// About a place where wh may be the normal, or at the rim, and of any width along each axis.
Box hard_box(Pcg32& bits, const Domain& domain) {
  constexpr double most[] = {1.5707, 1, 1}, least[] = {0, -1, 0};
  std::array<double, 3> centre{most[0] * std::sqrt(uniform(bits)), -1, 1};
  const double choice = uniform(bits);
  if (choice < 0.2) centre[0] = 0, centre[2] = 0;
  if (choice > 0.8) centre[0] = most[0];
  if (choice > 0.4 && domain.kind == DomainKind::equal_area) centre[2] = 1 - std::cos(centre[0]);
  if (choice > 0.4 && domain.kind == DomainKind::projected_disk) centre[2] = std::pow(std::sin(centre[0]), 2);
  if (domain.kind == DomainKind::half_vector || choice < 0.3) centre[1] = 2 * uniform(bits) - 1;
  if (domain.kind == DomainKind::half_vector && choice < 0.6) centre[2] = 0;
  Box box;
  for (std::size_t k = 0; k < 3; ++k) {
    const double width = 0.2 * std::pow(2., -14 * uniform(bits)), at = uniform(bits);
    volatile float from = float(std::max(centre[k] - at * width, least[k]));
    volatile float to = float(std::min(centre[k] + (1 - at) * width, most[k]));
    box.lo[k] = double(from), box.hi[k] = std::max(double(to), double(from) + 1e-6);
    if (box.hi[k] > most[k]) box.lo[k] -= 1e-6, box.hi[k] -= 1e-6;
  }
  return box;
}

struct Bound {
  AffineForm form;
  double largest = 0;  // of the values that were looked at
  std::size_t missed = 0;
};
Bound look(const AnyBrdf& told, const AnyBrdf& f, const Domain& domain, const Box& box, bool mirrored,
           Pcg32& bits, int points) {
  const BrdfEnclosure& enclosure = *told.traits().enclosure;
  const DomainPointT<AffineForm> lift_of = lifted_box(domain, box);
  const ShadingGeometry<AffineForm> g = mirrored ? mirrored_in_plane(lift_of.geometry) : lift_of.geometry;
  Bound out;
  out.form = lift_of.area_by_cosine ? widened(enclosure.times_cosine(g)->g * *lift_of.area_by_cosine, 0x1p-19)
                                    : enclosure(g).g * lift_of.projected_area;
  for (int k = 0; k < points; ++k) {
    std::array<double, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      volatile float place = float(box.at(a, k % 3 ? uniform(bits) : double(bits() & 1U)));
      at[a] = std::clamp(double(place), box.lo[a], box.hi[a]);
    }
    const Direction wo{float(std::sin(at[0])), 0, float(std::cos(at[0]))};
    const DomainPoint point = lift(domain, wo, {float(at[1]), float(at[2])}, mirrored);
    const auto value = double(f(point.geometry)[1] * point.projected_area);
    out.missed += !holds(out.form, box, at, value), out.largest = std::max(out.largest, value);
  }
  return out;
}

constexpr DomainKind hard_kinds[] = {DomainKind::equal_area, DomainKind::projected_disk,
                                     DomainKind::half_vector, DomainKind::equal_area};

std::size_t missed(float bright, float visible, int tables, int boxes) {
  std::size_t missed = 0;
  for (std::uint64_t seed = 0; seed < std::uint64_t(tables); ++seed) {
    Pcg32 bits(seed), same(seed);
    const AnyBrdf told = random_table(bits), f = random_table(same, bright, visible);
    for (int i = 0; i < boxes; ++i) {
      const Domain domain{hard_kinds[std::size_t(i) % std::size(hard_kinds)], Symmetry::mirror, 1.5f};
      const Box box = hard_box(bits, domain);
      missed += look(told, f, domain, box, i % 2 == 0, bits, 9).missed;
    }
  }
  return missed;
}
TEST(RglEnclosure, HoldsItsValuesAtHardPlaces) { EXPECT_EQ(missed(0, 1, 8, 1000), 0U); }
TEST(RglEnclosureTwin, AnotherTableIsFoundThere) {
  EXPECT_GT(missed(0.01f, 1, 1, 1000), 0U);
  EXPECT_GT(missed(-0.01f, 1, 1, 1000), 0U);
  EXPECT_GT(missed(0, 1.02f, 1, 1000), 0U) << "a row of the warp";
}

// A half is known no less well than the whole: where it was not, the search never halved what is wide.
TEST(RglEnclosure, HalvesAboutTheMirrorDirectionAreNoWorse) {
  Pcg32 bits(3);
  const AnyBrdf f = random_table(bits, 0, 1, true);
  const Domain domain{DomainKind::equal_area, Symmetry::mirror, 1.5f};
  int looked = 0, worse = 0;
  for (int i = 0; i < 4000; ++i) {
    Box box = hard_box(bits, domain);
    const Bound whole = look(f, f, domain, box, false, bits, 0);
    const std::size_t axis = i % 3;
    (i % 2 ? box.lo : box.hi)[axis] = 0.5 * (box.lo[axis] + box.hi[axis]);
    ++looked, worse += look(f, f, domain, box, false, bits, 0).form.range.hi > 1.02 * whole.form.range.hi;
  }
  EXPECT_GT(looked, 1000);
  EXPECT_EQ(worse, 0);
}

// Beside it the bound is close to the values, though the azimuth of wh spans many rows.
TEST(RglEnclosure, IsSharpAboutTheMirrorDirection) {
  Pcg32 bits(4);
  const AnyBrdf f = random_table(bits, 0, 1, true);
  const Domain domain{DomainKind::equal_area, Symmetry::mirror, 1.5f};
  for (int i = 0; i < 200; ++i) {
    const double theta = 0.1 + 1.3 * uniform(bits), width = 0.01 * std::pow(2., -8 * uniform(bits));
    const double y = 1 - std::cos(theta) + (1 - 2 * (i % 2)) * width;
    const Box box{{theta, -1, y}, {theta + 0.1 * width, -1 + 8 * width, y + 0.1 * width}};
    const Bound b = look(f, f, domain, box, false, bits, 300);
    EXPECT_LT(b.form.range.hi, 4 * b.largest) << theta << " " << width;
  }
}

// The cosine of cos_sin_half, by every way in which a compiler may fuse products and sums.
float fused_or_not(bool fused, float a, float b, float c) {
  if (fused) return std::fma(a, b, c);
  volatile float product = a * b;
  return product + c;
}
float cosine_by(int ways, float x) {
  const auto step = [ways](int k, float a, float b, float c) {
    return fused_or_not((ways >> k & 1) != 0, a, b, c);
  };
  const float h = 0.5f * x, s = h * h, s2 = s * s;
  const float high = step(2, -s, 0.0243967166f, 0.234937559f), middle = step(1, -s, 1.33521206f, 4.05870916f);
  return step(4, s2, step(3, s2, high, middle), step(0, -s, 4.93480214f, 1.f));
}
TEST(CosineOfHalf, IsWhatTheProofAssumesNearItsEnd) {
  double least = 1, worst = 0;
  bool is_ours = false;
  for (float x = 1; x > 1 - 0x1p-11f; x = std::nextafter(x, 0.f)) {
    for (int ways = 0; ways < 32; ++ways) {
      const auto value = double(cosine_by(ways, x));
      least = std::min(least, value),
      worst = std::max(worst, std::abs(value - std::cos(0.5 * pi_v<double> * double(x))));
    }
    is_ours = is_ours || cos_sin_half(x).x == cosine_by(0, x);
  }
  EXPECT_TRUE(is_ours);
  EXPECT_GE(least, least_cosine_of_half);
  EXPECT_LT(worst, 2e-7);
  EXPECT_LT(least, 4 * least_cosine_of_half) << "no more can be assumed";
  EXPECT_GT(worst, 1e-7);
}

}  // namespace
}  // namespace reflectree
