// SPDX-License-Identifier: Apache-2.0
#include "reflectree/study/illumination.hpp"

#include <algorithm>

#include "reflectree/error.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/math/low_discrepancy.hpp"

namespace reflectree::study {

namespace {

constexpr int nodes = 192;
constexpr double first_chord = 1e-3;  // below it C is C(0) to first order
constexpr std::uint32_t pairs = 1U << 14U;

double chord_of_node(int i) {
  return i == 0 ? 0 : first_chord * std::pow(2 / first_chord, (i - 1) / double(nodes - 2));
}

double row_edge(const LatLong& map, int row) { return std::cos(pi_v<double> * row / map.height); }

// Pixels with probability as their power; a direction uniform in the pixel's solid angle.
class BrightDirections {
 public:
  explicit BrightDirections(const LatLong& map) : map_(map), cdf_(map.radiance.size()) {
    double sum = 0;
    for (int r = 0; r < map.height; ++r) {
      const double share = (row_edge(map, r) - row_edge(map, r + 1)) / (2. * map.width);
      for (int c = 0; c < map.width; ++c) {
        const std::size_t i = std::size_t(r) * std::size_t(map.width) + std::size_t(c);
        const double l = double(map.radiance[i]);
        cdf_[i] = sum += l * share;
        square_ += l * l * share;
      }
    }
  }
  double mean() const { return cdf_.back(); }
  double mean_square() const { return square_; }

  Vec3<double> draw(double u, double v) const {
    const double wanted = u * mean();
    const std::size_t i = std::min(
        std::size_t(std::upper_bound(cdf_.begin(), cdf_.end(), wanted) - cdf_.begin()), cdf_.size() - 1);
    const double before = i ? cdf_[i - 1] : 0;
    const double s = clamp((wanted - before) / std::max(cdf_[i] - before, 1e-300), 0., 1.);
    const int row = int(i) / map_.width, column = int(i) % map_.width;
    const double z = linear_mix(v, row_edge(map_, row), row_edge(map_, row + 1));
    const double phi = 2 * pi_v<double> * (column + s) / map_.width, r = std::sqrt(max(0., 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  const LatLong& map_;
  std::vector<double> cdf_;
  double square_ = 0;
};

// One end of the pair is drawn as L; the balance heuristic with the other end (Veach 1997, 9.2.2) keeps the
// summand below 2 min(L, L'), whatever the contrast.
double correlation_at_chord(const LatLong& map, const BrightDirections& bright, double chord,
                            std::uint32_t seed) {
  const double cos_g = 1 - chord * chord / 2, sin_g = std::sqrt(max(0., 1 - cos_g * cos_g));
  double sum = 0;
  for (std::uint32_t i = 0; i < pairs; ++i) {
    const Vec3<double> a = bright.draw(scrambled_sobol(i, 0, seed), scrambled_sobol(i, 1, seed));
    const LocalFrame<double> frame = frame_from_normal(a);
    const double phi = 2 * pi_v<double> * scrambled_sobol(i, 2, seed);
    const Vec3<double> b = cos_g * a + sin_g * (std::cos(phi) * frame.s + std::sin(phi) * frame.t);
    const auto la = double(map.at({float(a.x), float(a.y), float(a.z)}));
    const auto lb = double(map.at({float(b.x), float(b.y), float(b.z)}));
    if (lb > 0 && la > 0) sum += 2 * la * lb / (la + lb);
  }
  return bright.mean() * sum / pairs;
}

template <class Radiance>
LatLong symmetric(const Radiance& radiance) {
  LatLong map{8, 16384, {}};
  for (int r = 0; r < map.height; ++r) {
    const double theta = pi_v<double> * (r + 0.5) / map.height;
    map.radiance.insert(map.radiance.end(), std::size_t(map.width), float(radiance(theta)));
  }
  return map;
}

// CIE standard overcast sky (CIE S 011, 1:2): 1 : 3 from horizon to zenith. The ground reflects a fifth.
double clouded(double theta) {
  const double z = std::cos(theta), above = clamp(0.5 + z / 0.2, 0., 1.);
  return linear_mix(above * above * (3 - 2 * above), 0.2, (1 + 2 * max(z, 0.)) / 3);
}

}  // namespace

float LatLong::at(Direction w) const {
  // asin of the shorter arm keeps the digits near the poles, where a sun may stand.
  const float r = sqrt(w.x * w.x + w.y * w.y);
  const float theta = std::atan2(r, w.z), phi = std::atan2(w.y, w.x);
  const int row = std::clamp(int(theta / pi * float(height)), 0, height - 1);
  const float turn = phi < 0 ? phi / (2 * pi) + 1 : phi / (2 * pi);
  const int column = std::clamp(int(turn * float(width)), 0, width - 1);
  return radiance[std::size_t(row) * std::size_t(width) + std::size_t(column)];
}

double Illumination::correlation_at(double cos_angle) const {
  const double chord = std::sqrt(max(0., 2 - 2 * cos_angle));
  if (chord < first_chord) return linear_mix(chord / first_chord, correlation[0], correlation[1]);
  const double x = std::log(chord / first_chord) / std::log(2 / first_chord) * (nodes - 2);
  const int i = 1 + std::clamp(int(x), 0, nodes - 3);
  const double lo = chord_of_node(i), hi = chord_of_node(i + 1);
  return linear_mix(clamp((chord - lo) / (hi - lo), 0., 1.), correlation[std::size_t(i)],
                    correlation[std::size_t(i) + 1]);
}

Illumination make_illumination(std::string name, LatLong map) {
  const std::string how = "give an equirectangular map of radiance";
  if (map.width < 1 || map.height < 1 ||
      map.radiance.size() != std::size_t(map.width) * std::size_t(map.height)) {
    throw Error("the map has no pixels", name, how);
  }
  for (const float l : map.radiance) {
    if (!(l >= 0) || !isfinite(l)) throw Error("a pixel is negative or not finite", name, how);
  }
  Illumination e;
  e.name = std::move(name);
  e.map = std::move(map);
  const BrightDirections bright(e.map);
  e.mean = bright.mean();
  e.mean_square = bright.mean_square();
  if (!(e.mean > 0)) throw Error("the map is black", e.name, how);
  e.correlation.resize(nodes);
  e.correlation[0] = e.mean_square;
  // Cauchy-Schwarz: C never exceeds C(0); noise of the estimate is not let above it.
  for (int i = 1; i < nodes; ++i) {
    e.correlation[std::size_t(i)] =
        min(e.mean_square, correlation_at_chord(e.map, bright, chord_of_node(i), std::uint32_t(i)));
  }
  return e;
}

std::vector<Illumination> procedural_illuminations() {
  constexpr double degree = pi_v<double> / 180;
  constexpr double light = 5 * degree, sun = 0.27 * degree;
  const LatLong sky = symmetric(clouded);
  const double sky_power = BrightDirections(sky).mean();
  const double sun_radiance = 4 * sky_power * 2 / (1 - std::cos(sun));
  std::vector<Illumination> all;
  all.push_back(make_illumination("light", symmetric([](double theta) { return theta < light ? 1. : 0.; })));
  all.push_back(make_illumination("sky", sky));
  all.push_back(make_illumination(
      "sun", symmetric([&](double theta) { return clouded(theta) + (theta < sun ? sun_radiance : 0.); })));
  return all;
}

}  // namespace reflectree::study
