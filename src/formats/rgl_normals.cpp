// SPDX-License-Identifier: Apache-2.0
#include "rgl_normals.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

constexpr double right_angle = 0.5 * pi_v<double>;
// Shares of the distribution: what other viewers reflect, which retro-reflection may not know of, and normals
// of every kind, so that no light is lost.
constexpr double share_of_others = 0.3, share_of_all = 1e-3;
constexpr int viewers = 64;

// Nodes over the hemisphere, with their share of it. An isotropic grid has one azimuth for the whole turn.
struct Grid {
  std::size_t rows, columns;  // of v and of u
  bool isotropic;
  std::vector<double> theta, phi, area;
  std::vector<Direction> w;

  Grid(int size, bool one_azimuth)
      : rows(one_azimuth ? 1 : std::size_t(size - 1)), columns(std::size_t(size)), isotropic(one_azimuth) {
    for (std::size_t y = 0; y < rows; ++y) {
      for (std::size_t x = 0; x < columns; ++x) {
        const double u = double(x) / double(columns - 1), end = x == 0 || x + 1 == columns ? 0.5 : 1;
        theta.push_back(right_angle * u * u);
        phi.push_back(isotropic ? 0 : (2 * double(y) / double(rows) - 1) * pi_v<double>);
        // d theta = pi u du
        area.push_back(std::sin(theta.back()) * pi_v<double> * u * end / double(columns - 1) * 2 *
                       pi_v<double> / double(rows));
        const double below = std::min(theta.back(), right_angle - 1e-4);
        const auto d = direction_from_angles(below, phi.back());
        w.push_back({float(d.x), float(d.y), float(d.z)});
      }
    }
  }
  std::size_t size() const { return theta.size(); }
};

// The mean over azimuths of max(0, <o, m>) for elevations o and m.
double mean_clamped_cosine(double o, double m) {
  const double a = std::cos(o) * std::cos(m), b = std::sin(o) * std::sin(m);
  if (a >= b) return a;
  const double phi = std::acos(std::max(-a / b, -1.0));
  return (a * phi + b * std::sin(phi)) / pi_v<double>;
}

void in_parallel(std::size_t count, const Host& host, const std::function<void(std::size_t)>& one) {
  host.parallel_for(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) one(i);
  });
}

// sigma(w) = int D(m) max(0, <w, m>) dm at every node.
std::vector<double> projected_area(const Grid& grid, const std::vector<double>& d, const Host& host) {
  std::vector<double> sigma(grid.size());
  std::vector<float> x(grid.size()), y(grid.size()), z(grid.size());  // D dm times m
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const auto m = direction_from_angles(grid.theta[k], grid.phi[k]);
    const double mass = d[k] * grid.area[k];
    x[k] = float(mass * m.x), y[k] = float(mass * m.y), z[k] = float(mass * m.z);
  }
  in_parallel(grid.size(), host, [&](std::size_t i) {
    double sum = 0;
    if (grid.isotropic) {
      for (std::size_t k = 0; k < grid.size(); ++k)
        sum += mean_clamped_cosine(grid.theta[i], grid.theta[k]) * d[k] * grid.area[k];
    } else {
      const auto w = direction_from_angles(grid.theta[i], grid.phi[i]);
      const float wx = float(w.x), wy = float(w.y), wz = float(w.z);
      for (std::size_t row = 0; row < grid.rows; ++row) {
        float part = 0;
        for (std::size_t k = row * grid.columns; k < (row + 1) * grid.columns; ++k)
          part += max(wx * x[k] + wy * y[k] + wz * z[k], 0.f);
        sum += double(part);
      }
    }
    sigma[i] = sum;
  });
  return sigma;
}

// Scaled so that the projected area of the normal is 1; false where there is nothing to scale.
bool normalise(const Grid& grid, std::vector<double>& d) {
  double area = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) area += d[i] * std::cos(grid.theta[i]) * grid.area[i];
  if (!(area > 0 && std::isfinite(area))) return false;
  for (double& v : d) v /= area;
  return true;
}

double luminance_at(const AnyBrdf& f, Direction wo, Direction wi) {
  const Spectrum value = f(shading_geometry(wo, wi));
  const double v = double(luminance_of(value.data(), value.channels()));
  return std::isfinite(v) && v > 0 ? v : 0;
}

