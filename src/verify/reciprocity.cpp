// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/reciprocity.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "parallel.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

using Pair = std::array<Vec3<double>, 2>;

Vec3<double> random_above(Pcg32& u) {
  const double z = std::sqrt(to_unit_double(u())), phi = 2 * pi_v<double> * to_unit_double(u());
  const double s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), std::max(z, 1e-4)};
}

// Every other pair lies near its mirror pair, at distances spread over the decades: where lobes are.
Pair random_pair(Pcg32& u, bool near_mirror) {
  const Vec3<double> wo = random_above(u);
  if (!near_mirror) return {wo, random_above(u)};
  const LocalFrame<double> frame = frame_from_normal(Vec3<double>{-wo.x, -wo.y, wo.z});
  const double angle = std::pow(10., -3 * to_unit_double(u())), phi = 2 * pi_v<double> * to_unit_double(u());
  Vec3<double> wi = to_world(frame, direction_from_angles(angle, phi));
  wi.z = std::max(std::abs(wi.z), 1e-4);
  return {wo, normalize(wi)};
}

double value(const TargetFunction& f, const Pair& p) {
  double t = 0;
  f.eval(p[0], {&p[1], 1}, {&t, 1});
  return t;
}

template <class Image>
Asymmetry compare(const TargetFunction& f, std::span<const Pair> pairs, const Image& image) {
  Asymmetry result;
  std::vector<double> relative;
  double difference = 0, total = 0;
  for (const Pair& p : pairs) {
    const double a = value(f, p), b = value(f, image(p));
    const double larger = std::max(a, b);
    difference += std::abs(a - b);
    total += a;
    relative.push_back(larger > 0 ? std::abs(a - b) / larger : 0);
  }
  if (relative.empty()) return result;
  const auto middle = relative.begin() + std::ptrdiff_t(relative.size() / 2);
  std::nth_element(relative.begin(), middle, relative.end());
  result.median = *middle;
  result.worst = *std::max_element(relative.begin(), relative.end());
  result.mean = total > 0 ? difference / total : 0;
  return result;
}

Vec3<double> turned(Vec3<double> w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

CheckResult symmetric(const char* name, const Asymmetry& a, double tolerance) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "mean %.3g, median %.3g, worst %.3g", a.mean, a.median, a.worst);
  return {name, a.mean <= tolerance, a.mean, tolerance, 1, buffer};
}

}  // namespace

PhysicsReport measure_physics(const TargetFunction& f, int count, std::uint64_t seed) {
  Pcg32 u = detail::part_generator(seed, 0);
  std::vector<Pair> pairs;
  for (int i = 0; i < count; ++i) pairs.push_back(random_pair(u, i % 2 == 1));
  PhysicsReport report;
  report.reciprocity = compare(f, pairs, [](const Pair& p) { return Pair{p[1], p[0]}; });
  report.isotropy = compare(f, pairs, [&](const Pair& p) {
    const double angle = 2 * pi_v<double> * to_unit_double(u());
    return Pair{turned(p[0], angle), turned(p[1], angle)};
  });
  // About the plane of wo and the normal: y -> -y after turning wo into the x-z plane.
  report.mirror = compare(f, pairs, [](const Pair& p) {
    const double phi = phi_of(p[0]);
    Vec3<double> wi = turned(p[1], -phi);
    wi.y = -wi.y;
    return Pair{p[0], turned(wi, phi)};
  });
  ReferenceOptions options;
  options.relative_tolerance = 1e-4;
  for (const double degrees : {0., 15., 30., 45., 60., 70., 75., 80., 85., 87., 89.}) {
    const double theta = degrees * pi_v<double> / 180;
    const Vec3<double> w = direction_from_angles(theta, 0.);
    const double albedo = reference_albedo(f, {float(w.x), float(w.y), float(w.z)}, options).value;
    if (albedo > report.max_albedo) report.max_albedo = albedo, report.max_albedo_theta_o = theta;
  }
  return report;
}

CheckResult check_isotropy(const PhysicsReport& report, double tolerance) {
  return symmetric("isotropy", report.isotropy, tolerance);
}
CheckResult check_mirror_symmetry(const PhysicsReport& report, double tolerance) {
  return symmetric("mirror_symmetry", report.mirror, tolerance);
}

}  // namespace reflectree
