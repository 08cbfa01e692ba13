// SPDX-License-Identifier: Apache-2.0
// The contract of every model's enclosure: over random boxes of viewers and places in the square of any domain
// it holds what the model returns, in float and in double; sharper boxes give sharper bounds. A model joins by
// the line that registers it.
#include <gtest/gtest.h>

#include "random_boxes.hpp"
#include "reflectree/brdf/models/enclosed_fits.hpp"
#include "reflectree/brdf/tables/half_angle_table.hpp"

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

// What a proof does not look at: where x and y of all directions change their signs, or y alone.
TYPED_TEST(ModelEnclosure, KeepsWhatItSays) {
  Pcg32 bits(9);
  for (int i = 0; i < 300; ++i) {
    const TypeParam model = i == 0 ? TypeParam() : random_model<TypeParam>(bits);
    const BrdfTraits traits = model.traits();
    const ExactSymmetry keeps = symmetry_of_model(model);
    for (const Pair& pair : test_pairs(2, bits)) {
      const auto imaged = [&](const ShadingGeometry<float>& g, float x, float y) {
        const auto image = [=](Direction w) { return Direction{x * w.x, y * w.y, w.z}; };
        return ShadingGeometry<float>{image(g.wo),   image(g.wi),   image(g.wh),  g.cos_theta_o,
                                      g.cos_theta_i, g.cos_theta_h, g.cos_theta_d};
      };
      const ShadingGeometry<float> g = shading_geometry(pair.wo, pair.wi);
      const auto value = model(g);
      if (keeps.half_turns) {
        EXPECT_EQ(value, model(imaged(g, -1, -1))) << traits.name;
      }
      if (keeps.mirrored_axes) {
        EXPECT_EQ(value, model(imaged(g, 1, -1))) << traits.name;
      }
    }
  }
}
// The twin: a lobe that is turned does not return the same, and does not say so.
TEST(ModelEnclosureTwin, ATurnedLobeKeepsNoMirroredAxes) {
  Ggx model;
  model.alpha.x = 0.1f, model.alpha.y = 0.4f;
  EXPECT_TRUE(symmetry_of_model(model).mirrored_axes);
  model.phi = Azimuth(20);
  EXPECT_FALSE(symmetry_of_model(model).mirrored_axes);
  const Direction wo{0.6f, 0, 0.8f}, wi{-0.48f, 0.36f, 0.8f}, image{-0.48f, -0.36f, 0.8f};
  EXPECT_NE(model(shading_geometry(wo, wi)), model(shading_geometry(wo, image)));
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

// The published fits: parameters as they are fitted, whose masking is about to vanish at grazing.
Sgd random_sgd(Pcg32& bits) {
  Sgd model;
  for (SgdChannel& c : model.channels) {
    const auto in = [&](double lo, double hi) { return float(lo + uniform(bits) * (hi - lo)); };
    c.kd = in(0, 0.2), c.ks = in(0, 1), c.alpha = std::exp(in(-6, 0)), c.p = in(0.2, 2), c.kappa = in(1, 50);
    c.f0 = in(0, 2), c.f1 = in(-0.5, 1), c.lambda = in(0.5, 4), c.k = in(1, 40), c.theta_0 = in(-0.5, 0.5);
    // c (pi/2 - theta_0)^k = log(1 + 1 / lambda) would be 0 at grazing.
    c.log_c = std::log(std::log1p(1 / c.lambda)) - c.k * std::log(0.5f * pi - c.theta_0) + in(-1e-5, 1e-5);
  }
  return model;
}
AbcMicrofacet random_abc(Pcg32& bits) {
  AbcMicrofacet model;
  const float a = float(100 * uniform(bits));
  model.kd = {0.1f, 0.1f, float(uniform(bits))}, model.a = {a, a, a};
  model.b = float(std::exp(12 * uniform(bits))), model.c = float(0.3 + 2 * uniform(bits));
  model.ior = float(1 + 2 * uniform(bits));
  return model;
}
TEST(FitEnclosure, HoldsItsValues) {
  Pcg32 bits(21);
  std::size_t finite = 0, boxes = 0;
  for (int i = 0; i < 60; ++i) {
    const Sgd sgd = random_sgd(bits);
    const AbcMicrofacet abc = random_abc(bits);
    const auto a = compare(sgd, sgd, bits, 35);
    const auto b = compare(abc, abc, bits, 35);
    EXPECT_EQ(a.missed, 0U);
    EXPECT_EQ(b.missed, 0U);
    finite += a.finite + b.finite, boxes += a.boxes + b.boxes;
  }
  EXPECT_GT(finite, boxes / 2);
}
TEST(FitEnclosureTwin, OfAnotherFunctionIsFound) {
  Pcg32 bits(22);
  const Sgd sgd = random_sgd(bits);
  const AbcMicrofacet abc = random_abc(bits);
  EXPECT_GT(compare(
                sgd, [&](const auto& g) { return 1.01f * sgd(g); }, bits, 1400)
                .missed,
            0U);
  EXPECT_GT(compare(
                abc, [&](const auto& g) { return 1.01f * abc(g); }, bits, 1400)
                .missed,
            0U);
}

// Towards grazing, where masking and cosine vanish together, the form knows their quotient.
TEST(FitEnclosure, OfMaskingKnowsWhatIsLeftAtGrazing) {
  SgdChannel c{0, 1, 0.1f, 1, 1, 1, 0, 2.6f, -16.f, 47.783f, 0.205635f};
  c.log_c = std::log(std::log1p(1 / c.lambda)) - c.k * std::log(0.5f * pi - c.theta_0);
  const AffineForm z = AffineForm::variable(0, 1e-4, 1.05e-4);
  const AffineForm share =
      sgd_masking(c, sgd_elevation({sqrt(AffineForm(1) - sqr(z)), AffineForm(0), z})) / z;
  EXPECT_LT(share.range.hi, 1.02 * share.range.lo);
}

// Half-angle tables, of both look-ups and of both periods, some entries of which were not measured.
HalfAngleTable random_table(Pcg32& bits, TableLookup lookup, bool reciprocal, bool gaps) {
  HalfAngleTable table;
  table.n_h = 9, table.n_d = 7, table.n_p = 12;
  table.reciprocal = reciprocal, table.lookup = lookup;
  for (int i = 0; i < table.n_h * table.n_d * table.n_p * 3; ++i)
    table.rgb.push_back(gaps && uniform(bits) < 0.05 ? -1.f : float(uniform(bits)));
  return table;
}
struct EnclosedTable {
  std::shared_ptr<const BrdfEnclosure> enclosure;
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const { return (*enclosure)(g); }
};
template <class Share>
std::size_t missed_in_tables(const Share& share) {
  std::size_t missed = 0, finite = 0;
  Pcg32 bits(23);
  for (int i = 0; i < 24; ++i) {
    const auto lookup = i % 2 ? TableLookup::linear : TableLookup::nearest;
    const HalfAngleTable table = random_table(bits, lookup, i & 2, i & 4);
    const EnclosedTable enclosure{enclosed(table).traits().enclosure};
    const auto seen = compare(
        enclosure, [&](const auto& g) { return share(table(g)); }, bits, 210);
    missed += seen.missed, finite += seen.finite;
  }
  EXPECT_GT(finite, 1000U);
  return missed;
}
TEST(TableEnclosure, HoldsItsValues) {
  EXPECT_EQ(missed_in_tables([](Rgb v) { return v; }), 0U);
}
TEST(TableEnclosureTwin, OfAnotherTableIsFound) {
  EXPECT_GT(missed_in_tables([](Rgb v) { return 1.01f * v; }), 0U);
}
// In one cell a linear table is known by its slopes, a constant one exactly.
TEST(TableEnclosure, SmallBoxesGiveSharpBounds) {
  Pcg32 bits(24);
  const auto error = [](const HalfAngleTable& table, double width) {
    const EnclosedTable enclosure{enclosed(table).traits().enclosure};
    const Domain domain{DomainKind::half_vector, Symmetry::mirror, 1};
    const DomainPointT<AffineForm> lift =
        lifted_box(domain, {{0.7, 0.31, 0.42}, {0.7 + width, 0.31 + width, 0.42 + width}});
    return enclosure(lift.geometry).g.error;
  };
  const HalfAngleTable linear = random_table(bits, TableLookup::linear, true, false);
  EXPECT_LT(error(linear, 0.002), 0.3 * error(linear, 0.004) + 1e-5);
  EXPECT_LT(error(random_table(bits, TableLookup::nearest, true, false), 1e-4), 1e-6);
}

}  // namespace
}  // namespace reflectree
