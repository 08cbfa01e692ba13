// SPDX-License-Identifier: Apache-2.0
// A density over directions from densities over the square, one for each of a few elevations of wo. Between
// two slices a and b the density is their linear mixture, so it stays exact for every wo: either one of the
// two is chosen with the mixture's probability (StochasticPair), or a method blends its tables and inverts
// the blend.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/peers/density.hpp"
#include "reflectree/peers/square_chart.hpp"

namespace reflectree {

// A slice offers sample(u) -> point, pdf(point) with integral 1 over the square, and bytes().
template <class Slice>
struct StochasticPair {
  const Slice &a, &b;
  float t;  // share of b

  // The choice comes last: the first two words stay the coordinates of the point.
  Vec2<float> sample(UniformBits& u) const {
    UniformBits rest = u;
    const std::array<std::uint32_t, 2> point{rest(), rest()};
    const bool upper = to_unit_double(rest()) < double(t);
    UniformBits chosen(point, rest.rest());
    const Vec2<float> p = (upper ? b : a).sample(chosen);
    u = UniformBits(chosen.rest());
    return p;
  }
  float pdf(Vec2<float> p) const { return (1 - t) * a.pdf(p) + t * b.pdf(p); }
};

template <class Slice>
struct PairOf {
  using type = StochasticPair<Slice>;
};
template <class Slice>
requires requires { typename Slice::Pair; }
struct PairOf<Slice> {
  using type = typename Slice::Pair;
};

// Between which of the ascending angles theta lies, and how far.
struct AnglePosition {
  std::size_t below;
  float t;
};
inline AnglePosition locate_angle(const std::vector<float>& angles, float theta) {
  const auto above = std::upper_bound(angles.begin() + 1, angles.end() - 1, theta);
  const auto below = std::size_t(above - angles.begin()) - 1;
  return {below, std::clamp((theta - angles[below]) / (angles[below + 1] - angles[below]), 0.f, 1.f)};
}

template <class Slice>
class SlicedDensity {
 public:
  // theta_o ascends, one for each slice, at least two.
  SlicedDensity(SquareChart chart, std::vector<float> theta_o, std::vector<Slice> slices)
      : chart_(chart), theta_o_(std::move(theta_o)), slices_(std::move(slices)) {}

  std::optional<DrawnFromDensity> sample(Direction wo, UniformBits& u) const {
    const AzimuthFrame frame(wo);
    const Direction local{frame.sin_theta, 0, wo.z};
    const auto pair = between(local);
    const Vec2<float> p = pair.sample(u);
    const ChartPoint point = chart_point(chart_, local, p);
    if (!(point.wi.z > 0) || !(point.jacobian > 0)) return std::nullopt;
    return DrawnFromDensity{normalize(frame.to_world(point.wi)), pair.pdf(p) / point.jacobian};
  }
  float pdf(Direction wo, Direction wi) const {
    const AzimuthFrame frame(wo);
    const Direction local{frame.sin_theta, 0, wo.z};
    const ChartPlace place = chart_place(chart_, local, frame.to_local(wi));
    return place.jacobian > 0 ? between(local).pdf(place.p) / place.jacobian : 0.f;
  }
  std::size_t bytes() const {
    std::size_t sum = sizeof(*this) + theta_o_.size() * sizeof(float);
    for (const Slice& slice : slices_) sum += slice.bytes();
    return sum;
  }
  SquareChart chart() const { return chart_; }

 private:
  typename PairOf<Slice>::type between(Direction local) const {
    const AnglePosition at = locate_angle(theta_o_, theta_of(local));
    return {slices_[at.below], slices_[at.below + 1], at.t};
  }

  SquareChart chart_;
  std::vector<float> theta_o_;
  std::vector<Slice> slices_;
};

}  // namespace reflectree
