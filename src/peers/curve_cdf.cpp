// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/curve_cdf.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree {
namespace {

std::vector<double> cumulative(std::span<const double> mass) {
  std::vector<double> cdf(mass.size() + 1, 0.0);
  for (std::size_t i = 0; i < mass.size(); ++i) cdf[i + 1] = cdf[i] + mass[i];
  const double total = cdf.back();
  for (std::size_t i = 0; i < cdf.size(); ++i) {
    cdf[i] = total > 0 ? cdf[i] / total : double(i) / double(mass.size());
  }
  return cdf;
}

// The interval that holds the value of a member, never one of no width.
std::size_t find(std::span<const CurvePoint> curve, float CurvePoint::*member, float value) {
  const auto above = std::upper_bound(curve.begin() + 1, curve.end() - 1, value,
                                      [member](float v, const CurvePoint& p) { return v < p.*member; });
  return std::size_t(above - curve.begin()) - 1;
}
float slope(std::span<const CurvePoint> curve, std::size_t i) {
  return (curve[i + 1].cdf - curve[i].cdf) / (curve[i + 1].x - curve[i].x);
}
float invert(std::span<const CurvePoint> curve, std::size_t i, double value) {
  const double rise = double(curve[i + 1].cdf) - double(curve[i].cdf);
  const double t = rise > 0 ? std::clamp((value - double(curve[i].cdf)) / rise, 0.0, 1.0) : 0.5;
  return float(double(curve[i].x) + t * (double(curve[i + 1].x) - double(curve[i].x)));
}

}  // namespace

std::vector<CurvePoint> reduce_curve(std::span<const double> cdf, float tolerance) {
  const std::size_t last = cdf.size() - 1;
  std::vector<bool> kept(cdf.size(), false);
  kept[0] = kept[last] = true;
  // The points between two kept ones depend on nothing else: recursion adds the same set as the global order.
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    std::size_t worst = a;
    double error = tolerance;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double t = double(i - a) / double(b - a);
      const double off = std::abs(cdf[a] + t * (cdf[b] - cdf[a]) - cdf[i]);
      if (off > error) error = off, worst = i;
    }
    if (worst == a) continue;
    kept[worst] = true;
    open.emplace_back(a, worst), open.emplace_back(worst, b);
  }
  std::vector<CurvePoint> curve;
  for (std::size_t i = 0; i <= last; ++i) {
    if (!kept[i]) continue;
    // Two points that float cannot tell apart would have no support between them.
    if (!curve.empty() && curve.back().cdf == float(cdf[i])) {
      if (i == last) curve.back().x = 1;
      continue;
    }
    curve.push_back({float(i) / float(last), float(cdf[i])});
  }
  return curve;
}

CurveCdf::CurveCdf(std::span<const float> cells, int width, int height, const CurveOptions& options) {
  const auto w = std::size_t(width), h = std::size_t(height);
  std::vector<double> columns(w, 0.0);
  for (std::size_t i = 0; i < w * h; ++i) columns[i % w] += double(cells[i]);
  marginal_ = reduce_curve(cumulative(columns), options.marginal_tolerance);
  first_.push_back(0);
  for (std::size_t i = 0; i + 1 < marginal_.size(); ++i) {
    const auto x0 = std::size_t(std::lround(marginal_[i].x * float(width)));
    const auto x1 = std::size_t(std::lround(marginal_[i + 1].x * float(width)));
    std::vector<double> rows(h, 0.0);
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t x = x0; x < x1; ++x) rows[y] += double(cells[y * w + x]);
    }
    const auto curve = reduce_curve(cumulative(rows), options.conditional_tolerance);
    conditionals_.insert(conditionals_.end(), curve.begin(), curve.end());
    first_.push_back(std::uint32_t(conditionals_.size()));
  }
}

std::span<const CurvePoint> CurveCdf::conditional(std::size_t interval) const {
  return {conditionals_.data() + first_[interval], conditionals_.data() + first_[interval + 1]};
}

Vec2<float> CurveCdf::sample(UniformBits& u) const {
  const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
  const std::size_t i = find(marginal_, &CurvePoint::cdf, float(u1));
  const auto curve = conditional(i);
  return {invert(marginal_, i, u1), invert(curve, find(curve, &CurvePoint::cdf, float(u2)), u2)};
}

float CurveCdf::pdf(Vec2<float> p) const {
  const std::size_t i = find(marginal_, &CurvePoint::x, p.x);
  const auto curve = conditional(i);
  return slope(marginal_, i) * slope(curve, find(curve, &CurvePoint::x, p.y));
}

std::size_t CurveCdf::bytes() const {
  return sizeof(*this) + (marginal_.size() + conditionals_.size()) * sizeof(CurvePoint) +
         first_.size() * sizeof(std::uint32_t);
}

}  // namespace reflectree
