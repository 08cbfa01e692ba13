// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/bilinear_table.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree {
namespace {

// The s in [0, 1] with p0 s + (p1 - p0) s^2 / 2 = mass: the root in the form without cancellation.
double invert_linear(double p0, double p1, double mass) {
  const double root = std::sqrt(std::max(p0 * p0 + 2 * (p1 - p0) * mass, 0.0));
  return p0 + root > 0 ? std::clamp(2 * mass / (p0 + root), 0.0, 1.0) : 0.5;
}
double linear_mass(double p0, double p1, double s) { return s * (p0 + 0.5 * s * (p1 - p0)); }
double mix(double a, double b, double t) { return a + t * (b - a); }

// The last interval of an increasing function over [0, size) whose lower end is not above the value.
template <class F>
int find_interval(int size, double value, const F& f) {
  int low = 0, high = size - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (f(middle) <= value ? low : high) = middle;
  }
  return low;
}

struct Grid {
  int node;
  double fraction;
};
Grid locate(float x, int size) {
  const double at = std::clamp(double(x), 0.0, 1.0) * (size - 1);
  const int node = std::min(int(at), size - 2);
  return {node, at - node};
}

// Nodes scaled to integral 1 over the square.
std::vector<float> normalised(std::span<const float> nodes, int width, int height) {
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double share = (x == 0 || x == width - 1 ? 0.5 : 1) * (y == 0 || y == height - 1 ? 0.5 : 1);
      sum += share * double(nodes[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
    }
  }
  const double scale = sum > 0 ? double(width - 1) * (height - 1) / sum : 0;
  std::vector<float> out(nodes.begin(), nodes.end());
  for (float& v : out) v = sum > 0 ? float(v * scale) : 1.f;
  return out;
}

}  // namespace

BilinearTable::BilinearTable(std::span<const float> nodes, int width, int height)
    : width_(width), height_(height), node_(normalised(nodes, width, height)) {
  cdf_.resize(node_.size());
  row_.resize(std::size_t(height)), row_cdf_.resize(std::size_t(height));
  double marginal = 0, last = 0;
  for (int y = 0; y < height; ++y) {
    double sum = 0;
    for (int x = 1; x < width; ++x) {
      sum += 0.5 * (double(node(x - 1, y)) + double(node(x, y))) / (width - 1);
      cdf_[index(x, y)] = float(sum);
    }
    if (y > 0) marginal += 0.5 * (last + sum) / (height - 1);
    row_[std::size_t(y)] = float(last = sum), row_cdf_[std::size_t(y)] = float(marginal);
  }
}

Vec2<float> BilinearTable::Pair::sample(UniformBits& u) const {
  const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
  return warp(u1, u2);
}

Vec2<float> BilinearTable::Pair::warp(double u, double v) const {
  const int w = a.width_, h = a.height_;
  const auto blend = [this](const std::vector<float>& p, const std::vector<float>& q, std::size_t i) {
    return mix(double(p[i]), double(q[i]), double(t));
  };
  const auto row_cdf = [&](int y) { return blend(a.row_cdf_, b.row_cdf_, std::size_t(y)); };
  v *= row_cdf(h - 1);
  const int y = find_interval(h, v, row_cdf);
  const double m0 = blend(a.row_, b.row_, std::size_t(y)), m1 = blend(a.row_, b.row_, std::size_t(y) + 1);
  const double sy = invert_linear(m0, m1, (v - row_cdf(y)) * (h - 1));
  const auto cdf = [&](int x) {
    return mix(blend(a.cdf_, b.cdf_, a.index(x, y)), blend(a.cdf_, b.cdf_, a.index(x, y + 1)), sy);
  };
  const auto node = [&](int x) {
    return mix(blend(a.node_, b.node_, a.index(x, y)), blend(a.node_, b.node_, a.index(x, y + 1)), sy);
  };
  u *= cdf(w - 1);
  const int x = find_interval(w, u, cdf);
  const double sx = invert_linear(node(x), node(x + 1), (u - cdf(x)) * (w - 1));
  return {float((x + sx) / (w - 1)), float((y + sy) / (h - 1))};
}

