// SPDX-License-Identifier: Apache-2.0
#include "rgl_slice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {
namespace {

constexpr double right_angle = 0.5 * pi_v<double>, lowest = 2e-3;  // radians above the horizon, of viewers

Direction narrow(Vec3<double> w) { return {float(w.x), float(w.y), float(w.z)}; }

// A density that is bilinear between nodes over the square, and its inverse warp: what readers invert.
class InverseWarp {
 public:
  InverseWarp(const float* density, int width, int height)
      : width_(width), height_(height), density_(density) {
    cdf_.resize(std::size_t(width) * std::size_t(height));
    for (int y = 0; y < height; ++y) {
      for (int x = 1; x < width; ++x)
        cdf_[index(x, y)] = cdf_[index(x - 1, y)] + 0.5 * (at(x - 1, y) + at(x, y));
      row_.push_back(cdf_[index(width - 1, y)]);
      row_cdf_.push_back(y == 0 ? 0 : row_cdf_.back() + 0.5 * (row_[std::size_t(y) - 1] + row_.back()));
    }
  }
  bool empty() const { return !(row_cdf_.back() > 0); }

  // The point whose cumulative masses, along v and along u there, are those.
  Vec2<double> operator()(double mass_u, double mass_v) const {
    const double v = mass_v * row_cdf_.back();
    const auto row = find(height_, v, [&](int y) { return row_cdf_[std::size_t(y)]; });
    const double m0 = row_[std::size_t(row)], m1 = row_[std::size_t(row) + 1];
    const double fy = invert(m0, m1, v - row_cdf_[std::size_t(row)]);
    const auto across = [&](double lower, double upper) { return lower + fy * (upper - lower); };
    const auto cdf = [&](int x) { return across(cdf_[index(x, row)], cdf_[index(x, row + 1)]); };
    const auto node = [&](int x) { return across(at(x, row), at(x, row + 1)); };
    const double u = mass_u * cdf(width_ - 1);
    const int column = find(width_, u, cdf);
    const double fx = invert(node(column), node(column + 1), u - cdf(column));
    return {(column + fx) / (width_ - 1), (row + fy) / (height_ - 1)};
  }

 private:
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
  double at(int x, int y) const { return double(density_[index(x, y)]); }
  // The interval of an increasing table that holds the value.
  template <class F>
  static int find(int size, double value, const F& table) {
    int low = 0, high = size - 1;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (table(middle) <= value ? low : high) = middle;
    }
    return low;
  }
  // s with p0 s + (p1 - p0) s^2 / 2 = mass: the root in the form without cancellation.
  static double invert(double p0, double p1, double mass) {
    const double root = std::sqrt(std::max(p0 * p0 + 2 * (p1 - p0) * mass, 0.0));
    return p0 + root > 0 ? std::clamp(2 * mass / (p0 + root), 0.0, 1.0) : 0.5;
  }

  int width_, height_;
  const float* density_;
  std::vector<double> cdf_, row_, row_cdf_;
};

class SliceFit {
 public:
  SliceFit(const AnyBrdf& f, const RglNormals& normals, const RglFitOptions& options, bool isotropic)
      : f_(f), normals_(normals), options_(options), isotropic_(isotropic) {}
  RglSlice operator()(double theta_o, double phi_o) const;

 private:
  // Of a point on the square, in the frame of the table.
  Vec3<double> normal(double u, double v) const {
    return direction_from_angles(right_angle * u * u, (2 * v - 1) * pi_v<double>);
  }
  void fill(std::vector<std::uint8_t>& known, RglSlice& slice) const;

  const AnyBrdf& f_;
  const RglNormals& normals_;
  const RglFitOptions& options_;
  bool isotropic_;
};

