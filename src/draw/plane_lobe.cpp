// SPDX-License-Identifier: Apache-2.0
// The band about the plane of incidence: what the target expects there and what was sampled.
#include <algorithm>
#include <cmath>

#include "reflectree/draw/material_figures.hpp"

namespace reflectree::draw {

namespace {

constexpr double deg = pi_v<double> / 180;

// In-plane angle (from the normal, positive towards +x) and latitude about the x-z plane.
Direction in_plane(double angle, double latitude) {
  const double c = std::cos(latitude);
  return {float(c * std::sin(angle)), float(std::sin(latitude)), float(c * std::cos(angle))};
}

}  // namespace

double PlaneHistogram::density_per_count() const {
  // Solid angle of a bin: the integral of cos(latitude) over the band times the angle.
  const double solid_angle = 2 * std::sin(half_width_deg * deg) * bin_deg * deg;
  return samples > 0 ? 1 / (samples * solid_angle) : 0;
}

PlaneHistogram plane_histogram(std::span<const Direction> samples) {
  PlaneHistogram h;
  h.samples = double(samples.size());
  const double limit = std::sin(PlaneHistogram::half_width_deg * deg);
  for (const Direction& wi : samples) {
    if (std::abs(double(wi.y)) > limit || wi.z < 0) continue;
    const double angle = std::atan2(double(wi.x), double(wi.z)) / deg;
    const int bin = std::clamp(int((angle + 90) / PlaneHistogram::bin_deg), 0, PlaneHistogram::bins - 1);
    h.count[std::size_t(bin)] += 1;
  }
  return h;
}

PlaneLobe plane_lobe(const AnyBrdf& f, const Target& target, Direction wo, double albedo) {
  constexpr int across = 24, fine = 2, steps = PlaneHistogram::bins;  // points 0.25 degrees apart
  const int channels = f.channels();
  std::vector<Direction> same, wi;
  std::vector<double> weight;
  for (int i = 0; i < steps * fine; ++i) {
    for (int k = 0; k < across; ++k) {
      const double latitude = PlaneHistogram::half_width_deg * deg * ((k + 0.5) * 2 / across - 1);
      wi.push_back(in_plane(((i + 0.5) / (steps * fine) - 0.5) * pi_v<double>, latitude));
      weight.push_back(std::cos(latitude));
    }
  }
  same.assign(wi.size(), wo);
  std::vector<float> values(wi.size() * std::size_t(channels));
  f.eval(same, wi, values);
  PlaneLobe lobe;
  for (int i = 0; i < steps; ++i) {
    double sum = 0, weights = 0;
    for (int k = 0; k < fine * across; ++k) {
      const auto j = std::size_t(i * fine * across + k);
      sum +=
          weight[j] * double(target(values.data() + j * std::size_t(channels), channels)) * double(wi[j].z);
      weights += weight[j];
    }
    lobe.angle.push_back(((i + 0.5) / steps - 0.5) * 180);
    lobe.density.push_back(albedo > 0 ? sum / weights / albedo : 0);
  }
  return lobe;
}

std::vector<PlaneBar> plane_bars(const PlaneHistogram& histogram, const PlaneLobe& lobe,
                                 double least_expected) {
  const double one = histogram.density_per_count();
  std::vector<PlaneBar> bars;
  std::size_t first = 0;
  double count = 0, expected = 0;
  for (std::size_t i = 0; i < histogram.count.size(); ++i) {
    count += histogram.count[i];
    expected += one > 0 ? lobe.density[i] / one : 0;
    const std::size_t width = i + 1 - first;
    const bool last = i + 1 == histogram.count.size();
    if (expected < least_expected && double(width) * PlaneHistogram::bin_deg < 10 && !last) continue;
    bars.push_back({double(first) * PlaneHistogram::bin_deg - 90,
                    double(i + 1) * PlaneHistogram::bin_deg - 90, count, expected, one / double(width)});
    first = i + 1;
    count = expected = 0;
  }
  return bars;
}

}  // namespace reflectree::draw
