// SPDX-License-Identifier: Apache-2.0
// The contract of every model's enclosure: over random boxes of viewers and places in the square of any domain
// it holds what the model returns, in float and in double; sharper boxes give sharper bounds. A model joins by
// the line that registers it.
#include <gtest/gtest.h>

#include "random_boxes.hpp"

namespace reflectree {
namespace {

template <class M>
struct Seen {
  std::size_t boxes = 0, missed = 0, finite = 0;
};

// f: a callable that is held against the enclosure of `model`.
template <class M, class F>
Seen<M> compare(const M& model, const F& f, Pcg32& bits, int boxes) {
  Seen<M> seen;
  for (int i = 0; i < boxes; ++i) {
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const Box box = random_box(bits);
    const DomainPointT<AffineForm> lift = lifted_box(domain, box);
    const AffineForm form = model(lift.geometry).g * lift.projected_area;
    ++seen.boxes, seen.finite += form.error < detail::infinity;
    for (int k = 0; k < 6; ++k) {
      std::array<double, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) {
        volatile float place = float(box.at(a, k < 4 ? uniform(bits) : double(bits() & 1U)));
        at[a] = std::clamp(double(place), box.lo[a], box.hi[a]);
      }
      const auto point =
          lifted(domain, float(std::sin(at[0])), float(std::cos(at[0])), float(at[1]), float(at[2]));
      if (!holds(form, box, at, double(f(point.geometry).g * point.projected_area))) ++seen.missed;
    }
  }
  return seen;
}

template <class M>
class ModelEnclosure : public testing::Test {};
TYPED_TEST_SUITE(ModelEnclosure, AllModels::as<testing::Types>);

TYPED_TEST(ModelEnclosure, HoldsItsValues) {
  Pcg32 bits(5);
  std::size_t finite = 0, boxes = 0;
  for (int i = 0; i < 60; ++i) {
    const TypeParam model = i == 0 ? TypeParam() : random_model<TypeParam>(bits);
    const auto seen = compare(model, model, bits, 35);
    EXPECT_EQ(seen.missed, 0U) << model.traits().name;
    finite += seen.finite, boxes += seen.boxes;
  }
  EXPECT_GT(finite, boxes / 2) << "an enclosure of everything would prove nothing";
}

// The twin: a model that differs from the one that was enclosed by two thousandths, in the lobe or all over.
TYPED_TEST(ModelEnclosure, TwinOfAnotherFunctionIsFound) {
  Pcg32 bits(5);
  const TypeParam model;
  const auto brighter = [&](const ShadingGeometry<float>& g) { return 1.002f * model(g); };
  EXPECT_GT(compare(model, brighter, bits, 700).missed, 0U);
}

// To the last bit, where it is isotropic: the proof looks at one side.
TYPED_TEST(ModelEnclosure, IsMirrorSymmetric) {
  Pcg32 bits(8);
  for (int i = 0; i < 2000; ++i) {
    const TypeParam model = i == 0 ? TypeParam() : random_model<TypeParam>(bits);
    if (!model.traits().isotropic_by_formula) continue;
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const float theta = float(1.57 * uniform(bits)), x = float(2 * uniform(bits) - 1),
                y = float(uniform(bits));
    const Direction wo{std::sin(theta), 0, std::cos(theta)};
    EXPECT_EQ(model(lift(domain, wo, {x, y}, false).geometry),
              model(lift(domain, wo, {x, y}, true).geometry));
  }
}

TYPED_TEST(ModelEnclosure, SharperBoxesGiveSharperBounds) {
  Pcg32 bits(6);
  const TypeParam model;
  int looked = 0, sharper = 0;
  for (int i = 0; i < 200; ++i) {
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const auto radius_of = [&](double share) {
      Box box;
      const std::array<double, 3> centre{0.7, 0.3, 0.4};
      for (std::size_t k = 0; k < 3; ++k) box.lo[k] = centre[k] - share, box.hi[k] = centre[k] + share;
      const DomainPointT<AffineForm> lift = lifted_box(domain, box);
      return (model(lift.geometry).g * lift.projected_area).error;
    };
    const double share = 0.004 * std::pow(0.5, uniform(bits));
    const double wide = radius_of(share), narrow = radius_of(share / 2);
    if (!(wide > 1e-5)) continue;  // the roundings of floats are left
    ++looked, sharper += narrow < 0.6 * wide;
  }
  EXPECT_EQ(sharper, looked);
}

// Boxes where wo and wi graze and nearly cancel, or where wi comes back: their half vectors are small differences.
Box grazing_box(DomainKind kind, Pcg32& bits) {
  const auto tiny = [&] { return std::pow(2., -16 * uniform(bits)); };
  Box box;
  // Distances from grazing, from x = -1 or 0 and from the rim or the pole.
  const double c = std::max(tiny(), 1e-5), width = 0.3 * tiny();
  const double theta = std::acos(c);
  box.lo[0] = theta - width * c, box.hi[0] = std::min(theta + width * c, std::acos(double(0x1p-17)));
  const bool directions = kind == DomainKind::equal_area || kind == DomainKind::projected_disk;
  const double from_x = tiny(), from_y = tiny();
  box.lo[1] = directions ? -1 + from_x : from_x * (uniform(bits) < 0.5 ? -1 : 1);
  box.lo[2] = directions ? 1 - from_y : from_y;
  const auto wide = [&](double from) { return std::max(width * from, 0x1p-21); };
  box.hi[1] = std::min(box.lo[1] + wide(from_x), 1.), box.hi[2] = std::min(box.lo[2] + wide(from_y), 1.);
  box.lo[1] = std::min(box.lo[1], 1 - 0x1p-21), box.lo[2] = std::min(box.lo[2], 1 - 0x1p-21);
  for (std::size_t k = 1; k < 3; ++k) {
    volatile float lo = float(box.lo[k]), hi = float(box.hi[k]);
    box.lo[k] = double(lo), box.hi[k] = double(hi);
  }
  return box;
}

// Values of the geometry that forms, changed by `tamper`, do not hold; viewers are as long as they may be.
template <class Tamper>
std::size_t missed_geometries(int boxes, const Tamper& tamper) {
  constexpr DomainKind grazing_kinds[] = {DomainKind::equal_area, DomainKind::projected_disk,
                                          DomainKind::back_vector, DomainKind::half_vector,
                                          DomainKind::mirror_vector};
  Pcg32 bits(11);
  std::size_t missed = 0;
  for (int i = 0; i < boxes; ++i) {
    const Domain domain{grazing_kinds[std::size_t(i) % std::size(grazing_kinds)], Symmetry::mirror, 1.5f};
    const Box box = grazing_box(domain.kind, bits);
    const auto of = [](const auto& g) {
      const auto back = back_geometry(g);
      return std::array{g.wh.x,    g.wh.y,    g.wh.z,    g.cos_theta_d,
                        back.wh.x, back.wh.y, back.wh.z, back.cos_theta_d};
    };
    const auto forms = of(lifted_box(domain, box).geometry);
    for (int k = 0; k < 6; ++k) {
      std::array<double, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) {
        volatile float place = float(box.at(a, k < 3 ? uniform(bits) : double(bits() & 1U)));
        at[a] = a == 0 ? box.at(a, uniform(bits)) : std::clamp(double(place), box.lo[a], box.hi[a]);
      }
      const double longer = 1 + 0.9 * length_tolerance * (2 * uniform(bits) - 1);
      const auto values = of(lifted(domain, float(longer * std::sin(at[0])), float(longer * std::cos(at[0])),
                                    float(at[1]), float(at[2]))
                                 .geometry);
      for (std::size_t j = 0; j < values.size(); ++j)
        missed += !holds(tamper(forms[j]), box, at, double(values[j]));
    }
  }
  return missed;
}

TEST(GrazingEnclosure, HoldsHalfVectorsOfDirectionsThatNearlyCancel) {
  EXPECT_EQ(missed_geometries(6000, [](const AffineForm& f) { return f; }), 0U);
}
TEST(GrazingEnclosureTwin, WrongFormsAreFound) {
  const auto by_line = [](AffineForm f) {
    f.range = RealInterval::whole();
    return f;
  };
  EXPECT_GT(missed_geometries(2000,
                              [&](AffineForm f) {
                                f.error *= 0.5;
                                return by_line(f);
                              }),
            0U);
  EXPECT_GT(missed_geometries(2000,
                              [&](AffineForm f) {
                                f.slope[1] = -f.slope[1];
                                return by_line(f);
                              }),
            0U);
  EXPECT_GT(missed_geometries(2000,
                              [](AffineForm f) {
                                f.range.hi -= 1e-4 * (f.range.hi - f.range.lo) + 2e-6;
                                f.error = detail::infinity;
                                return f;
                              }),
            0U);
}

}  // namespace
}  // namespace reflectree
