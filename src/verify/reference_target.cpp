// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/reference_target.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree {
namespace {

ShadingGeometry<float> narrow(const ShadingGeometry<double>& g) {
  const auto vector = [](Vec3<double> v) { return Direction{float(v.x), float(v.y), float(v.z)}; };
  return {vector(g.wo),         vector(g.wi),         vector(g.wh),        float(g.cos_theta_o),
          float(g.cos_theta_i), float(g.cos_theta_h), float(g.cos_theta_d)};
}

}  // namespace

double reference_target(const Target& target, std::span<const float> channels) {
  const auto f = [&](std::size_t c) { return double(target.scale) * double(channels[c]); };
  if (channels.size() == 1) return f(0);
  double squares = 0, sum = 0, largest = 0;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    squares += f(c) * f(c);
    sum += f(c);
    largest = std::max(largest, f(c));
  }
  const double norm = std::sqrt(squares);
  double main = norm;
  switch (target.kind) {
    case TargetKind::norm:
      return norm;
    case TargetKind::luminance:
      main = channels.size() == 3 ? 0.2126 * f(0) + 0.7152 * f(1) + 0.0722 * f(2)
                                  : sum / double(channels.size());
      break;
    case TargetKind::maximum:
      main = largest;
      break;
    case TargetKind::channel:
      main = f(std::min<std::size_t>(target.index, channels.size() - 1));
      break;
  }
  return 0.99 * main + 0.01 * norm;
}

void channel_values(const AnyBrdf& f, Vec3<double> wo, std::span<const Vec3<double>> wi,
                    std::span<float> out) {
  const auto channels = std::size_t(f.channels());
  std::vector<ShadingGeometry<float>> geometry;
  std::vector<std::size_t> place;
  geometry.reserve(wi.size());
  place.reserve(wi.size());
  std::fill(out.begin(), out.end(), 0.f);
  for (std::size_t i = 0; i < wi.size(); ++i) {
    if (!(wo.z > 0) || !(wi[i].z > 0)) continue;
    const ShadingGeometry<float> g = narrow(shading_geometry(wo, wi[i]));
    if (!(g.cos_theta_i > 0)) continue;
    geometry.push_back(g);
    place.push_back(i);
  }
  std::vector<float> values(geometry.size() * channels);
  f.eval(geometry, values);
  for (std::size_t k = 0; k < place.size(); ++k) {
    std::copy_n(values.data() + k * channels, channels, out.data() + place[k] * channels);
  }
}

TargetFunction combined_channels(AnyBrdf f, std::vector<double> coefficients) {
  TargetFunction result;
  result.concurrent = f.traits().concurrent;
  result.patches = f.traits().patches;
  result.eval = [f = std::move(f), coefficients = std::move(coefficients)](
                    Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> t) {
    const auto channels = std::size_t(f.channels());
    std::vector<float> values(wi.size() * channels);
    channel_values(f, wo, wi, values);
    for (std::size_t i = 0; i < wi.size(); ++i) {
      t[i] = 0;
      for (std::size_t c = 0; c < channels; ++c) t[i] += coefficients[c] * double(values[i * channels + c]);
    }
  };
  return result;
}

}  // namespace reflectree