Vec2<double> BilinearTable::Pair::unwarp(Vec2<float> p) const {
  const int w = a.width_, h = a.height_;
  const Grid gx = locate(p.x, w), gy = locate(p.y, h);
  const auto at = [&](const std::vector<float>& l, const std::vector<float>& m, int x, int y) {
    const std::size_t i = a.index(x, y);
    return mix(double(l[i]), double(m[i]), double(t));
  };
  const auto row = [&](const std::vector<float>& l, const std::vector<float>& m, int y) {
    return mix(double(l[std::size_t(y)]), double(m[std::size_t(y)]), double(t));
  };
  const auto across = [&](const std::vector<float>& l, const std::vector<float>& m, int x) {
    return mix(at(l, m, x, gy.node), at(l, m, x, gy.node + 1), gy.fraction);
  };
  const double m0 = row(a.row_, b.row_, gy.node), m1 = row(a.row_, b.row_, gy.node + 1);
  const double v = row(a.row_cdf_, b.row_cdf_, gy.node) + linear_mass(m0, m1, gy.fraction) / (h - 1);
  const double u =
      across(a.cdf_, b.cdf_, gx.node) +
      linear_mass(across(a.node_, b.node_, gx.node), across(a.node_, b.node_, gx.node + 1), gx.fraction) /
          (w - 1);
  const double mass = mix(m0, m1, gy.fraction);
  return {mass > 0 ? u / mass : 0, v};
}

float BilinearTable::Pair::pdf(Vec2<float> p) const {
  const Grid gx = locate(p.x, a.width_), gy = locate(p.y, a.height_);
  const auto of = [&](const BilinearTable& table) {
    const float* n = table.node_.data() + table.index(gx.node, gy.node);
    const float* m = n + table.width_;
    return mix(mix(n[0], n[1], gx.fraction), mix(m[0], m[1], gx.fraction), gy.fraction);
  };
  return float(mix(of(a), of(b), double(t)));
}

std::size_t BilinearTable::bytes() const {
  return sizeof(*this) + (2 * node_.size() + 2 * row_.size()) * sizeof(float);
}

AliasTable::AliasTable(std::span<const float> nodes, int width, int height)
    : width_(width), height_(height), node_(normalised(nodes, width, height)) {
  const int columns = width - 1, rows = height - 1;
  const auto n = std::size_t(columns) * std::size_t(rows);
  std::vector<double> share(n);  // mean 1
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const float* lower = node_.data() + std::size_t(y) * std::size_t(width) + std::size_t(x);
      const float* upper = lower + width;
      share[std::size_t(y) * std::size_t(columns) + std::size_t(x)] =
          0.25 * (double(lower[0]) + double(lower[1]) + double(upper[0]) + double(upper[1]));
    }
  }
  cells_.resize(n);
  std::vector<std::uint32_t> small, large;
  for (std::size_t i = 0; i < n; ++i) {
    cells_[i] = {0xffffffffU, std::uint32_t(i)};
    (share[i] < 1 ? small : large).push_back(std::uint32_t(i));
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    cells_[s] = {std::uint32_t(share[s] * 4294967295.0), l};
    share[l] -= 1 - share[s];
    if (share[l] < 1) large.pop_back(), small.push_back(l);
  }
}

Vec2<float> AliasTable::sample(UniformBits& u) const {
  const std::uint64_t product = std::uint64_t(u()) * cells_.size();
  const auto first = std::size_t(product >> 32U);
  const double u1 = to_unit_double(u());
  const Cell& cell = cells_[first];
  const std::size_t chosen = std::uint32_t(product) < cell.threshold ? first : cell.other;
  const auto columns = std::size_t(width_ - 1);
  const std::size_t x = chosen % columns, y = chosen / columns;
  const float* lower = node_.data() + y * std::size_t(width_) + x;
  const float* upper = lower + width_;
  // Within the cell: the marginal along y, then x at that y.
  const double m0 = double(lower[0]) + double(lower[1]), m1 = double(upper[0]) + double(upper[1]);
  const double sy = invert_linear(m0, m1, u1 * 0.5 * (m0 + m1));
  const double p0 = mix(lower[0], upper[0], sy), p1 = mix(lower[1], upper[1], sy);
  const double sx = invert_linear(p0, p1, to_unit_double(u()) * 0.5 * (p0 + p1));
  return {float((double(x) + sx) / (width_ - 1)), float((double(y) + sy) / (height_ - 1))};
}

float AliasTable::pdf(Vec2<float> p) const {
  const Grid gx = locate(p.x, width_), gy = locate(p.y, height_);
  const float* n = node_.data() + std::size_t(gy.node) * std::size_t(width_) + std::size_t(gx.node);
  const float* m = n + width_;
  return float(mix(mix(n[0], n[1], gx.fraction), mix(m[0], m[1], gx.fraction), gy.fraction));
}

std::size_t AliasTable::bytes() const {
  return sizeof(*this) + node_.size() * sizeof(float) + cells_.size() * sizeof(Cell);
}

}  // namespace reflectree
