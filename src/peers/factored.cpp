// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/factored.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/peers/nmf.hpp"
#include "reflectree/peers/sliced_density.hpp"
#include "reflectree/peers/tabulate.hpp"

namespace reflectree {

CellCdf::CellCdf(std::span<const float> cells, float floor) : cdf_(cells.size()) {
  double mean = 0;
  for (const float v : cells) mean += double(v);
  mean /= double(cells.size());
  const double least = double(floor) * mean;
  double total = 0;
  for (const float v : cells) total += mean > 0 ? std::max(double(v), least) : 1;
  double sum = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sum += mean > 0 ? std::max(double(cells[i]), least) : 1;
    cdf_[i] = float(sum / total);
  }
  cdf_.back() = 1;
}

float CellCdf::sample(double u) const {
  const auto above = std::upper_bound(cdf_.begin(), cdf_.end() - 1, float(u));
  const double low = above == cdf_.begin() ? 0.0 : double(*(above - 1)), width = double(*above) - low;
  const double t = width > 0 ? std::clamp((u - low) / width, 0.0, 1.0) : 0.5;
  return float((double(above - cdf_.begin()) + t) / double(cdf_.size()));
}

float CellCdf::pdf(float x) const {
  const auto n = cdf_.size();
  const std::size_t i = std::min(std::size_t(clamp(x, 0.f, 1.f) * float(n)), n - 1);
  return (cdf_[i] - (i > 0 ? cdf_[i - 1] : 0.f)) * float(n);
}

FactoredDensity::FactoredDensity(SquareChart chart, std::vector<float> theta_o, std::vector<float> weight,
                                 std::vector<CellCdf> u, std::vector<CellCdf> v)
    : chart_(chart),
      theta_o_(std::move(theta_o)),
      weight_(std::move(weight)),
      u_(std::move(u)),
      v_(std::move(v)) {}

float FactoredDensity::weight(const WeightsAt& at, std::size_t term) const {
  const std::size_t terms = u_.size();
  const auto of = [&](std::size_t azimuth) {
    const float* w = weight_.data() + (azimuth * theta_o_.size() + at.theta.below) * terms + term;
    return linear_mix(at.theta.t, w[0], w[terms]);
  };
  return at.phi.t > 0 ? linear_mix(at.phi.t, of(at.phi.below), of(at.phi.above)) : of(at.phi.below);
}

FactoredDensity::WeightsAt FactoredDensity::weights_at(Direction wo) const {
  return {locate_angle(theta_o_, theta_of(wo)),
          locate_azimuth(weight_.size() / (theta_o_.size() * u_.size()), wo)};
}

float FactoredDensity::pdf_square(const WeightsAt& at, Vec2<float> p) const {
  float sum = 0;
  for (std::size_t l = 0; l < u_.size(); ++l) sum += weight(at, l) * u_[l].pdf(p.x) * v_[l].pdf(p.y);
  return sum;
}

std::optional<DrawnFromDensity> FactoredDensity::sample(Direction wo, UniformBits& u) const {
  const AzimuthFrame frame(wo);
  const Direction local{frame.sin_theta, 0, wo.z};
  const WeightsAt at = weights_at(wo);
  const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
  double rest = to_unit_double(u());
  std::size_t term = 0;
  for (; term + 1 < u_.size(); ++term) {
    rest -= double(weight(at, term));
    if (rest < 0) break;
  }
  const Vec2<float> p{u_[term].sample(u1), v_[term].sample(u2)};
  const ChartPoint point = chart_point(chart_, local, p);
  if (!(point.wi.z > 0) || !(point.jacobian > 0)) return std::nullopt;
  return DrawnFromDensity{normalize(frame.to_world(point.wi)), pdf_square(at, p) / point.jacobian};
}

float FactoredDensity::pdf(Direction wo, Direction wi) const {
  const AzimuthFrame frame(wo);
  const Direction local{frame.sin_theta, 0, wo.z};
  const ChartPlace place = chart_place(chart_, local, frame.to_local(wi));
  const WeightsAt at = weights_at(wo);
  return place.jacobian > 0 ? pdf_square(at, place.p) / place.jacobian : 0.f;
}

std::size_t FactoredDensity::bytes() const {
  std::size_t sum = sizeof(*this) + (theta_o_.size() + weight_.size()) * sizeof(float);
  for (const auto& cdf : u_) sum += cdf.bytes();
  for (const auto& cdf : v_) sum += cdf.bytes();
  return sum;
}

// The matrix holds f cos_i with the Jacobian, 4 (wo . wh) sin theta_h d(theta_h, phi_h), as a density over
// (x, y) must; its rows are scaled to sum 1, since each wo draws from a density of its own.
FactoredDensity fit_factored(const AnyBrdf& f, Target target, SquareChart chart, std::vector<float> theta_o,
                             const FactoredOptions& options, std::size_t azimuths) {
  const int rows = int(azimuths * theta_o.size()), width = options.width, height = options.height;
  const auto n = std::size_t(width) * std::size_t(height);
  std::vector<float> matrix;
  for (std::size_t i = 0; i < std::size_t(rows); ++i) {
    const float theta = theta_o[i % theta_o.size()], phi = azimuth_of(i / theta_o.size(), azimuths);
    auto row = chart_cells(f, target, chart, theta, width, height, 0, phi);
    double sum = 0;
    for (const float v : row) sum += double(v);
    for (const float v : row) matrix.push_back(sum > 0 ? float(double(v) / sum) : 1 / float(n));
  }
  const auto outer = factor_non_negative(matrix, rows, int(n), options.outer_terms);
  std::vector<CellCdf> u, v;
  std::vector<float> share;  // [outer][inner]: of each term's mass
  for (std::size_t j = 0; j < std::size_t(outer.terms); ++j) {
    // [y][x]: left holds v with the mass, right u.
    const auto inner =
        factor_non_negative({outer.right.data() + j * n, n}, height, width, options.inner_terms);
    const auto terms = std::size_t(inner.terms);
    for (std::size_t k = 0; k < terms; ++k) {
      std::vector<float> column;
      double mass = 0;
      for (std::size_t y = 0; y < std::size_t(height); ++y) {
        column.push_back(inner.left[y * terms + k]);
        mass += double(column.back());
      }
      u.emplace_back(std::span(inner.right).subspan(k * std::size_t(width), std::size_t(width)),
                     options.floor);
      v.emplace_back(column, options.floor);
      share.push_back(float(mass));
    }
  }
  std::vector<float> weight;
  for (std::size_t i = 0; i < std::size_t(rows); ++i) {
    double sum = 0;
    const std::size_t first = weight.size();
    for (std::size_t l = 0; l < u.size(); ++l) {
      const std::size_t j = l / std::size_t(options.inner_terms);
      weight.push_back(outer.left[i * std::size_t(outer.terms) + j] * share[l]);
      sum += double(weight.back());
    }
    for (std::size_t l = first; l < weight.size(); ++l) weight[l] = float(double(weight[l]) / sum);
  }
  return {chart, std::move(theta_o), std::move(weight), std::move(u), std::move(v)};
}

}  // namespace reflectree
