// SPDX-License-Identifier: Apache-2.0
// Enclosures where the azimuth of the viewer matters, and where a parameter varies: over random boxes of viewers and
// places they hold what models return, in the domains that live in the frame of the surface.
#include <gtest/gtest.h>

#include "azimuth_boxes.hpp"
#include "functions.hpp"
#include "reflectree/brdf/material/model_family.hpp"
#include "reflectree/brdf/models/all.hpp"

namespace reflectree {
namespace {

using namespace azimuth_boxes;

template <class M>
Seen compare_model(const M& model, float scale = 1) {
  return compare([&](const Box&, const auto& g) { return model(g).g; },
                 [&](const Point&, const auto& g) { return scale * model(g).g; }, 400);
}

TEST(AzimuthEnclosure, HoldsAnisotropicModels) {
  for (const float degrees : {0.f, 30.f}) {
    const Seen seen[] = {
        compare_model(Ggx{Widths(0.05f, 0.3f), {1, 0.8f, 0.3f}, degrees}),
        compare_model(Ward{{}, {0.6f, 0.6f, 0.6f}, 0.1f, 0.4f, degrees}),
        compare_model(AshikhminShirley{{}, {0.05f, 0.05f, 0.05f}, 10, 100, degrees}),
        compare_model(CookTorrance{{}, {0.8f, 0.8f, 0.8f}, {1, 1, 1}, Widths(0.1f, 0.4f), degrees}),
        compare_model(Plastic{{}, 0.04f, Widths(0.1f, 0.4f), degrees})};
    for (const Seen& s : seen) {
      EXPECT_EQ(s.missed, 0);
      EXPECT_GT(s.finite, s.boxes / 3) << "an enclosure of everything would prove nothing";
    }
  }
}
TEST(AzimuthEnclosureTwin, AnotherFunctionIsFound) {
  EXPECT_GT(compare_model(Ggx{Widths(0.05f, 0.3f)}, 1.002f).missed, 0);
  EXPECT_GT(compare_model(Ward{{}, {0.6f, 0.6f, 0.6f}, 0.1f, 0.4f}, 1.002f).missed, 0);
}

// Across the layer in which b changes its sign, for a part of the angles: what the map returns at points whose own
// angle is one of them stands in the forms. off: by which the angles are told wrongly.
struct SeenAngles {
  int points = 0, missed = 0, used = 0;
};
SeenAngles compare_angles(double off) {
  SeenAngles seen;
  Pcg32 u(29);
  const Domain domain = domain_at(0);
  const auto between = [&u](double lo, double hi) { return linear_mix(to_unit_double(u()), lo, hi); };
  for (int i = 0; i < 2000; ++i) {
    const double x = between(-0.9, 0.9), around = 0.5 * pi_v<double> * (1 - x);
    const Vec2<double> along =
        detail::Stretched<double>{double(domain.stretch)}.along({std::cos(around), std::sin(around)});
    const double across = std::atan2(along.x, -along.y);  // where b is 0
    const double z = std::exp2(between(-10, -3)), wide = 4 * z;
    Box box{{std::acos(z), x, between(0.05, 0.9), across - wide, 0}, {}};
    const double widths[] = {0.1 * z, 0.02 * z, 0.02, 2 * wide, 1};
    for (std::size_t k = 0; k < 5; ++k) box.hi[k] = box.lo[k] + widths[k];
    const double first = between(-1, 1);
    RealInterval angle{first + off, first + off + 0.2};
    const AffineForm theta = box.variable(0), phi = box.variable(3);
    const AffineForm c = widened(cos(theta), length_tolerance), s = widened(sin(theta), length_tolerance);
    DomainForms forms{domain.kind, domain.exponent, domain.stretch, AffineForm(1), AffineForm(1)};
    forms.star_angle = &angle, forms.free_variable = 5;
    const DomainPointT<AffineForm> lift =
        lift_box(forms, Vec3<AffineForm>{s * cos(phi), s * sin(phi), c}, {box.variable(1), box.variable(2)});
    if (!(angle.lo <= angle.hi)) continue;
    seen.used += lift.projected_area.log_slope[star_axis] != 0;
    for (int k = 0; k < 40; ++k) {
      Point at;
      for (std::size_t a = 0; a < 5; ++a) at[a] = between(box.lo[a], box.hi[a]);
      const double sine = std::sin(at[0]);
      const Direction wo{float(sine * std::cos(at[3])), float(sine * std::sin(at[3])),
                         float(std::cos(at[0]))};
      const Vec2<float> half = cos_sin_half(float(at[1]));
      const Vec2<float> tau = detail::Stretched<float>{domain.stretch}.along({half.y, half.x});
      const detail::SlopeStar<float> star = detail::slope_star(wo, tau);
      const double own = std::log(std::hypot(double(tau.x), double(tau.y)) * double(star.p) / double(star.c));
      if (!(own > first && own < first + 0.2)) continue;
      const DomainPoint point = lifted(domain, at);
      ++seen.points;
      seen.missed += !(lift.projected_area.range.contains(double(point.projected_area)) &&
                       lift.geometry.wi.z.range.contains(double(point.geometry.wi.z)) &&
                       lift.geometry.cos_theta_d.range.contains(double(point.geometry.cos_theta_d)));
    }
  }
  return seen;
}
TEST(StarOfBox, HoldsWhatHasItsAngles) {
  const SeenAngles seen = compare_angles(0);
  EXPECT_EQ(seen.missed, 0);
  EXPECT_GT(seen.points, 1000);
  EXPECT_GT(seen.used, 100) << "the angle must be an unknown";
}
TEST(StarOfBoxTwin, OtherAnglesAreFound) { EXPECT_GT(compare_angles(0.1).missed, 100); }

// A width that varies with the box.
Seen compare_family(double off) {
  const AnyFamily family = model_family(Ggx{}, {{"alpha", 0.01f, 1}});
  return compare([&](const Box& box, const auto& g) { return (*family.enclosure())(g, {box.variable(4)}).g; },
                 [&](const Point& at, const auto& g) { return family(g, {float(off * at[4])}).data()[1]; },
                 400);
}
TEST(FamilyEnclosure, HoldsItsMembers) {
  const Seen seen = compare_family(1);
  EXPECT_EQ(seen.missed, 0);
  EXPECT_GT(seen.finite, seen.boxes / 3);
}
TEST(FamilyEnclosureTwin, AnotherMemberIsFound) { EXPECT_GT(compare_family(1.01).missed, 0); }

TEST(FamilyEnclosure, IsMissingWhereFormulasChange) {
  EXPECT_TRUE(model_family(Ggx{Widths(0.3f, 0.1f)}, {{"alpha_y", 0.02f, 0.2f}})
                  .f.enclosure({{"alpha_y", 0.02f, 0.2f}}));
  EXPECT_FALSE(model_family(Ggx{Widths(0.3f, 0.1f)}, {{"alpha_y", 0.02f, 0.5f}})
                   .f.enclosure({{"alpha_y", 0.02f, 0.5f}}));
}

TEST(AzimuthEnclosure, SmallerBoxesGiveNarrowerForms) {
  const Ggx model{Widths(0.2f, 0.3f)};
  for (int i = 0; i < 5; ++i) {
    const auto radius_of = [&](double share) {
      Box box;
      const Point centre{0.7, 0.3, 0.4, 2, 0.3};
      for (std::size_t k = 0; k < 5; ++k) box.lo[k] = centre[k] - share, box.hi[k] = centre[k] + share;
      const DomainPointT<AffineForm> lift = lifted_box(domain_at(i), box);
      return (model(lift.geometry).g * lift.projected_area).error;
    };
    EXPECT_LT(radius_of(0.002), 0.6 * radius_of(0.004)) << i;
  }
}

}  // namespace
}  // namespace reflectree
