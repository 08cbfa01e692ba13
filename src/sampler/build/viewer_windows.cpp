// SPDX-License-Identifier: Apache-2.0
#include "viewer_windows.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::detail {

namespace {

constexpr std::size_t fewest_draws = 64, most_windows = 8;
constexpr double suspicious = 5.5;  // standard errors

struct Cell {
  double sum = 0, square = 0;
  std::size_t count = 0;
};

struct Window {
  KnownBox box;
  double z;
};

bool meet(const KnownBox& a, const KnownBox& b) {
  for (std::size_t axis = 0; axis < std::size_t(a.axes); ++axis) {
    const std::size_t k = a.slot[axis];
    if (a.hi[k] <= b.lo[k] || b.hi[k] <= a.lo[k]) return false;
  }
  return true;
}

}  // namespace

std::vector<KnownBox> odd_windows(const std::vector<ViewerDraw>& draws, const KnownBox& space) {
  if (draws.size() < fewest_draws) return {};
  double square = 0;
  for (const ViewerDraw& d : draws) square += std::pow(double(d.says) - 1, 2);
  const double usual = square / double(draws.size());  // a window of few draws may look calmer than it is

  // Grids of 2^i windows over theta_o times 2^j over one of the other coordinates, as long as those of equal
  // share hold enough draws.
  int levels = 0;
  while ((draws.size() >> (levels + 1)) >= fewest_draws) ++levels;
  std::vector<Window> odd;
  const auto look = [&](std::size_t other, int i, int j) {
    const std::size_t columns = std::size_t(1) << i, rows = std::size_t(1) << j;
    std::vector<Cell> cells(columns * rows);
    for (const ViewerDraw& d : draws) {
      const Shares share = space.share_of(d.known);
      const auto place = [](float s, std::size_t n) {
        return std::min(std::size_t(std::max(s, 0.f) * float(n)), n - 1);
      };
      Cell& cell = cells[place(share[0], columns) + columns * place(share[other], rows)];
      const double x = double(d.says) - 1;
      cell.sum += x, cell.square += x * x, ++cell.count;
    }
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const Cell& cell = cells[k];
      if (cell.count < fewest_draws) continue;
      const auto n = double(cell.count);
      const double variance = std::max(cell.square / n - std::pow(cell.sum / n, 2), usual);
      const double z = std::abs(cell.sum) / std::sqrt(n * variance + 1e-30);
      if (!(z > suspicious)) continue;
      KnownBox box = space;
      const auto column = float(k % columns), row = float(k / columns);
      Shares lo{}, hi{1, 1, 1, 1};
      lo[0] = column / float(columns), hi[0] = (column + 1) / float(columns);
      if (other > 0) lo[other] = row / float(rows), hi[other] = (row + 1) / float(rows);
      box.lo = space.at(lo), box.hi = space.at(hi);
      odd.push_back({box, z});
    }
  };
  for (int i = 0; i <= levels; ++i) {
    look(std::size_t(space.axes > 1), i, 0);
    for (int other = 1; other < space.axes; ++other) {
      for (int j = 1; j <= levels - i; ++j) look(std::size_t(other), i, j);
    }
  }
  std::stable_sort(odd.begin(), odd.end(), [](const Window& a, const Window& b) { return a.z > b.z; });
  std::vector<KnownBox> worst;
  for (const Window& w : odd) {
    const bool seen =
        std::any_of(worst.begin(), worst.end(), [&](const KnownBox& box) { return meet(box, w.box); });
    if (!seen) worst.push_back(w.box);
    if (worst.size() == most_windows) break;
  }
  return worst;
}

}  // namespace reflectree::detail