RglSlice SliceFit::operator()(double theta_o, double phi_o) const {
  const double turned = isotropic_ ? 0 : phi_o;
  const auto wo = direction_from_angles(std::min(theta_o, right_angle - lowest), turned);
  const int n = options_.normals, m = options_.colours;
  RglSlice slice;
  // D(m) <wo, m> dm on the square, up to a factor: dm = pi u sin theta du 2 pi dv.
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const double u = double(x) / (n - 1), v = double(y) / (n - 1);
      const Vec3<double> h = normal(u, v);
      const double sine = std::sqrt(h.x * h.x + h.y * h.y);
      slice.vndf.push_back(float(u * sine * on_square(normals_.ndf, u, v) * std::max(dot(wo, h), 0.0)));
    }
  }
  const InverseWarp warp(slice.vndf.data(), n, n);
  const auto plane = std::size_t(m) * std::size_t(m);
  slice.colours.resize(3 * plane), slice.luminance.resize(plane);
  std::vector<std::uint8_t> known(plane);
  const double sigma =
      on_square(normals_.sigma, std::sqrt(theta_o / right_angle), turned / (2 * pi_v<double>)+0.5);
  std::vector<Direction> wos, wis;
  std::vector<double> scale;
  std::vector<std::size_t> place;
  for (int y = 0; y < m && !warp.empty(); ++y) {
    for (int x = 0; x < m; ++x) {
      // Just inside: at the very border the density of visible normals is zero.
      const auto inside = [m](int i) { return std::clamp(double(i) / (m - 1), 1e-4, 1 - 1e-4); };
      const auto [u, v] = warp(inside(x), inside(y));
      const Vec3<double> h = normal(u, v), wi = 2 * dot(wo, h) * h - wo;
      const double d = on_square(normals_.ndf, u, v);
      if (!(wi.z > 1e-3 && d > 0)) continue;
      wos.push_back(narrow(wo)), wis.push_back(narrow(wi));
      scale.push_back(4 * sigma * wi.z / d),
          place.push_back(std::size_t(y) * std::size_t(m) + std::size_t(x));
    }
  }
  const auto channels = std::size_t(f_.channels());
  std::vector<float> values(wos.size() * channels);
  f_.eval(wos, wis, values);
  for (std::size_t i = 0; i < wos.size(); ++i) {
    float rgb[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = values[i * channels + (channels == 3 ? c : 0)];
      if (!(value >= 0 && std::isfinite(value))) {
        throw Error("negative or not finite at a node", f_.traits().name, "mend the BRDF before baking it");
      }
      rgb[c] = float(double(value) * scale[i]);
      slice.colours[c * plane + place[i]] = rgb[c];
    }
    slice.luminance[place[i]] = luminance_of(rgb, 3), known[place[i]] = 1;
  }
  fill(known, slice);
  return slice;
}

// Nodes whose half vectors reflect below the surface take the mean of what is beside them, ring by ring, so
// that colours do not fade above the horizon. Densities take the first ring alone: the rest need not be drawn.
void SliceFit::fill(std::vector<std::uint8_t>& known, RglSlice& slice) const {
  const int m = options_.colours;
  const auto plane = std::size_t(m) * std::size_t(m);
  for (int ring = 0; ring < m; ++ring) {
    std::vector<std::pair<std::size_t, std::array<float, 4>>> found;
    for (int y = 0; y < m; ++y) {
      for (int x = 0; x < m; ++x) {
        const auto i = std::size_t(y) * std::size_t(m) + std::size_t(x);
        if (known[i]) continue;
        std::array<float, 4> sum{};
        float count = 0;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            if (x + dx < 0 || x + dx >= m || y + dy < 0 || y + dy >= m) continue;
            const auto k = std::size_t(y + dy) * std::size_t(m) + std::size_t(x + dx);
            if (!known[k]) continue;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += slice.colours[c * plane + k];
            sum[3] += slice.luminance[k], count += 1;
          }
        }
        if (count == 0) continue;
        for (float& v : sum) v /= count;
        found.emplace_back(i, sum);
      }
    }
    for (const auto& [i, value] : found) {
      for (std::size_t c = 0; c < 3; ++c) slice.colours[c * plane + i] = value[c];
      if (ring == 0) slice.luminance[i] = value[3];
      known[i] = 1;
    }
    if (found.empty()) break;
  }
  // Readers divide by the integral.
  const bool dark =
      std::all_of(slice.luminance.begin(), slice.luminance.end(), [](float v) { return !(v > 0); });
  if (dark) std::fill(slice.luminance.begin(), slice.luminance.end(), 1.f);
}

}  // namespace

RglSlice fit_rgl_slice(const AnyBrdf& f, const RglNormals& normals, const RglFitOptions& options,
                       bool isotropic, double theta_o, double phi_o) {
  return SliceFit(f, normals, options, isotropic)(theta_o, phi_o);
}

}  // namespace reflectree
