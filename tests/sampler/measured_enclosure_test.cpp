// SPDX-License-Identifier: Apache-2.0
// The contract of enclosures of networks and measured tables: over random boxes of viewers and places they hold what
// the function returns, on both sides of the plane of wo; sharper boxes give sharper bounds. All data is random.
#include <gtest/gtest.h>

#include "random_boxes.hpp"
#include "random_rgl.hpp"
#include "reflectree/brdf/models/neural_brdf.hpp"
#include "reflectree/brdf/tables/klems_table.hpp"
#include "reflectree/brdf/tables/specular_table.hpp"

namespace reflectree {
namespace {

struct Network {
  static AnyBrdf random(Pcg32& bits) {
    std::array<float, NeuralBrdf::weight_count> weights;
    for (float& w : weights) w = float(0.9 * uniform(bits) - 0.4);
    for (std::size_t k = 1; k <= 3; ++k) weights[weights.size() - k] = 1.5f;  // mostly positive
    return NeuralBrdf("network", weights);
  }
};

// Noise, some of it negative; `bright`: of one node of the colours.
struct Rgl {
  static AnyBrdf random(Pcg32& bits, float bright = 0) {
    RglFields f = random_rgl_fields(bits, {{0.f, 0.5f, 1.1f, 1.5707964f}, 9, 13, 6, 7}, -0.1);
    for (std::size_t i = 0; i < f.rgb.size(); i += 5) f.rgb[i] += bright;
    return RglTable(f);
  }
};

struct Klems {
  static KlemsTable table(Pcg32& bits, bool seen_through) {
    KlemsTable t;
    t.incident = KlemsBasis({0, 0.2, 0.7, 1.2, 0.5 * pi_v<double>}, {1, 4, 8, 6});
    t.exiting = KlemsBasis({0, 0.3, 0.8, 1.5}, {1, 8, 12});
    t.seen_through = seen_through;
    for (int i = 0; i < t.incident.size() * t.exiting.size(); ++i) t.values.push_back(float(uniform(bits)));
    return t;
  }
  static AnyBrdf random(Pcg32& bits) { return table(bits, (bits() & 1U) != 0); }
};
struct Specular {
  static AnyBrdf random(Pcg32& bits) {
    SpecularTable<float> t;
    t.axes.mirrored = (bits() & 1U) != 0;
    t.axes.rotation = {0}, t.axes.theta_o = {0.f, 0.6f, 1.3f}, t.axes.radial = {0.f, 0.1f, 0.4f, 1.f, 2.2f};
    t.axes.azimuth = {0.f, 1.f, 2.f, pi};
    if (!t.axes.mirrored) t.axes.azimuth = {0.f, 1.f, 2.f, pi, 5.f, 2 * pi};
    for (std::size_t i = 0; i < t.axes.size(); ++i) t.values.push_back(float(1.1 * uniform(bits) - 0.1));
    return t;
  }
};

struct Seen {
  std::size_t boxes = 0, missed = 0, finite = 0;
};

// What f returns, held against what the enclosure of `told` says.
Seen compare(const AnyBrdf& told, const AnyBrdf& f, Pcg32& bits, int boxes) {
  const BrdfEnclosure& enclosure = *told.traits().enclosure;
  Seen seen;
  for (int i = 0; i < boxes; ++i) {
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const Box box = random_box(bits);
    const bool mirrored = (bits() & 1U) != 0;
    const DomainPointT<AffineForm> lift_of = lifted_box(domain, box);
    const ShadingGeometry<AffineForm> g = mirrored ? mirrored_in_plane(lift_of.geometry) : lift_of.geometry;
    std::vector<AffineForm> forms{enclosure(g).g * lift_of.projected_area};
    if (lift_of.area_by_cosine) {
      if (const auto f_cos = enclosure.times_cosine(g))
        forms.push_back(widened(f_cos->g * *lift_of.area_by_cosine, 0x1p-19));
    }
    ++seen.boxes, seen.finite += forms.back().error < detail::infinity;
    for (int k = 0; k < 8; ++k) {
      std::array<double, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) {
        volatile float place = float(box.at(a, k < 5 ? uniform(bits) : double(bits() & 1U)));
        at[a] = std::clamp(double(place), box.lo[a], box.hi[a]);
      }
      const Direction wo{float(std::sin(at[0])), 0, float(std::cos(at[0]))};
      const DomainPoint point = lift(domain, wo, {float(at[1]), float(at[2])}, mirrored);
      const auto value = double(f(point.geometry)[f.channels() > 1 ? 1 : 0] * point.projected_area);
      for (const AffineForm& form : forms) seen.missed += !holds(form, box, at, value);
    }
  }
  return seen;
}

template <class F>
class MeasuredEnclosure : public testing::Test {};
using Functions = testing::Types<Network, Rgl, Klems, Specular>;
TYPED_TEST_SUITE(MeasuredEnclosure, Functions);

TYPED_TEST(MeasuredEnclosure, HoldsItsValues) {
  Pcg32 bits(5);
  std::size_t finite = 0, boxes = 0;
  for (int i = 0; i < 20; ++i) {
    const AnyBrdf f = TypeParam::random(bits);
    const Seen seen = compare(f, f, bits, 140);
    EXPECT_EQ(seen.missed, 0U);
    finite += seen.finite, boxes += seen.boxes;
  }
  EXPECT_GT(finite, boxes / 2) << "an enclosure of everything would prove nothing";
}

// The twin: weights or entries that differ a little.
TEST(MeasuredEnclosureTwin, AnotherTableIsFound) {
  for (const float bright : {-0.01f, 0.01f}) {
    Pcg32 bits(5), same(5);
    const AnyBrdf f = Rgl::random(bits), other = Rgl::random(same, bright);
    EXPECT_GT(compare(f, other, bits, 700).missed, 0U) << bright;
  }
}
TEST(MeasuredEnclosureTwin, AnotherNetworkIsFound) {
  Pcg32 bits(5), same(5);
  std::array<float, NeuralBrdf::weight_count> weights;
  for (float& w : weights) w = float(0.9 * uniform(same) - 0.4);
  for (std::size_t k = 1; k <= 3; ++k) weights[weights.size() - k] = 1.503f;
  EXPECT_GT(compare(Network::random(bits), NeuralBrdf("other", weights), bits, 700).missed, 0U);
}

TEST(MeasuredEnclosureTwin, AnotherValueOfAPatchIsFound) {
  Pcg32 bits(5);
  KlemsTable told = Klems::table(bits, false), other = told;
  for (float& v : other.values) v *= 1.001f;
  EXPECT_GT(compare(told, other, bits, 700).missed, 0U);
}

// For viewers of any azimuth: patches of a box hold those of its points; a basis turned by a third of a patch is found.
std::size_t missed_patches(double turn) {
  Pcg32 bits(7);
  const KlemsBasis basis({0, 0.3, 0.8, 1.5}, {1, 8, 12});
  std::size_t missed = 0;
  for (int i = 0; i < 4000; ++i) {
    const Direction w = random_direction(bits);
    const double width = std::pow(2., -1 - 12 * uniform(bits));
    std::array<double, 3> lo{double(w.x), double(w.y), double(w.z)};
    Vec3<AffineForm> box;
    AffineForm* const forms[] = {&box.x, &box.y, &box.z};
    for (std::size_t k = 0; k < 3; ++k) *forms[k] = AffineForm::variable(k, lo[k], lo[k] + width);
    const KlemsBasis::Touched touched = basis.patches_of(box);
    for (int k = 0; k < 8; ++k) {
      const double x = lo[0] + width * uniform(bits), y = lo[1] + width * uniform(bits);
      const double c = std::cos(turn), s = std::sin(turn);
      const int patch =
          basis.patch_of({float(c * x - s * y), float(s * x + c * y),
                          std::min(float(lo[2] + width * uniform(bits)), float(lo[2] + width))});
      const auto& all = touched.patches;
      missed += patch < 0 ? !touched.beyond : std::find(all.begin(), all.end(), patch) == all.end();
    }
  }
  return missed;
}
TEST(KlemsPatches, OfABoxHoldThoseOfItsPoints) { EXPECT_EQ(missed_patches(0), 0U); }
TEST(KlemsPatchesTwin, ATurnedBasisIsFound) { EXPECT_GT(missed_patches(0.2), 100U); }

TYPED_TEST(MeasuredEnclosure, SharperBoxesGiveSharperBounds) {
  if (std::is_same_v<TypeParam, Klems>) return;  // as sharp as they can be, but for steps
  Pcg32 bits(6);
  const AnyBrdf f = TypeParam::random(bits);
  int looked = 0, sharper = 0;
  for (int i = 0; i < 200; ++i) {
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const auto width_of = [&](double share) {
      Box box;
      const std::array<double, 3> centre{0.7, 0.3, 0.4};
      for (std::size_t k = 0; k < 3; ++k) box.lo[k] = centre[k] - share, box.hi[k] = centre[k] + share;
      const DomainPointT<AffineForm> at = lifted_box(domain, box);
      const RealInterval range = ((*f.traits().enclosure)(at.geometry).g * at.projected_area).range;
      return range.hi - range.lo;
    };
    const double share = 0.02 * std::pow(0.5, uniform(bits));
    const double wide = width_of(share), narrow = width_of(share / 2);
    if (!(wide > 1e-4)) continue;  // the roundings of floats are left
    ++looked, sharper += narrow < 0.75 * wide;
  }
  EXPECT_GT(looked, 100);
  EXPECT_EQ(sharper, looked);
}

}  // namespace
}  // namespace reflectree
