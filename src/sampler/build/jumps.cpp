// SPDX-License-Identifier: Apache-2.0
#include "jumps.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "knots.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t points = 128;
constexpr double leap = 0.02;  // of the values' sum, to be a jump

// Along one coordinate of the viewer, from lo to hi.
struct Axis {
  bool azimuth;
  double lo, hi;
  int intervals;
};

// Fixed points of the square, each with the viewer's other coordinate and a member of the family: half of
// them spread, half of them drawn to the pole, where lobes are.
struct FixedPoint {
  Vec2<float> p;
  float other;
  Coordinates at = {};  // of families
};
std::vector<FixedPoint> fixed_points(const Field& field, const Axis& axis, std::uint64_t seed) {
  const Domain& domain = field.domain;
  Pcg32 u(seed, 17), around(seed, 18);
  const float span = axis.azimuth ? theta_max : azimuth_span(field.frame.symmetry);
  std::vector<FixedPoint> p;
  for (std::size_t i = 0; i < points; ++i) {
    float y = to_unit_float(u());
    if (i % 2) y = std::pow(10.f, -3 * y);
    const Vec2<float> at{2 * to_unit_float(u()) - 1, domain.half() || u() % 2 ? y : -y};
    const float other = span * to_unit_float(around());
    Coordinates member{};
    for (std::size_t k = 0; k < field.parameters.size(); ++k) {
      const KnownParameter& q = field.parameters[k];
      member[k] = linear_mix(to_unit_float(around()), lowest(q), highest(q));
    }
    p.push_back({at, other, member});
  }
  return p;
}

using Values = std::vector<float>;

Direction viewer_on(const Axis& axis, double at, float other) {
  if (axis.azimuth) return viewer_at({other, float(at)}).wo;
  return turned_to(wo_from_cosine(clamp(float(std::cos(at)), min_cos_theta_o, 1.f)), other);
}

// T at the points for every place on the axis.
std::vector<Values> values_at(const Field& field, const Axis& axis, const std::vector<FixedPoint>& p,
                              const std::vector<double>& places, const Host& host, Effort& effort) {
  std::vector<FieldPoint> all;
  for (const double at : places) {
    for (const FixedPoint& q : p) all.push_back({viewer_on(axis, at, q.other), q.p, q.at});
  }
  std::vector<FieldValue> values(all.size());
  eval_in_parallel(field, host, effort, all, values);
  std::vector<Values> result(places.size(), Values(p.size()));
  for (std::size_t i = 0; i < all.size(); ++i) result[i / p.size()][i % p.size()] = values[i].mean;
  return result;
}

struct Change {
  double relative = 0;    // sum |a - b| over half the sum of both
  std::size_t leaps = 0;  // points that change by a tenth and more
};
Change change(const Values& a, const Values& b) {
  double miss = 0, sum = 0;
  Change c;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double m = std::abs(double(a[i]) - double(b[i]));
    miss += m, sum += 0.5 * (double(a[i]) + double(b[i]));
    c.leaps += m > 0.1 * double(max(a[i], b[i]));
  }
  c.relative = sum > 0 ? miss / sum : 0;
  return c;
}

struct Bracket {
  double lo, hi;
  Values at_lo, at_hi;
};

// Brackets of leaps, at most `narrow` wide.
std::vector<Bracket> find_leaps(const Field& field, const Axis& axis, double narrow, const Host& host,
                                Effort& effort) {
  const std::vector<FixedPoint> p = fixed_points(field, axis, 1);
  std::vector<double> places;
  for (int i = 0; i <= axis.intervals; ++i)
    places.push_back(axis.lo + (axis.hi - axis.lo) * i / axis.intervals);
  const std::vector<Values> values = values_at(field, axis, p, places, host, effort);
  std::vector<Bracket> open;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    if (change(values[i], values[i + 1]).relative > leap)
      open.push_back({places[i], places[i + 1], values[i], values[i + 1]});
  }
  // What is continuous changes by half as much in half of an interval, and drops out.
  while (!open.empty() && open.front().hi - open.front().lo > narrow) {
    std::vector<double> middles;
    for (const Bracket& b : open) middles.push_back(0.5 * (b.lo + b.hi));
    const std::vector<Values> at = values_at(field, axis, p, middles, host, effort);
    std::vector<Bracket> next;
    for (std::size_t k = 0; k < open.size(); ++k) {
      Bracket& b = open[k];
      const double below = change(b.at_lo, at[k]).relative, above = change(at[k], b.at_hi).relative;
      if (max(below, above) <= leap) continue;
      if (below >= above) {
        b.hi = middles[k], b.at_hi = at[k];
      } else {
        b.lo = middles[k], b.at_lo = at[k];
      }
      next.push_back(std::move(b));
    }
    open = std::move(next);
  }
  // An edge that moves may pass a point there by chance; other points tell.
  const std::vector<FixedPoint> fresh = fixed_points(field, axis, 2);
  std::vector<double> sides;
  for (const Bracket& b : open) sides.push_back(b.lo - narrow), sides.push_back(b.hi + narrow);
  const std::vector<Values> at = values_at(field, axis, fresh, sides, host, effort);
  std::vector<Bracket> leaps;
  for (std::size_t k = 0; k < open.size(); ++k) {
    const Change c = change(at[2 * k], at[2 * k + 1]);
    if (c.relative > leap && c.leaps >= 3) leaps.push_back(open[k]);
  }
  std::sort(leaps.begin(), leaps.end(), [](const Bracket& a, const Bracket& b) { return a.lo < b.lo; });
  return leaps;
}

