// SPDX-License-Identifier: Apache-2.0
// A half-angle table over boxes of directions: the position of a pair in the table as three forms, and the
// entries that the look-up may touch there.
#include <mutex>
#include <optional>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/tables/half_angle_table.hpp"
#include "reflectree/math/affine_grid.hpp"

namespace reflectree {
namespace {

constexpr double u = 0x1p-24;  // half an ulp of float

struct Position {
  AffineForm h, d, p;  // in units of the cells; p has no seam: whole turns are left open
};

// angle_of(y, x) up to whole turns; the polynomials of fast_functions.hpp err by less than 3e-7 of their value.
constexpr double off_angle = 4e-7;
AffineForm turned_angle(const AffineForm& y, const AffineForm& x) {
  if (!(x.range.hi < 0)) return widened(atan2(y, x), off_angle);
  return widened(AffineForm(pi_v<double>) + atan2(-y, -x), off_angle);
}

// What detail::difference_vector() and the table's position() compute. The difference vector is of unit length,
// too: while cos theta_d is not small its square is off by less than 8 length_tolerance, with the lengths of wo
// and wi and what wh rounds.
Position position(const HalfAngleTable& table, const ShadingGeometry<AffineForm>& g) {
  const AffineForm one(1), half(0.5f), share_of_right_angle(2.f / pi);
  const AffineForm sin_h = sqrt(sin2_theta(g.wh)), cos_h = max(g.cos_theta_h, AffineForm(0));
  AffineForm cos_phi = AffineForm::anything_in({-1 - 4 * u, 1 + 4 * u}), sin_phi = cos_phi;
  if (sin_h.range.lo > 0)
    cos_phi = narrower(cos_phi, g.wh.x / sin_h), sin_phi = narrower(sin_phi, g.wh.y / sin_h);
  const Vec3<AffineForm> m{half * (g.wi.x - g.wo.x), half * (g.wi.y - g.wo.y), half * (g.wi.z - g.wo.z)};
  const AffineForm dx = g.cos_theta_h * (cos_phi * m.x + sin_phi * m.y) - sin_h * m.z;
  const AffineForm dy = cos_phi * m.y - sin_phi * m.x;
  AffineForm sin2_d = sqr(dx) + sqr(dy);
  if (g.cos_theta_d.range.lo > 0.01) {
    const double off = 8 * length_tolerance;
    sin2_d = narrower(sin2_d, one - sqr(g.cos_theta_d) + AffineForm::anything_in({-off, off}));
  }
  sin2_d.range.lo = std::max(sin2_d.range.lo, 0.);
  const AffineForm theta_h = widened(atan2(sin_h, cos_h), off_angle);
  const AffineForm theta_d = widened(atan2(sqrt(sin2_d), max(g.cos_theta_d, AffineForm(0))), off_angle);
  const double n_p = double(table.n_p), period = table.reciprocal ? pi_v<double> : 2 * pi_v<double>;
  // The program may add a period, and rounds three times.
  const AffineForm p =
      AffineForm(n_p / period) * turned_angle(dy, dx) + AffineForm::anything_in({-8 * u * n_p, 8 * u * n_p});
  return {AffineForm(table.n_h) * sqrt(theta_h * share_of_right_angle),
          AffineForm(table.n_d) * theta_d * share_of_right_angle, p};
}

struct Channel {
  const HalfAngleTable* table;
  int channel;
  float operator()(const std::array<int, 3>& i) const {
    const auto cell =
        (std::size_t(i[0]) * std::size_t(table->n_d) + std::size_t(i[1])) * std::size_t(table->n_p) +
        std::size_t(i[2]);
    return table->rgb[3 * cell + std::size_t(channel)];
  }
};
using Ranges = GridRanges<3, Channel>;

class HalfAngleEnclosure final : public BrdfEnclosure {
 public:
  explicit HalfAngleEnclosure(std::shared_ptr<const HalfAngleTable> table) : table_(std::move(table)) {}

  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    std::call_once(once_, [this] {
      for (int c = 0; c < 3; ++c)
        ranges_[std::size_t(c)].emplace(std::array{table_->n_h, table_->n_d, table_->n_p},
                                        Channel{table_.get(), c});
    });
    const Position at = position(*table_, g);
    return table_->lookup == TableLookup::nearest ? nearest(at) : linear(at);
  }

 private:
  // A mark of what was not measured counts as 0.
  static AffineForm anything_in(RealInterval entries) {
    return AffineForm::anything_in({std::max(entries.lo, 0.), std::max(entries.hi, 0.) * (1 + 16 * u)});
  }

  RgbT<AffineForm> nearest(const Position& at) const {
    const CellRange h = cells_of(at.h.range, table_->n_h), d = cells_of(at.d.range, table_->n_d);
    int first = 0, last = table_->n_p - 1;
    if (at.p.range.magnitude() < 1e6)
      first = int(std::floor(at.p.range.lo)), last = int(std::floor(at.p.range.hi));
    const auto of = [&](std::size_t c) {
      return anything_in(ranges_[c]->over({h.first, d.first, first}, {h.last, d.last, last}));
    };
    return {of(0), of(1), of(2)};
  }

  // Interpolation rounds less than 16 times. Where an entry is missing, the measured ones are averaged.
  RgbT<AffineForm> linear(const Position& at) const {
    const AffineForm half(0.5f);
    const GridPieces<3> pieces(
        {GridAxis{table_->n_h, false, {}}, GridAxis{table_->n_d, false, {}}, GridAxis{table_->n_p, true, {}}},
        {at.h - half, at.d - half, at.p - half});
    const auto of = [&](std::size_t c) {
      bool missing = false;
      const AffineForm form = pieces.interpolated_by_ranges(
          [&](const std::array<int, 3>& first, const std::array<int, 3>& last) {
            const RealInterval v = ranges_[c]->over(first, last);
            missing = missing || v.lo < 0;
            return v;
          },
          16 * u);
      return missing ? anything_in(ranges_[c]->over(pieces.first(), pieces.last()))
                     : max(form, AffineForm(0));
    };
    return {of(0), of(1), of(2)};
  }

  std::shared_ptr<const HalfAngleTable> table_;
  mutable std::once_flag once_;
  mutable std::array<std::optional<Ranges>, 3> ranges_;  // a quarter of the table, when the first box asks
};

struct SharedTable {
  std::shared_ptr<const HalfAngleTable> table;

  Rgb operator()(const ShadingGeometry<float>& g) const { return (*table)(g); }
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const {
    table->eval(wo, wi, out);
  }
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
    table->eval(geometry, out);
  }
  BrdfTraits traits() const {
    BrdfTraits traits = table->traits();
    traits.enclosure = std::make_shared<HalfAngleEnclosure>(table);
    return traits;
  }
};

}  // namespace

AnyBrdf enclosed(HalfAngleTable table) {
  return SharedTable{std::make_shared<const HalfAngleTable>(std::move(table))};
}

}  // namespace reflectree
