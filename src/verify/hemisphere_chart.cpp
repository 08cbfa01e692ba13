// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/hemisphere_chart.hpp"

#include <algorithm>

namespace reflectree {
namespace {

// distance(v) = finest (e^(folds v) - 1) grows from 0 to its largest value as v goes from 0 to 1. The
// finest scales are below the width of any lobe that float directions can hold: in azimuth, a lobe of
// half-angle width alpha at elevation theta has width 2 alpha cos theta.
constexpr double finest_phi = 1e-8, finest_theta = 1e-6;
constexpr double half_pi = pi_v<double> / 2;

double folds_of(double largest, double finest) { return std::log1p(largest / finest); }
double distance(double v, double folds, double finest) { return finest * std::expm1(folds * v); }
double slope(double v, double folds, double finest) { return finest * folds * std::exp(folds * v); }
double grade(double d, double folds, double finest) {
  return folds > 0 ? std::clamp(std::log1p(d / finest) / folds, 0., 1.) : 0;
}

}  // namespace

HemisphereChart::HemisphereChart(Vec3<double> centre) {
  const double r = std::hypot(centre.x, centre.y);
  azimuth_ = r > 0 ? Vec2<double>{centre.x / r, centre.y / r} : Vec2<double>{1, 0};
  theta_ = std::atan2(r, std::max(centre.z, 0.));
  grade_phi_ = folds_of(half_pi, finest_phi);
  grade_lo_ = folds_of(theta_, finest_theta);
  grade_hi_ = folds_of(std::atan2(std::max(centre.z, 0.), r), finest_theta);
}

HemisphereChart HemisphereChart::projected_disk() {
  HemisphereChart chart({0, 0, 1});
  chart.disk_ = true;
  return chart;
}

HemisphereChart::Point HemisphereChart::direction(Vec2<double> p) const {
  if (disk_) {
    const double phi = half_pi * p.x, sin2 = 0.5 * p.y, r = std::sqrt(sin2);
    const double z = std::max(std::sqrt(1 - sin2), 1e-160);
    return {{r * std::cos(phi), r * std::sin(phi), z}, pi_v<double> / (8 * z)};
  }
  const int quarter = std::clamp(int(p.x), 0, 3);
  const bool opposite = quarter == 1 || quarter == 2, back = quarter == 1 || quarter == 3;
  const double v = back ? quarter + 1 - p.x : p.x - quarter;
  const double delta = distance(v, grade_phi_, finest_phi);
  const double cos_phi = opposite ? -std::cos(delta) : std::cos(delta);
  const double sin_phi = quarter < 2 ? std::sin(delta) : -std::sin(delta);

  const bool low = p.y < 1;
  const double s = low ? 1 - p.y : p.y - 1, folds = low ? grade_lo_ : grade_hi_;
  const double d = distance(s, folds, finest_theta);
  const double theta = low ? std::max(theta_ - d, 0.) : theta_ + d;
  // The cosine of the complement: exact next to the horizon.
  const double sin_theta = std::sin(theta), cos_theta = std::max(std::sin(half_pi - theta), 0.);
  return {{sin_theta * (cos_phi * azimuth_.x - sin_phi * azimuth_.y),
           sin_theta * (cos_phi * azimuth_.y + sin_phi * azimuth_.x), cos_theta},
          sin_theta * slope(v, grade_phi_, finest_phi) * slope(s, folds, finest_theta)};
}

Vec2<double> HemisphereChart::coordinates(Vec3<double> w) const {
  if (disk_) {
    const double quarters = std::atan2(w.y, w.x) / half_pi;
    return {quarters < 0 ? quarters + 4 : quarters, 2 * (1 - sqr(w.z))};
  }
  const double along = w.x * azimuth_.x + w.y * azimuth_.y, across = w.y * azimuth_.x - w.x * azimuth_.y;
  const double v = grade(std::atan2(std::abs(across), std::abs(along)), grade_phi_, finest_phi);
  const double x = across >= 0 ? (along >= 0 ? v : 2 - v) : (along >= 0 ? 4 - v : 2 + v);
  const double d = std::atan2(std::hypot(w.x, w.y), w.z) - theta_;
  const double y = d < 0 ? 1 - grade(-d, grade_lo_, finest_theta) : 1 + grade(d, grade_hi_, finest_theta);
  return {x, y};
}

}  // namespace reflectree
