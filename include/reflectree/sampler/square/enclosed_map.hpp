// SPDX-License-Identifier: Apache-2.0
// Steps of the domains' maps over boxes (domain_map.hpp), written so that the forms stay narrow: equal to what
// the maps say, with room for what the maps round. u: half an ulp of float, 2^-24.
#pragma once

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree {

// Of the variables of a form: the angle of the star (star_of), divided as unknowns are; the error of d.
inline constexpr std::size_t star_axis = 6, error_of_d = 7;
namespace detail {
template <>
struct SlopeStar<AffineForm> {
  AffineForm p, c;
  std::size_t error_of_cosine = 0;  // a variable for that of wi.z; 0: none is free
};
template <class Map>
struct StarOfBox : Map {
  RealInterval* angle;
  std::size_t free_variable;
};
}  // namespace detail

// projected_area / cos theta_i, too, up to the same roundings: some maps and functions divide what the other
// multiplies, and cos theta_i is noise at the rim.
template <>
struct DomainPointT<AffineForm> {
  ShadingGeometry<AffineForm> geometry;
  AffineForm projected_area;
  std::optional<AffineForm> area_by_cosine = std::nullopt;
};

// The polynomials of fast_functions.hpp are 5e-8 off. That of the sine rounds by less than 3e-7 and has the argument as
// a factor, so that both are relative. That of the cosine rounds by less than 1.5e-7: the product 4.93 s <= 1.24, s a
// quarter of the square, by 2^-24, and all else by 7e-8. It ends at 2^-25 and is no less before, however steps are fused
// (tests/sampler/measured_enclosure_test.cpp). On either side of x = 0 sine and cosine take their place.
inline constexpr double least_cosine_of_half = 0x1p-26;
inline Vec2<AffineForm> cos_sin_half(const AffineForm& x) {
  if (x.range.lo < 0 && x.range.hi > 0) return cos_sin_half<AffineForm>(x);
  const auto sine_of = [](AffineForm share) {  // of a right angle
    share.range = intersection(share.range, {0, 1});
    return sin(AffineForm(0.5 * pi_v<double>) * share);
  };
  constexpr double of_sine = 4e-7, of_cosine = 2e-7;
  const AffineForm a = abs(x), sine = widened(sine_of(a), of_sine);
  AffineForm cosine = sine_of(AffineForm(1) - a) + AffineForm::anything_in({-of_cosine, of_cosine});
  cosine.range.lo = std::max(cosine.range.lo, least_cosine_of_half);
  return {cosine, x.range.hi > 0 ? sine : -sine};
}

// The maps use p and c as their ratio alone, d = p / (p + (c - p) y), and what that rounds is relative to p. So
// p = 1 and c = c / p, which has two roundings more than l.
inline detail::HalfVectorStar<AffineForm> half_vector_star(const AffineForm& sine, const AffineForm& cosine,
                                                           const AffineForm& cos_phi) {
  const AffineForm sx = sine * cos_phi, l = sqrt(sqr(cosine) + sx * sx) + abs(sx);
  return {AffineForm(1), widened(by_sign(sx, cosine / l, l / cosine), 4 * 0x1p-24)};
}
inline detail::MirrorRim<AffineForm> mirror_rim(const AffineForm& sine, const AffineForm& cosine,
                                                const AffineForm& cos_phi) {
  const AffineForm sx = sine * cos_phi, l = sqrt(sqr(cosine) + sx * sx) + abs(sx);
  return {AffineForm(1), widened(by_sign(sx, l / cosine, cosine / l), 4 * 0x1p-24),
          by_sign(sx, sqr(cosine) / l, l)};
}

// With R = p / c, tau = y d and 1 - tau / R = d (1 - y),
//   (2 (wo.n) - z (n.n)) / (n.n) = z (1 - tau / R) (1 + R tau) / (1 + tau^2),
// where nothing cancels. The map's R errs by 16 u, its d by 6 u max(1, d) and tau by one u more: 1 - tau / R by
// less than 24 u max(1, d), since tau / R <= 1. Its 2 (wo.n) / (n.n) errs by less than 16 u of itself: wo.n is at
// least a third of its terms, as z >= 2 |sin theta_o cos phi| tau where the two differ in sign.
inline AffineForm reflected_cosine(const AffineForm& twice, const AffineForm& z,
                                   const detail::HalfVectorStar<AffineForm>& star, const AffineForm& y,
                                   const AffineForm& d, const AffineForm& cos2_theta_h) {
  constexpr double u = 0x1p-24;
  const AffineForm plain = twice - z;
  const double off = 24 * u * std::max(1., d.range.hi), lost = 16 * u * (twice.range.hi + z.range.hi);
  if (!(off < 1) || !(lost < 1)) return plain;
  const AffineForm to_rim = d * (AffineForm(1) - y) + AffineForm::anything_in({-off, off});
  const AffineForm beyond = AffineForm(1) + y * d * (star.p / star.c);
  AffineForm out =
      narrower(plain, z * to_rim * (beyond * cos2_theta_h) + AffineForm::anything_in({-lost, lost}));
  out.range.hi = std::min(out.range.hi, 1 + 4 * length_tolerance);
  return out;
}

// The star of slopes likewise: c / p is q z / l where b > 0, and l / z where b < 0. Both are
//   sqrt(q) exp(-asinh(b / (sqrt(q) z))),
// which has no kink where b changes its sign, and a logarithm that hardly bends.
// Where wo has an azimuth of its own, the layer in which b changes its sign lies across the box: boxes as thin as wo.z
// would be needed along all of it. There the angle h = asinh(b / (sqrt(q) z)) may be an unknown of its own, whose
// range is divided: c / p = sqrt(q) e^-h of the numbers that the program has. `angle` comes with those that are
// meant, and goes with those of them that the box has; the unknown stands in where it is less than the error.
inline detail::SlopeStar<AffineForm> slope_star(const Vec3<AffineForm>& wo, const Vec2<AffineForm>& along,
                                                RealInterval* angle = nullptr) {
  const AffineForm q = sqr(along.x) + sqr(along.y), b = along.x * wo.x + along.y * wo.y, width = sqrt(q);
  const AffineForm qz = q * wo.z, l = sqrt(sqr(b) + qz * wo.z) + abs(b);
  const AffineForm h = asinh(b / (width * wo.z));
  AffineForm c = narrower(by_sign(b, qz / l, l / wo.z), width * exp(-h));
  if (angle) {
    constexpr double off = 1e-6;  // roundings of c
    *angle = intersection(*angle, {h.range.lo - off, h.range.hi + off});
    if (!(angle->lo <= angle->hi)) return {AffineForm(1), c};
    const AffineForm known = width * exp(-AffineForm::variable(star_axis, angle->lo, angle->hi));
    if (!(c.log_error <= 0.5 * (angle->hi - angle->lo))) c = known;
    const RealInterval range = intersection(c.range, known.range);
    if (range.lo <= range.hi) c.range = range;
  }
  return {AffineForm(1), widened(c, 8 * 0x1p-24)};
}
namespace detail {
template <class Map>
SlopeStar<AffineForm> star_of(const StarOfBox<Map>& map, const Vec3<AffineForm>& wo,
                              const Vec2<AffineForm>& along) {
  SlopeStar<AffineForm> star = slope_star(wo, along, map.angle);
  star.error_of_cosine = map.free_variable;
  return star;
}
}  // namespace detail
// 1 / d = (1 - y) + c y = c (1 + (1 - y) (1 / c - 1)), the latter near the rim. What the map adds and takes away
// rounds by less than 4 u max(1, c).
inline AffineForm radius_per_y(const detail::SlopeStar<AffineForm>& star, const AffineForm& y) {
  const AffineForm one(1), rest = one - y;
  const double off = 4 * 0x1p-24 * std::max(1., star.c.range.hi);
  const AffineForm slack = AffineForm::anything_in({-off, off});
  const AffineForm plain = one / (one + (star.c - one) * y);
  const AffineForm inside = one / (rest + star.c * y + slack);
  const AffineForm by_rim = one / (star.c * (one + rest * (one / star.c - one)) + slack);
  return with_named_error(narrower(narrower(plain, inside), by_rim), error_of_d);
}
// Both squares are r^2 q; what they round is relative.
inline AffineForm squared_normal(const Vec2<AffineForm>&, const Vec2<AffineForm>& along,
                                 const AffineForm& r) {
  return widened(AffineForm(1) + (sqr(along.x) + sqr(along.y)) * sqr(r), 8 * 0x1p-24);
}
// With q and b of slope_star_map.hpp b = z (q R - 1 / R) / 2, and so wo.n = z + b r, in which terms may cancel, is
//   z / 2 (1 + (1 - r / R) + q r R),
// in which none do. What rounds: as below, where 1 - r / R = d (1 - y), too.
inline AffineForm cosine_to_normal(const Vec3<AffineForm>& wo, const Vec2<AffineForm>& tau,
                                   const detail::SlopeStar<AffineForm>& star, const Vec2<AffineForm>& along,
                                   const AffineForm& y, const AffineForm& d) {
  constexpr double u = 0x1p-24;
  const AffineForm plain = wo.x * tau.x + wo.y * tau.y + wo.z, r = y * d, one(1);
  const double off = 24 * u * std::max(1., d.range.hi);
  const double terms = r.range.hi * ((along.x * wo.x).range.magnitude() + (along.y * wo.y).range.magnitude());
  const double lost = 16 * u * (terms + wo.z.range.hi);
  if (!(off < 1) || !(lost < 1)) return plain;
  const AffineForm to_rim = d * (one - y) + AffineForm::anything_in({-off, off});
  const AffineForm sum = one + to_rim + (sqr(along.x) + sqr(along.y)) * (r * (star.p / star.c));
  const AffineForm other = widened(AffineForm(0.5) * wo.z * sum, 64 * u);
  return narrower(plain, other + AffineForm::anything_in({-lost, lost}));
}
// With q and b of slope_star_map.hpp and the roots R and -1 / (q R) of z + 2 b r - q z r^2,
//   (2 (wo.n) - z (n.n)) / (n.n) = z (1 - r / R) (1 + q R r) / (1 + q r^2).
// 1 - r / R = d (1 - y) errs as above. But b is a sum whose terms may cancel, and so is wo.n: the map's R belongs to
// a b that is off by 4 u of its terms, and wo.n errs by 4 u of its own, which are r times as large.
inline AffineForm reflected_cosine(const AffineForm& twice, const Vec3<AffineForm>& wo,
                                   const detail::SlopeStar<AffineForm>& star, const Vec2<AffineForm>& along,
                                   const AffineForm& y, const AffineForm& d, const AffineForm& cos2_theta_h) {
  constexpr double u = 0x1p-24;
  const AffineForm plain = twice - wo.z, r = y * d;
  const double off = 24 * u * std::max(1., d.range.hi);
  const double terms = r.range.hi * ((along.x * wo.x).range.magnitude() + (along.y * wo.y).range.magnitude());
  const double lost = 16 * u * (twice.range.hi + wo.z.range.hi + cos2_theta_h.range.hi * terms);
  if (!(off < 1) || !(lost < 1)) return plain;
  const AffineForm to_rim = d * (AffineForm(1) - y) + AffineForm::anything_in({-off, off});
  const AffineForm beyond = AffineForm(1) + (sqr(along.x) + sqr(along.y)) * (r * (star.p / star.c));
  AffineForm out =
      narrower(plain, wo.z * to_rim * (beyond * cos2_theta_h) + AffineForm::anything_in({-lost, lost}));
  out.range.hi = std::min(out.range.hi, 1 + 4 * length_tolerance);
  return star.error_of_cosine > 0 ? with_named_error(out, star.error_of_cosine) : out;
}

// A direction that a domain returns is of unit length, and so is a half vector: what large boxes know of them.
inline DomainPointT<AffineForm> with_unit_vectors(DomainPointT<AffineForm> point) {
  constexpr double most = 1 + 4 * length_tolerance;
  ShadingGeometry<AffineForm>& g = point.geometry;
  for (AffineForm* v :
       {&g.wi.x, &g.wi.y, &g.wi.z, &g.wh.x, &g.wh.y, &g.wh.z, &g.cos_theta_i, &g.cos_theta_h, &g.cos_theta_d})
    v->range = intersection(v->range, {-most, most});
  return point;
}

// The azimuth of the half vectors of a star: that of their slopes, on one side of y = 0. The map's sine and cosine err by
// 4e-7, products by less, and the square is kept from the pole.
template <class Map>
std::optional<HalfAzimuth> star_azimuth(const Map& map, const Vec2<AffineForm>& p) {
  if (p.y.range.lo < 0 && p.y.range.hi > 0) return std::nullopt;
  const Vec2<AffineForm> half = cos_sin_half(p.x), along = map.along({half.y, half.x});
  const AffineForm angle =
      along.x.range.hi < 0 ? AffineForm(pi_v<double>) - atan2(along.y, -along.x) : atan2(along.y, along.x);
  constexpr double off = 1e-6;
  AffineForm rounded = angle + AffineForm::anything_in({-off, off});
  rounded.range = intersection(rounded.range, {0, pi_v<double>});
  const bool below = p.y.range.hi <= 0 && p.y.range.lo < 0;
  const AffineForm any = AffineForm::anything_in({-1, 1});
  return HalfAzimuth{any, any, below ? -rounded : rounded};
}

// lift_point over a box. The map of back vectors is that of half vectors for wo mirrored about the normal, and so
// it knows b, the half vector of wo and of the mirrored wi, which the float formula takes from their sum. With p
// as the exact sum, that one errs by 22 u |p|, by u along x, and by 1e-7 along z where wi.z is kept from 0. Where
// the two may point apart, what it has along their difference m is taken out: of u along x only
// u |(m.y, m.z)| / |m| < u |p| stays. With the roundings of this step and of the norm: less than 64 u of itself
// and 8 u along x and y.
//
// `D`: a Domain, or one of a family, whose widths are forms.
struct DomainForms {
  DomainKind kind;
  float exponent, stretch;
  AffineForm scale_x, scale_y;
  RealInterval* star_angle = nullptr;  // of slope_star()
  std::size_t free_variable = 0;
};
template <class Map>
detail::StarOfBox<Map> map_of(const DomainForms& domain, const Map& map) {
  return {map, domain.star_angle, domain.free_variable};
}
template <class D>
DomainPointT<AffineForm> lift_box(const D& domain, const Vec3<AffineForm>& wo, const Vec2<AffineForm>& p) {
  if (domain.kind != DomainKind::back_vector) {
    DomainPointT<AffineForm> out = with_unit_vectors(detail::lift_point(domain, wo, p));
    if (domain.kind == DomainKind::half_vector) {
      const Vec2<AffineForm> half_azimuth = cos_sin_half(p.x);
      // The map keeps wh from the normal; the length of its azimuth's vector errs by 6e-7, the angle by as much.
      constexpr double off = 1e-6;
      AffineForm angle =
          AffineForm(0.5 * pi_v<double>) * (AffineForm(1) - p.x) + AffineForm::anything_in({-off, off});
      angle.range = intersection(angle.range, {0, pi_v<double> + off});
      out.geometry.azimuth_h = {widened(half_azimuth.y, off), widened(half_azimuth.x, off), angle};
    }
    if (domain.kind == DomainKind::slope_star)
      out.geometry.azimuth_h = star_azimuth(detail::Stretched<AffineForm>{AffineForm(domain.stretch)}, p);
    if (domain.kind == DomainKind::scaled_star)
      out.geometry.azimuth_h = star_azimuth(
          detail::Scaled<AffineForm>{{AffineForm(domain.scale_x), AffineForm(domain.scale_y)}}, p);
    const bool of_directions = domain.kind == DomainKind::projected_disk ||
                               domain.kind == DomainKind::equal_area || domain.kind == DomainKind::stretched;
    if (of_directions && (p.y.range.lo >= 0 || p.y.range.hi < 0)) {
      constexpr double off = 1e-6;  // as above
      const AffineForm angle =
          AffineForm(0.5 * pi_v<double>) * (AffineForm(1) - p.x) + AffineForm::anything_in({-off, off});
      out.geometry.azimuth_i = p.y.range.lo >= 0 ? angle : -angle;
    }
    if (domain.kind == DomainKind::equal_area) out.area_by_cosine = AffineForm(2 * pi);
    return out;
  }
  D of_halves = domain;
  of_halves.kind = DomainKind::half_vector;
  const DomainPointT<AffineForm> turned =
      with_unit_vectors(detail::lift_point(of_halves, mirror_direction(wo), p));
  const ShadingGeometry<AffineForm>& t = turned.geometry;
  DomainPointT<AffineForm> out{shading_geometry(wo, t.wi), turned.projected_area};
  constexpr double u = 0x1p-24;
  const double kept = t.wi.z.range.lo > 1.01e-7 ? 0 : 1.01e-7 / (wo.z + t.wi.z).range.lo;
  if (!(kept < 0.1)) return out;
  const auto beside = [&](const AffineForm& v) {
    return widened(v, 64 * u) + AffineForm::anything_in({-8 * u - kept, 8 * u + kept});
  };
  BackVector back{{beside(-t.wh.x), beside(-t.wh.y), widened(t.wh.z, 64 * u + kept)},
                  widened(t.cos_theta_d, 64 * u + kept)};
  for (AffineForm* v : {&back.wh.x, &back.wh.y, &back.wh.z})
    v->range = intersection(v->range, {-1 - 8 * u, 1 + 8 * u});
  out.geometry.back = back;
  return out;
}

}  // namespace reflectree
