// SPDX-License-Identifier: Apache-2.0
#include "random_function.hpp"

#include <cmath>
#include <cstdio>

#include "reflectree/math/random.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree::study {

namespace {

// wi as seen by a viewer whose azimuth is 0, on one side of the plane of incidence.
Direction folded(Direction wo, Direction wi) {
  const float s = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const float c = s > 0 ? wo.x / s : 1, t = s > 0 ? wo.y / s : 0;
  return {wi.x * c + wi.y * t, std::abs(wi.y * c - wi.x * t), wi.z};
}

float at_distance(const RandomLobe& lobe, float squared) {
  const float w2 = lobe.width * lobe.width;
  if (lobe.disc) return squared < w2 ? lobe.height : 0.f;
  return lobe.height * std::exp(-squared / w2);
}

// The mean of max(z, 0) over the circle at the angle gamma about a centre of elevation cosine `cz`, times 2 pi.
double circle(double cz, double gamma) {
  const double a = std::cos(gamma) * cz, b = std::sin(gamma) * std::sqrt(std::max(1 - cz * cz, 0.));
  if (a >= b) return 2 * pi_v<double> * a;
  if (a <= -b) return 0;
  const double phi = std::acos(-a / b);
  return 2 * (a * phi + b * std::sin(phi));
}

}  // namespace

float RandomLobe::operator()(Direction wo, Direction wi) const {
  const auto squared = [](Direction a, Direction b) {
    const Direction d = a - b;
    return dot(d, d);
  };
  if (place == Place::mirror) return at_distance(*this, squared(wi, {-wo.x, -wo.y, wo.z}));
  if (place == Place::back) return at_distance(*this, squared(wi, wo));
  return at_distance(*this, squared(folded(wo, wi), direction_from_angles(theta, phi)));
}

double RandomLobe::albedo(Direction wo) const {
  const bool fixed = place == Place::fixed;
  const double cz = fixed ? std::cos(double(theta)) : double(wo.z), w = double(width);
  // Up to where nothing is left, or to the edge; a chord d spans 2 asin(d / 2).
  const double end = 2 * std::asin(std::min(disc ? w / 2 : 4 * w, 1.));
  const auto integrand = [&](double gamma) {
    const double d = 2 * std::sin(gamma / 2);
    return (disc ? 1 : std::exp(-d * d / (w * w))) * std::sin(gamma) * circle(cz, gamma);
  };
  // Simpson's rule on both sides of the circle that touches the horizon.
  const double touch = std::min(std::asin(cz), end);
  double sum = 0;
  for (const auto& [lo, hi] : {std::pair{0., touch}, {touch, end}}) {
    constexpr int n = 2000;
    const double h = (hi - lo) / n;
    for (int i = 0; i <= n; ++i)
      sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * h / 3 * integrand(lo + i * h);
  }
  return double(height) * sum * (fixed ? 2 : 1);
}

float RandomFunction::operator()(Direction wo, Direction wi) const {
  float sum = ground;
  for (const RandomLobe& lobe : lobes) sum += lobe(wo, wi);
  return sum;
}

double RandomFunction::albedo(Direction wo) const {
  double sum = pi_v<double> * double(ground);
  for (const RandomLobe& lobe : lobes) sum += lobe.albedo(wo);
  return sum;
}

std::string RandomFunction::words() const {
  char text[128];
  std::snprintf(text, sizeof text, "ground %.3g", double(ground));
  std::string all = text;
  constexpr double degrees = 180 / pi_v<double>;
  for (const RandomLobe& lobe : lobes) {
    const char* shape = lobe.disc ? "disc" : "bump";
    const char* where = lobe.place == RandomLobe::Place::mirror ? "about the mirror direction"
                        : lobe.place == RandomLobe::Place::back ? "about wo"
                                                                : "at";
    std::snprintf(text, sizeof text, "; %s of %.3g, %.3g, %s", shape, double(lobe.width), double(lobe.height),
                  where);
    all += text;
    if (lobe.place != RandomLobe::Place::fixed) continue;
    std::snprintf(text, sizeof text, " %.1f, %.1f degrees", double(lobe.theta) * degrees,
                  double(lobe.phi) * degrees);
    all += text;
  }
  return all;
}

RandomFunction random_function(std::uint64_t seed) {
  Pcg32 u(seed, 41);
  const auto uniform = [&u](double lo, double hi) { return lo + (hi - lo) * to_unit_double(u()); };
  const auto spread = [&uniform](double lo, double hi) {
    return lo * std::exp(uniform(0, std::log(hi / lo)));
  };
  RandomFunction f{float(spread(0.01, 0.3)), {}};
  const int count = 1 + int(uniform(0, 4));
  for (int i = 0; i < count; ++i) {
    RandomLobe lobe{};
    const double place = uniform(0, 1);
    lobe.place = place < 0.5   ? RandomLobe::Place::fixed
                 : place < 0.8 ? RandomLobe::Place::mirror
                               : RandomLobe::Place::back;
    lobe.disc = uniform(0, 1) < 0.2;
    lobe.width = float(spread(lobe.disc ? 0.02 : 0.004, 0.6));
    // What stands still is whole, on its side of the plane of incidence.
    lobe.theta = float(uniform(0.1, 1.45)), lobe.phi = float(uniform(0.2, 2.9));
    const double clear = std::sin(double(lobe.theta)) * std::sin(double(lobe.phi));
    if (lobe.place == RandomLobe::Place::fixed)
      lobe.width = float(std::min(double(lobe.width), 0.25 * clear));
    const double share = spread(1e-3, 3);  // of the ground's albedo, where the lobe is at the normal
    lobe.height = float(share * double(f.ground) / sqr(double(lobe.width)));
    f.lobes.push_back(lobe);
  }
  return f;
}

}  // namespace reflectree::study
