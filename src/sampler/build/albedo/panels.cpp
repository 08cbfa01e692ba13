// SPDX-License-Identifier: Apache-2.0
#include "panels.hpp"

#include <cmath>

namespace reflectree::detail {

double node_of(const Panel& p, int i) {
  return i == 0 ? p.lo : i == 4 ? p.hi : p.lo + 0.25 * i * (p.hi - p.lo);
}
float cosine_of(double theta) { return clamp(float(std::cos(theta)), min_cos_theta_o, 1.f); }

double interpolate(const std::array<double, 5>& v, int step, double t) {
  double sum = 0;
  for (int i = 0; i < 5; i += step) {
    double basis = 1;
    for (int j = 0; j < 5; j += step) {
      if (j != i) basis *= (t - j) / (i - j);
    }
    sum += basis * v[std::size_t(i)];
  }
  return sum;
}

namespace {

// Appends the entries of the panel after `lo`, halving until lines in the cosine miss the polynomial times
// the factor by at most `error`, relatively.
void tabulate_part(const Panel& panel, const std::array<double, 5>& v, const Factor& factor, double t0,
                   double t1, double error, int depth, std::map<float, double>& table) {
  const auto theta_at = [&](double t) { return panel.lo + 0.25 * t * (panel.hi - panel.lo); };
  const auto cosine_at = [&](double t) { return std::cos(theta_at(t)); };
  const auto albedo = [&](double t) { return interpolate(v, 1, t) * factor(theta_at(t)); };
  const double a0 = albedo(t0), a1 = albedo(t1), c0 = cosine_at(t0), c1 = cosine_at(t1);
  const double mid = 0.5 * (t0 + t1);
  bool good = true;  // at the quarters too: a kink may meet the line in the middle
  for (const double t : {mid, 0.5 * (t0 + mid), 0.5 * (mid + t1)}) {
    const double line = a0 + (cosine_at(t) - c0) / (c1 - c0) * (a1 - a0), curve = albedo(t);
    good = good && std::abs(line - curve) <= error * curve;
  }
  if (depth > 0 && !good) {
    tabulate_part(panel, v, factor, t0, mid, error, depth - 1, table);
    tabulate_part(panel, v, factor, mid, t1, error, depth - 1, table);
    return;
  }
  // Near the normal floats of the cosine are far apart in theta_o: there the entry is that of the float.
  const float entry = cosine_of(theta_at(t1));
  const double theta = std::acos(double(entry));
  const double at_entry = albedo(clamp(4 * (theta - panel.lo) / (panel.hi - panel.lo), 0., 4.));
  table[entry] = max(std::abs(at_entry - a1) > error * a1 ? at_entry : a1, 0.);
}

}  // namespace

void tabulate(const Panel& panel, const std::array<double, 5>& values, const Factor& factor, double error,
              std::map<float, double>& table) {
  tabulate_part(panel, values, factor, 0, 4, error, 8, table);
}

std::vector<double> first_borders(const BrdfTraits& traits) {
  // Panels of at most 7.5 degrees, and octaves towards the horizon. Where a mirror lobe passes the kinks of a
  // table over the difference angle, a panel begins at every second kink: the one between is met by the
  // middle node, and the parabola shows what it weighs.
  constexpr std::size_t steps = 12;
  const std::vector<float>& kinks = traits.theta_d_knots;
  // Then panels are narrower than the steps. Of anisotropic functions integrals are dear.
  const bool dense =
      kinks.size() >= 2 * steps || (!traits.isotropic && traits.theta_o_knots.size() >= steps);
  std::vector<double> borders;
  for (std::size_t i = 0; i < (dense ? 1 : steps); ++i)
    borders.push_back(double(i) * 7.5 * pi_v<double> / 180);
  for (std::size_t i = 0; i < kinks.size(); i += 2) borders.push_back(double(kinks[i]));
  for (const double near : {0.5, 1.5, 3.75})
    borders.push_back(near * pi_v<double> / 180);  // kinks of tables crowd
  for (const int octave : {4, 5, 7, 10, 13, 17}) borders.push_back(std::acos(std::ldexp(1., -octave)));
  for (const float theta : traits.theta_o_knots) {
    if (theta > 1e-3f && cos(theta) > 1.5f * min_cos_theta_o) borders.push_back(double(theta));
  }
  return borders;
}

}  // namespace reflectree::detail
