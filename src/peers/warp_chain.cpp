// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/warp_chain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reflectree/peers/sliced_density.hpp"
#include "reflectree/peers/tabulate.hpp"

namespace reflectree {
namespace {

constexpr int ndf_size = 256, wide_ndf_size = 64, wide_ndf_azimuths = 96;

// int_0^2pi max(0, wo . wm) dphi for elevations o and m.
double mean_clamped_cosine(double o, double m) {
  const double a = std::cos(o) * std::cos(m), b = std::sin(o) * std::sin(m), full = 2 * double(pi);
  if (a >= b) return full * a;
  const double phi = std::acos(std::max(-a / b, -1.0));
  return 2 * (a * phi + b * std::sin(phi));
}

}  // namespace

std::vector<float> retro_normals(const AnyBrdf& f, Target target, int count) {
  const auto n = std::size_t(count);
  std::vector<Direction> w(n);
  std::vector<double> theta(n), measure(n), retro(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = double(i) / double(n - 1);
    theta[i] = std::min(0.5 * double(pi) * x * x, 0.5 * double(pi) - 1e-4);
    measure[i] = std::sin(theta[i]) * double(pi) * x / double(n - 1);
    w[i] = direction_from_angles(float(theta[i]), 0.f);
  }
  const auto channels = std::size_t(f.channels());
  std::vector<float> value(n * channels);
  f.eval(w, w, value);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = double(target(value.data() + i * channels, f.channels())) * std::cos(theta[i]);
    retro[i] = std::isfinite(t) && t > 0 ? t : 0;
  }
  // f(w, w) cos theta = F D(w) / (4 sigma(w)), so D is an eigenvector of f cos theta int <w, m> D(m).
  // Four steps are enough (Dupuy and Jakob 2018, section 4).
  std::vector<double> d(n, 1.0), next(n);
  for (int step = 0; step < 4; ++step) {
    double area = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double sigma = 0;
      for (std::size_t k = 0; k < n; ++k)
        sigma += mean_clamped_cosine(theta[i], theta[k]) * d[k] * measure[k];
      next[i] = retro[i] * sigma;
      area += 2 * double(pi) * std::cos(theta[i]) * next[i] * measure[i];
    }
    if (!(area > 0)) return std::vector<float>(n, 1 / pi);  // no retro-reflection: every normal alike
    for (std::size_t i = 0; i < n; ++i) d[i] = next[i] / area;
  }
  return {d.begin(), d.end()};
}

float RetroNormals::at(float x, float phi) const {
  const float along = x * float(count - 1);
  const auto k = std::size_t(std::min(int(along), count - 2)), row = std::size_t(count);
  const auto of = [&](std::size_t azimuth) {
    return linear_mix(along - float(k), d[azimuth * row + k], d[azimuth * row + k + 1]);
  };
  if (azimuths == 1) return of(0);
  const AzimuthPosition p = locate_azimuth(std::size_t(azimuths), {std::cos(phi), std::sin(phi), 0});
  return linear_mix(p.t, of(p.below), of(p.above));
}

RetroNormals retro_normals_around(const AnyBrdf& f, Target target, int count, int azimuths) {
  const auto n = std::size_t(count) * std::size_t(azimuths);
  std::vector<Direction> w(n);
  std::vector<float> measure(n), value(n * std::size_t(f.channels()));
  for (std::size_t i = 0; i < n; ++i) {
    const float x = float(i % std::size_t(count)) / float(count - 1);
    const float theta = std::min(0.5f * pi * x * x, 0.5f * pi - 1e-4f);
    w[i] = direction_from_angles(theta, azimuth_of(i / std::size_t(count), std::size_t(azimuths)));
    measure[i] = std::sin(theta) * pi * x / float(count - 1) * 2 * pi / float(azimuths);
  }
  f.eval(w, w, value);
  std::vector<float> retro(n), d(n, 1.f), next(n), weighted(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float t = target(value.data() + i * std::size_t(f.channels()), f.channels()) * w[i].z;
    retro[i] = std::isfinite(t) && t > 0 ? t : 0;
  }
  for (int step = 0; step < 4; ++step) {  // as for isotropic functions
    for (std::size_t k = 0; k < n; ++k) weighted[k] = d[k] * measure[k];
    double area = 0;
    for (std::size_t i = 0; i < n; ++i) {
      float sigma = 0;
      for (std::size_t k = 0; k < n; ++k) sigma += weighted[k] * max(dot(w[i], w[k]), 0.f);
      next[i] = retro[i] * sigma;
      area += double(w[i].z) * double(next[i]) * double(measure[i]);
    }
    if (!(area > 0)) return {count, azimuths, std::vector<float>(n, 1 / pi)};
    for (std::size_t i = 0; i < n; ++i) d[i] = float(double(next[i]) / area);
  }
  return {count, azimuths, std::move(d)};
}

std::vector<WarpSlice> fit_warp_chain(const AnyBrdf& f, Target target, const std::vector<float>& theta_o,
                                      const WarpOptions& options, const Host& host, std::size_t azimuths) {
  const int warp_width = options.normals_width, warp_height = options.normals_height,
            target_size = options.target_nodes;
  const RetroNormals d = azimuths == 1 ? RetroNormals{ndf_size, 1, retro_normals(f, target, ndf_size)}
                                       : retro_normals_around(f, target, wide_ndf_size, wide_ndf_azimuths);
  std::vector<std::optional<WarpSlice>> made(azimuths * theta_o.size());
  const auto fit = [&](std::size_t i) {
    const float theta = theta_o[i % theta_o.size()], phi = azimuth_of(i / theta_o.size(), azimuths);
    const Direction wo = direction_from_angles(theta, 0.f);
    std::vector<float> visible;
    for (int y = 0; y < warp_height; ++y) {
      for (int x = 0; x < warp_width; ++x) {
        const Vec2<float> p{float(x) / float(warp_width - 1), float(y) / float(warp_height - 1)};
        // The Jacobian of the reflection is 4 (wo . wm): what is left of it is <wo, m> dm, up to a factor.
        visible.push_back(chart_point(SquareChart::half_vector, wo, p).jacobian *
                          d.at(p.x, phi + 2 * pi * (p.y - 0.5f)));
      }
    }
    BilinearTable normals(visible, warp_width, warp_height);
    const BilinearTable::Pair warp{normals, normals, 0.f};
    std::vector<Vec2<float>> points;
    for (int y = 0; y < target_size; ++y) {
      for (int x = 0; x < target_size; ++x) {
        // Just inside: at the very border the density of visible normals is zero.
        const auto inside = [target_size](int j) {
          return std::clamp(double(j) / (target_size - 1), 1e-4, 1 - 1e-4);
        };
        points.push_back(warp.warp(inside(x), inside(y)));
      }
    }
    std::vector<float> value(points.size());
    chart_target(f, target, SquareChart::half_vector, theta, points, value, phi);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const float density = warp.pdf(points[k]);
      value[k] = density > 0 ? value[k] / density : 0.f;
    }
    BilinearTable table(value, target_size, target_size);
    made[i].emplace(WarpSlice{std::move(normals), std::move(table)});
  };
  const auto all = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) fit(i);
  };
  f.traits().concurrent ? host.parallel_for(made.size(), all) : all(0, made.size());
  std::vector<WarpSlice> slices;
  for (auto& slice : made) slices.push_back(std::move(*slice));
  return slices;
}

}  // namespace reflectree
