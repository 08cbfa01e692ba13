// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/haar_warp.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree {
namespace {

// Means of the cells of each level, the finest first.
std::vector<std::vector<double>> pyramid(std::span<const float> cells, int size) {
  std::vector<std::vector<double>> levels{{cells.begin(), cells.end()}};
  for (auto n = std::size_t(size) / 2; n > 0; n /= 2) {
    const auto& finer = levels.back();
    std::vector<double> level(n * n);
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        const double* c = finer.data() + 4 * y * n + 2 * x;
        level[y * n + x] = 0.25 * (c[0] + c[1] + c[2 * n] + c[2 * n + 1]);
      }
    }
    levels.push_back(std::move(level));
  }
  return levels;
}

struct Detail {
  std::array<double, 3> value;
};
// Of the cell (x, y) of a level with n cells per side, whose children are in `finer`.
Detail detail(const std::vector<double>& finer, std::size_t n, std::size_t x, std::size_t y) {
  const double* c = finer.data() + 4 * y * n + 2 * x;
  const double a = c[0], b = c[1], d = c[2 * n], e = c[2 * n + 1];
  return {{0.25 * (b + e - a - d), 0.25 * (d + e - a - b), 0.25 * (a + e - b - d)}};
}

}  // namespace

HaarWarp::HaarWarp(std::span<const float> cells, int size, double dropped) {
  const auto levels = pyramid(cells, size);
  const double mean = levels.back()[0];
  nodes_.emplace_back();
  if (!(mean > 0)) return;
  // The squared norm of a detail: its square times the area of its cell.
  std::vector<double> energy;
  double total = 0;
  for (std::size_t l = 1; l < levels.size(); ++l) {
    const auto n = std::size_t(size) >> l;
    for (std::size_t i = 0; i < n * n; ++i) {
      for (const double d : detail(levels[l - 1], n, i % n, i / n).value) {
        energy.push_back(d * d / double(n * n));
        total += energy.back();
      }
    }
  }
  total += mean * mean;
  std::sort(energy.begin(), energy.end());
  double sum = 0, threshold = 0;
  for (const double e : energy) {
    if ((sum += e) > dropped * total) break;
    threshold = e;
  }
  const auto grow = [&](const auto& self, std::size_t l, std::size_t x, std::size_t y) -> std::uint32_t {
    if (l == 0) return none;
    const auto n = std::size_t(size) >> l;
    Node node;
    bool kept = false;
    const Detail d = detail(levels[l - 1], n, x, y);
    for (std::size_t k = 0; k < 3; ++k) {
      if (d.value[k] * d.value[k] / double(n * n) > threshold) {
        node.detail[k] = float(d.value[k] / mean), kept = true;
      }
    }
    const auto at = std::uint32_t(nodes_.size());
    nodes_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      node.child[k] = self(self, l - 1, 2 * x + k % 2, 2 * y + k / 2);
      kept = kept || node.child[k] != none;
    }
    if (!kept) return nodes_.resize(at), none;
    nodes_[at] = node;
    return at;
  };
  nodes_.clear();
  if (grow(grow, levels.size() - 1, 0, 0) == none) nodes_.emplace_back();
  nodes_.shrink_to_fit();
}

std::array<float, 4> HaarWarp::children(const Node& node, float mean) {
  const auto [x, y, xy] = node.detail;
  std::array<float, 4> m{mean - x - y + xy, mean + x - y - xy, mean - x + y - xy, mean + x + y + xy};
  for (float& v : m) v = std::max(v, 0.f);
  return m;
}

// Down the tree the transform's mean goes along with the density; both differ once something was cut.
Vec2<float> HaarWarp::sample(UniformBits& u) const {
  double a = to_unit_double(u()), b = to_unit_double(u()), x = 0, y = 0, size = 1;
  float mean = 1;
  for (std::uint32_t at = 0; at != none;) {
    const Node& node = nodes_[at];
    const auto m = children(node, mean);
    const double low = double(m[0]) + double(m[1]), high = double(m[2]) + double(m[3]);
    if (!(low + high > 0)) break;
    // Clarberg et al. 2005: the rows first, then within the row; the rest of each number is used again.
    const auto warp = [](double& v, double lower, double upper) {
      const double split = lower / (lower + upper);
      const bool above = v >= split;
      v = above ? (v - split) / (1 - split) : v / split;
      return above;
    };
    const std::size_t j = warp(b, low, high) ? 1 : 0;
    const std::size_t i = warp(a, double(m[2 * j]), double(m[2 * j + 1])) ? 1 : 0;
    size /= 2, x += double(i) * size, y += double(j) * size;
    mean = m[2 * j + i], at = node.child[2 * j + i];
  }
  return {float(x + size * a), float(y + size * b)};
}

float HaarWarp::pdf(Vec2<float> p) const {
  double x = double(p.x), y = double(p.y), density = 1;
  float mean = 1;
  for (std::uint32_t at = 0; at != none;) {
    const Node& node = nodes_[at];
    const auto m = children(node, mean);
    const double sum = double(m[0]) + double(m[1]) + double(m[2]) + double(m[3]);
    if (!(sum > 0)) break;
    const std::size_t k = (x >= 0.5 ? 1U : 0U) + (y >= 0.5 ? 2U : 0U);
    x = 2 * x - double(k % 2), y = 2 * y - double(k / 2);
    density *= 4 * double(m[k]) / sum;
    mean = m[k], at = node.child[k];
  }
  return float(density);
}

}  // namespace reflectree
