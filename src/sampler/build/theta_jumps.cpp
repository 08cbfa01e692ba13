// SPDX-License-Identifier: Apache-2.0
#include "theta_jumps.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t points = 128;
constexpr double leap = 0.02;    // of the values' sum, to be a jump
constexpr double narrow = 1e-7;  // radians

// Fixed points of the square, each with an azimuth of the viewer: half of them spread, half of them drawn to
// the pole, where lobes are.
struct FixedPoint {
  Vec2<float> p;
  float phi_o;
  Coordinates at;
};
std::vector<FixedPoint> fixed_points(const Field& field, std::uint64_t seed) {
  const Domain& domain = field.domain;
  Pcg32 u(seed, 17), around(seed, 18);
  const float span = azimuth_span(field.frame.symmetry);
  std::vector<FixedPoint> p;
  for (std::size_t i = 0; i < points; ++i) {
    float y = to_unit_float(u());
    if (i % 2) y = std::pow(10.f, -3 * y);
    const Vec2<float> at{2 * to_unit_float(u()) - 1, domain.half() || u() % 2 ? y : -y};
    const float phi_o = span * to_unit_float(around());
    Coordinates member{};
    for (std::size_t k = 0; k < field.parameters.size(); ++k) {
      const KnownParameter& q = field.parameters[k];
      member[k] = linear_mix(to_unit_float(around()), lowest(q), highest(q));
    }
    p.push_back({at, phi_o, member});
  }
  return p;
}

using Values = std::vector<float>;

// T at the points for every theta_o.
std::vector<Values> values_at(const Field& field, const std::vector<FixedPoint>& p,
                              const std::vector<double>& thetas, const Host& host, Effort& effort) {
  std::vector<FieldPoint> all;
  for (const double theta : thetas) {
    const Direction wo = wo_from_cosine(clamp(float(std::cos(theta)), min_cos_theta_o, 1.f));
    for (const FixedPoint& q : p) all.push_back({turned_to(wo, q.phi_o), q.p, q.at});
  }
  std::vector<FieldValue> values(all.size());
  eval_in_parallel(field, host, effort, all, values);
  std::vector<Values> result(thetas.size(), Values(p.size()));
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

}  // namespace

std::vector<float> find_theta_jumps(const Field& field, const Host& host, Effort& effort) {
  constexpr int intervals = 128;
  const double last = std::acos(double(min_cos_theta_o)) - 1e-4;
  const std::vector<FixedPoint> p = fixed_points(field, 1);
  std::vector<double> thetas;
  for (int i = 0; i <= intervals; ++i) thetas.push_back(1e-4 + (last - 1e-4) * i / intervals);
  const std::vector<Values> values = values_at(field, p, thetas, host, effort);
  std::vector<Bracket> open;
  for (std::size_t i = 0; i + 1 < thetas.size(); ++i) {
    if (change(values[i], values[i + 1]).relative > leap)
      open.push_back({thetas[i], thetas[i + 1], values[i], values[i + 1]});
  }
  // What is continuous changes by half as much in half of an interval, and drops out.
  while (!open.empty() && open.front().hi - open.front().lo > narrow) {
    std::vector<double> middles;
    for (const Bracket& b : open) middles.push_back(0.5 * (b.lo + b.hi));
    const std::vector<Values> at = values_at(field, p, middles, host, effort);
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
  const std::vector<FixedPoint> fresh = fixed_points(field, 2);
  std::vector<double> sides;
  for (const Bracket& b : open) sides.push_back(b.lo - narrow), sides.push_back(b.hi + narrow);
  const std::vector<Values> at = values_at(field, fresh, sides, host, effort);
  std::vector<float> jumps;
  for (std::size_t k = 0; k < open.size(); ++k) {
    const Change c = change(at[2 * k], at[2 * k + 1]);
    if (c.relative > leap && c.leaps >= 3) jumps.push_back(float(0.5 * (open[k].lo + open[k].hi)));
  }
  std::sort(jumps.begin(), jumps.end());
  return jumps;
}

}  // namespace reflectree::detail