// The two cosines, neighbours among floats where f is quiet enough, between which it leaps.
ThetaJump between_floats(const Field& field, const Axis& axis, const Bracket& found, double least,
                         const Host& host, Effort& effort) {
  const std::vector<FixedPoint> p = fixed_points(field, axis, 1);
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  std::uint32_t lo = bits(max(float(std::cos(found.hi)), min_cos_theta_o)) - 2,
                hi = bits(float(std::cos(found.lo))) + 2;
  while (hi - lo > 1) {
    const std::uint32_t middle = lo + (hi - lo) / 2;
    const double theta = std::acos(double(std::bit_cast<float>(middle)));
    const Values at = values_at(field, axis, p, {theta}, host, effort).front();
    const double below = change(at, found.at_hi).relative, above = change(found.at_lo, at).relative;
    if (max(below, above) <= least) break;
    (below >= above ? hi : lo) = middle;
  }
  ThetaJump jump;
  jump.at = float(0.5 * (found.lo + found.hi));
  jump.before = std::acos(double(std::bit_cast<float>(hi)));
  jump.after = std::acos(double(std::bit_cast<float>(lo)));
  return jump;
}

// Where f says that it bends, it may leap by less than what is looked for elsewhere.
void add_leaps_at_knots(const Field& field, const Axis& axis, const Host& host, Effort& effort,
                        std::vector<ThetaJump>& jumps) {
  constexpr double near = 2e-6, least = 3e-4;
  const std::vector<FixedPoint> p = fixed_points(field, axis, 1);
  for (const float knot : field.f.traits().theta_o_knots) {
    const auto at = double(knot);
    const bool known = std::any_of(jumps.begin(), jumps.end(), [&](const ThetaJump& jump) {
      return std::abs(double(jump.at) - at) < near;
    });
    if (known || !(at > 1e-3 && at < axis.hi)) continue;
    std::vector<Values> values = values_at(field, axis, p, {at - near, at + near}, host, effort);
    if (!(change(values[0], values[1]).relative > least)) continue;
    const Bracket bracket{at - near, at + near, std::move(values[0]), std::move(values[1])};
    jumps.push_back(between_floats(field, axis, bracket, least, host, effort));
  }
  std::sort(jumps.begin(), jumps.end(), [](const ThetaJump& a, const ThetaJump& b) { return a.at < b.at; });
}

// Azimuths that f tells of and at which it bends without a leap.
std::vector<float> find_bends(const Field& field, const Axis& axis, const Host& host, Effort& effort) {
  constexpr double near = 2e-6, least = 3e-4;
  const std::vector<FixedPoint> p = fixed_points(field, axis, 1);
  std::vector<float> bends;
  for (const float phi : told_azimuths(field)) {
    const std::vector<Values> v =
        values_at(field, axis, p, {double(phi) - near, double(phi) + near}, host, effort);
    if (change(v[0], v[1]).relative <= least) bends.push_back(phi);
  }
  return bends;
}

}  // namespace

Jumps find_jumps(const Field& field, const Host& host, Effort& effort) {
  constexpr double narrow = 1e-7;  // radians
  Jumps jumps;
  // The normal itself counts: there a viewer loses its azimuth, and the domain is turned by none.
  const Axis theta_o{false, 1e-4, std::acos(double(min_cos_theta_o)) - 1e-4, 128};
  for (const Bracket& b : find_leaps(field, theta_o, narrow, host, effort))
    jumps.theta_o.push_back(between_floats(field, theta_o, b, leap, host, effort));
  add_leaps_at_knots(field, theta_o, host, effort, jumps.theta_o);
  if (field.frame.isotropic()) return jumps;
  // The azimuth of a direction is rounded a few times.
  constexpr double rounded = 1e-6;
  const Axis phi_o{true, 1e-4, double(azimuth_span(field.frame.symmetry)) - 1e-4, 512};
  for (const Bracket& b : find_leaps(field, phi_o, rounded, host, effort))
    jumps.phi_o.push_back(float(0.5 * (b.lo + b.hi)));
  for (const float phi : told_azimuths(field)) jumps.phi_o.push_back(phi);
  std::sort(jumps.phi_o.begin(), jumps.phi_o.end());
  jumps.phi_o_bends = find_bends(field, phi_o, host, effort);
  return jumps;
}

}  // namespace reflectree::detail
