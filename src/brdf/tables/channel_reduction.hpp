// SPDX-License-Identifier: Apache-2.0
// The scalar that is sampled (target.hpp) of many channels that are multilinear over a grid, cut at 0. It is convex and
// grows with each channel, and so along each axis of the grid it is convex: no more than what is linear between corners.
// And no less than w . f with w its gradient anywhere, whose entries are not negative, cut or not; which is multilinear.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "reflectree/brdf/target.hpp"
#include "reflectree/math/interval.hpp"

namespace reflectree {

// node(n): the channels at a node.
template <class Node>
class ChannelReduction {
 public:
  ChannelReduction(const Target& target, int channels, Node node)
      : target_(target), node_(std::move(node)), sum_(std::size_t(channels)) {}

  void clear() { std::fill(sum_.begin(), sum_.end(), 0.); }
  template <class N>
  void add(const N& n, double weight) {
    const float* channel = node_(n);
    for (std::size_t c = 0; c < sum_.size(); ++c) sum_[c] += weight * double(channel[c]);
  }
  RealInterval value() {
    if (gradient_.empty()) find_gradient();
    double lower = 0;
    for (std::size_t c = 0; c < sum_.size(); ++c) lower += gradient_[c] * sum_[c];
    const double upper = of(sum_);
    return {std::min(lower, upper), upper};
  }
  template <class N>
  double size(const N& n) const {
    const float* channel = node_(n);
    double squares = 0;
    for (std::size_t c = 0; c < sum_.size(); ++c) squares += double(channel[c]) * double(channel[c]);
    return double(target_.scale) * std::sqrt(squares);
  }

 private:
  static constexpr double share_of_norm = 0.01;
  bool is_norm() const { return target_.kind == TargetKind::norm; }
  std::size_t index() const { return std::min(std::size_t(target_.index), sum_.size() - 1); }

  static double norm(const std::vector<double>& f) {
    double squares = 0;
    for (const double v : f) squares += v > 0 ? v * v : 0;
    return std::sqrt(squares);
  }
  double of(const std::vector<double>& f) const {
    double t = 0;
    switch (target_.kind) {
      case TargetKind::norm:
        break;
      case TargetKind::luminance:
        for (const double v : f) t += std::max(v, 0.) / double(f.size());
        break;
      case TargetKind::maximum:
        for (const double v : f) t = std::max(t, v);
        break;
      case TargetKind::channel:
        t = std::max(f[index()], 0.);
        break;
    }
    const double scale = double(target_.scale);
    return is_norm() ? scale * norm(f) : scale * ((1 - share_of_norm) * t + share_of_norm * norm(f));
  }
  void find_gradient() {
    const double length = norm(sum_), of_norm = is_norm() ? 1 : share_of_norm, scale = double(target_.scale);
    gradient_.assign(sum_.size(), 0);
    const auto largest = std::size_t(std::max_element(sum_.begin(), sum_.end()) - sum_.begin());
    for (std::size_t c = 0; c < sum_.size(); ++c) {
      double g = length > 0 ? of_norm * std::max(sum_[c], 0.) / length : 0;
      if (target_.kind == TargetKind::luminance) g += (1 - of_norm) / double(sum_.size());
      if (target_.kind == TargetKind::maximum && c == largest) g += 1 - of_norm;
      if (target_.kind == TargetKind::channel && c == index()) g += 1 - of_norm;
      gradient_[c] = scale * g;
    }
  }

  Target target_;
  Node node_;
  std::vector<double> sum_, gradient_;
};

}  // namespace reflectree
