// SPDX-License-Identifier: Apache-2.0
#include "specular_albedo.hpp"

#include <array>
#include <cmath>
#include <memory>

namespace reflectree::detail {

namespace {

constexpr double pi_d = pi_v<double>;

// Gauss-Legendre on [0, 1].
constexpr std::size_t gauss_points = 4;
constexpr std::array<double, gauss_points> gauss_nodes{0.06943184420297371, 0.33000947820757187,
                                                       0.66999052179242813, 0.93056815579702629};
constexpr std::array<double, gauss_points> gauss_weights{0.17392742256872693, 0.32607257743127307,
                                                         0.32607257743127307, 0.17392742256872693};

// An interval between nodes, or beyond the first or last one, where the same node stands at both ends.
struct Piece {
  double lo, hi;
  std::size_t low, high;  // nodes
  double node_lo, node_hi;
  // The share of the upper node.
  double share(double x) const { return high == low ? 0. : (x - node_lo) / (node_hi - node_lo); }
};
// Of at most `widest`.
std::vector<Piece> pieces(const std::vector<float>& nodes, double lo, double hi, double widest) {
  std::vector<Piece> all;
  const auto add = [&](double from, double to, std::size_t low, std::size_t high) {
    from = std::max(from, lo), to = std::min(to, hi);
    if (!(to > from)) return;
    const auto a = double(nodes[low]), b = double(nodes[high]);
    const int parts = int(std::ceil((to - from) / widest - 1e-6));
    for (int k = 0; k < parts; ++k) {
      all.push_back({linear_mix(double(k) / parts, from, to), linear_mix(double(k + 1) / parts, from, to),
                     low, high, a, b});
    }
  };
  const std::size_t last = nodes.size() - 1;
  add(lo, double(nodes.front()), 0, 0);
  for (std::size_t i = 0; i < last; ++i) add(double(nodes[i]), double(nodes[i + 1]), i, i + 1);
  add(double(nodes.back()), hi, last, last);
  return all;
}

}  // namespace

// With azimuth a and radius r about the mirror direction cos_i = cos r cos_o + sin r cos a sin_o, which is 0
// at r = atan2(cos_o, -cos a sin_o); dsigma = sin r dr da. Along r the rule ends at that horizon; along a, where
// the horizon passes nodes, narrow pieces do.
std::vector<double> albedo_shares(const SpecularAxes& axes, double theta_o) {
  const double cos_o = std::cos(theta_o), sin_o = std::sin(theta_o);
  const double first = axes.mirrored ? 0. : double(axes.azimuth.front());
  const double last = axes.mirrored ? pi_d : first + 2 * pi_d, images = axes.mirrored ? 2 : 1;
  const std::vector<Piece> radial = pieces(axes.radial, 0, pi_d, pi_d / 6);
  const std::size_t width = axes.radial.size();
  std::vector<double> shares(axes.azimuth.size() * width), row(width);
  for (const Piece& azimuth : pieces(axes.azimuth, first, last, pi_d / 18)) {
    for (std::size_t i = 0; i < gauss_points; ++i) {
      const double a = linear_mix(gauss_nodes[i], azimuth.lo, azimuth.hi), across = std::cos(a) * sin_o;
      const double horizon = std::atan2(cos_o, -across);
      std::fill(row.begin(), row.end(), 0.);
      for (const Piece& piece : radial) {
        const double hi = std::min(piece.hi, horizon);
        if (!(hi > piece.lo)) break;
        for (std::size_t j = 0; j < gauss_points; ++j) {
          const double r = linear_mix(gauss_nodes[j], piece.lo, hi), sine = std::sin(r);
          const double w =
              gauss_weights[j] * (hi - piece.lo) * sine * std::max(std::cos(r) * cos_o + sine * across, 0.);
          const double upper = piece.share(r);
          row[piece.low] += w * (1 - upper), row[piece.high] += w * upper;
        }
      }
      const double w = images * gauss_weights[i] * (azimuth.hi - azimuth.lo), upper = azimuth.share(a);
      for (std::size_t k = 0; k < width; ++k) {
        shares[azimuth.low * width + k] += w * (1 - upper) * row[k];
        shares[azimuth.high * width + k] += w * upper * row[k];
      }
    }
  }
  return shares;
}

std::function<double(Direction wo)> specular_albedo(const SpecularAxes& axes,
                                                    const std::vector<float>& values) {
  // Copies of the function share the table.
  const auto table = std::make_shared<const std::pair<SpecularAxes, std::vector<float>>>(axes, values);
  return [table](Direction wo) {
    const auto& [nodes, entries] = *table;
    const float theta_o = polar_angle(sin2_theta(wo), wo.z);
    const std::vector<double> shares = albedo_shares(nodes, double(theta_o));
    const BetweenNodes rotation = rotation_of(nodes, wo.x != 0 || wo.y != 0 ? wo.x : 1.f, wo.y),
                       elevation = between_nodes(nodes.theta_o, theta_o);
    double sum = 0;
    for (const bool high_r : {false, true}) {
      for (const bool high_t : {false, true}) {
        const double weight = double(high_r ? rotation.fraction : 1 - rotation.fraction) *
                              double(high_t ? elevation.fraction : 1 - elevation.fraction);
        if (weight == 0) continue;
        const std::size_t slice = (high_r ? rotation.high : rotation.low) * nodes.theta_o.size() +
                                  (high_t ? elevation.high : elevation.low);
        const float* entry = entries.data() + slice * shares.size();
        double integral = 0;
        for (std::size_t k = 0; k < shares.size(); ++k) integral += shares[k] * double(entry[k]);
        sum += weight * integral;
      }
    }
    return sum;
  };
}

}  // namespace reflectree::detail