// f(w, w) cos theta = F D(w) / (4 sigma(w)), so D is an eigenvector of f cos theta int <w, m> D(m) dm. Four
// steps are enough (Dupuy and Jakob 2018, section 4). So is a coarse grid, since the kernel is smooth.
bool retro_normals(const AnyBrdf& f, const Grid& grid, const Host& host, std::vector<double>& d) {
  std::vector<double> retro(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i)
    retro[i] = luminance_at(f, grid.w[i], grid.w[i]) * std::cos(grid.theta[i]);
  d.assign(grid.size(), 1);
  for (int step = 0; step < 4; ++step) {
    const std::vector<double> sigma = projected_area(grid, d, host);
    for (std::size_t i = 0; i < grid.size(); ++i) d[i] = retro[i] * sigma[i];
    if (!normalise(grid, d)) return false;
  }
  return true;
}

// The mean over viewers of 4 sigma f cos_i, which is D times their colour.
bool normals_of_viewers(const AnyBrdf& f, const Grid& grid, std::vector<double>& d) {
  d.assign(grid.size(), 0);
  Pcg32 bits(44);
  for (int v = 0; v < viewers; ++v) {
    const double z = (v + 0.5) / viewers, phi = 2 * pi_v<double> * double(to_unit_float(bits()));
    const auto w = direction_from_angles(std::acos(z), phi);
    const Direction wo{float(w.x), float(w.y), float(w.z)};
    for (std::size_t i = 0; i < grid.size(); ++i) {
      // An isotropic grid knows one azimuth of m; any of wo will do.
      const Direction wi = reflect(wo, grid.w[i]);
      if (wi.z > 1e-3f && dot(wo, grid.w[i]) > 0) d[i] += z * luminance_at(f, wo, wi) * double(wi.z);
    }
  }
  return normalise(grid, d);
}

// The tables have the azimuth -pi at both ends, and isotropic ones two rows.
RglSquare as_square(const Grid& grid, const std::vector<double>& values) {
  RglSquare table;
  table.width = int(grid.columns), table.height = grid.isotropic ? 2 : int(grid.rows + 1);
  for (std::size_t y = 0; y < std::size_t(table.height); ++y) {
    for (std::size_t x = 0; x < grid.columns; ++x)
      table.values.push_back(float(values[(y % grid.rows) * grid.columns + x]));
  }
  return table;
}

}  // namespace

float luminance_of(const float* value, int channels) {
  return channels < 3 ? value[0] : 0.2126f * value[0] + 0.7152f * value[1] + 0.0722f * value[2];
}

RglNormals fit_normals(const AnyBrdf& f, bool isotropic, int size, const Host& host) {
  const Grid grid(size, isotropic);
  std::vector<double> d, others;
  const bool retro = retro_normals(f, grid, host, d), forward = normals_of_viewers(f, grid, others);
  if (!retro) d = others;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!retro && !forward) d[i] = 0;
    if (retro && forward) d[i] += share_of_others * (others[i] - d[i]);
    d[i] += share_of_all * (1 / pi_v<double> - d[i]);  // 1 / pi: every normal alike
  }
  if (!normalise(grid, d)) d.assign(grid.size(), 1 / pi_v<double>);
  return {as_square(grid, d), as_square(grid, projected_area(grid, d, host))};
}

double on_square(const RglSquare& table, double u, double v) {
  const auto cell = [](double x, int size) {
    const double at = std::clamp(x, 0.0, 1.0) * (size - 1);
    const int i = std::min(int(at), size - 2);
    return std::pair<int, double>(i, at - i);
  };
  const auto [x, fx] = cell(u, table.width);
  const auto [y, fy] = cell(v, table.height);
  const float* n = table.values.data() + std::size_t(y) * std::size_t(table.width) + std::size_t(x);
  const auto mix = [](double t, float a, float b) { return double(a) + t * (double(b) - double(a)); };
  const double lower = mix(fx, n[0], n[1]), upper = mix(fx, n[table.width], n[table.width + 1]);
  return lower + fy * (upper - lower);
}

}  // namespace reflectree
