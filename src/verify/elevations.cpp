// SPDX-License-Identifier: Apache-2.0
#include "elevations.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::detail {
namespace {

constexpr double largest_theta = 89.9 / 180 * pi_v<double>;

double any_azimuth(Pcg32& u) { return 2 * pi_v<double> * to_unit_double(u()); }

}  // namespace

Direction viewer(double cos_theta, double phi) {
  const double s = std::sqrt(std::max(1 - cos_theta * cos_theta, 0.));
  return {float(s * std::cos(phi)), float(s * std::sin(phi)), float(cos_theta)};
}

Direction random_viewer(Pcg32& u) {
  const double theta = largest_theta * to_unit_double(u());
  return viewer(std::cos(theta), any_azimuth(u));
}

std::vector<Direction> stratified_viewers(std::size_t count, Pcg32& u) {
  std::vector<Direction> viewers;
  for (std::size_t i = 0; i < count; ++i) {
    const double theta = largest_theta * (double(i) + to_unit_double(u())) / double(count);
    viewers.push_back(viewer(std::cos(theta), any_azimuth(u)));
  }
  return viewers;
}

std::vector<Direction> border_viewers(const PackedSampler& packed, std::size_t count, Pcg32& u) {
  std::vector<Direction> viewers;
  for (const PackedForest* forest : {&packed.exact, &packed.one_shot}) {
    if (!forest->tree.empty()) continue;  // borders of anisotropic samplers are met at random
    const std::vector<float>& all = forest->lookup.borders();
    // Without the ends: the horizon, and what closes the list above 1.
    std::vector<float> borders(all.begin() + 1, all.end() - 1);
    while (borders.size() > count) {
      borders.erase(borders.begin() + std::ptrdiff_t(std::size_t(u()) % borders.size()));
    }
    for (const float c : borders) {
      const double away = 4e-7 * double(c);
      viewers.push_back(viewer(double(c) - away, any_azimuth(u)));
      viewers.push_back(viewer(std::min(double(c) + away, 1.), any_azimuth(u)));
    }
  }
  return viewers;
}

std::vector<double> table_places(const PackedSampler& packed, std::size_t count, Pcg32& u) {
  const std::vector<float>& borders = packed.viewer.albedo.lookup.borders();
  std::vector<double> nodes(borders.begin(), borders.end());
  nodes.back() = 1;
  struct Place {
    double bend, cosine;
  };
  std::vector<Place> places;
  const auto albedo = [&](std::size_t i) { return double(packed.viewer.albedo.at(float(nodes[i]))); };
  // Two nodes closer than the rounding of a direction are the sides of a jump: each is looked
  // at from further away.
  const auto jump_after = [&](std::size_t i) {
    return i + 1 < nodes.size() && nodes[i + 1] - nodes[i] < 1.5e-7 * nodes[i];
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    double bend = 0;
    if (i > 0 && i + 1 < nodes.size()) {
      const double t = (nodes[i] - nodes[i - 1]) / (nodes[i + 1] - nodes[i - 1]);
      const double line = (1 - t) * albedo(i - 1) + t * albedo(i + 1);
      bend = std::abs(albedo(i) - line) / std::max(albedo(i), 1e-30);
    }
    const double away = 4e-7 * nodes[i];
    const bool below = jump_after(i), above = i > 0 && jump_after(i - 1);
    places.push_back({bend, below ? nodes[i] - away : above ? nodes[i] + away : nodes[i]});
    if (i + 1 < nodes.size() && !below) places.push_back({bend, 0.5 * (nodes[i] + nodes[i + 1])});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.bend > b.bend; });
  for (std::size_t i = count / 2; i + 1 < places.size(); ++i) {
    std::swap(places[i], places[i + std::size_t(u()) % (places.size() - i)]);
  }
  if (places.size() > count) places.resize(count);
  std::vector<double> cosines;
  for (const Place& p : places) cosines.push_back(p.cosine);
  return cosines;
}

}  // namespace reflectree::detail
