// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/tabulate.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree {
namespace {

void raise(std::vector<float>& table, float floor) {
  double sum = 0;
  for (const float v : table) sum += double(v);
  const float least = floor * float(sum / double(table.size()));
  for (float& v : table) v = std::max(v, least);
}

}  // namespace

void chart_target(const AnyBrdf& f, Target target, SquareChart chart, float theta_o,
                  std::span<const Vec2<float>> points, std::span<float> out, float phi_o) {
  const Direction wo = direction_from_angles(theta_o, 0.f);
  const auto channels = std::size_t(f.channels());
  std::vector<Direction> from(points.size(), wo), to(points.size());
  std::vector<float> factor(points.size()), value(points.size() * channels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ChartPoint point = chart_point(chart, wo, points[i]);
    to[i] = point.wi;
    factor[i] = std::max(point.wi.z, 0.f) * point.jacobian;
  }
  if (phi_o != 0) {
    const AzimuthFrame frame({std::cos(phi_o), std::sin(phi_o), 0});
    std::fill(from.begin(), from.end(), frame.to_world(wo));
    for (Direction& w : to) w = frame.to_world(w);
  }
  f.eval(from, to, value);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float t = factor[i] > 0 ? factor[i] * target(value.data() + i * channels, f.channels()) : 0.f;
    out[i] = std::isfinite(t) && t > 0 ? t : 0.f;
  }
}

std::vector<float> chart_nodes(const AnyBrdf& f, Target target, SquareChart chart, float theta_o, int width,
                               int height, float floor, float phi_o) {
  std::vector<Vec2<float>> points;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      points.push_back({float(x) / float(width - 1), float(y) / float(height - 1)});
  }
  std::vector<float> table(points.size());
  chart_target(f, target, chart, theta_o, points, table, phi_o);
  raise(table, floor);
  return table;
}

std::vector<float> chart_cells(const AnyBrdf& f, Target target, SquareChart chart, float theta_o, int width,
                               int height, float floor, float phi_o) {
  std::vector<Vec2<float>> points;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < 4; ++k) {
        points.push_back({(float(x) + (k % 2 ? 0.75f : 0.25f)) / float(width),
                          (float(y) + (k / 2 ? 0.75f : 0.25f)) / float(height)});
      }
    }
  }
  std::vector<float> fine(points.size()), table(points.size() / 4);
  chart_target(f, target, chart, theta_o, points, fine, phi_o);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = 0.25f * (fine[4 * i] + fine[4 * i + 1] + fine[4 * i + 2] + fine[4 * i + 3]);
  }
  raise(table, floor);
  return table;
}

std::vector<float> slice_angles(int count) {
  std::vector<float> angles;
  for (int i = 0; i < count; ++i) {
    const float rest = 1 - float(i) / float(count - 1);
    angles.push_back(min(0.5f * pi * (1 - rest * std::sqrt(rest)), 0.5f * pi - 1e-4f));
  }
  return angles;
}

}  // namespace reflectree
