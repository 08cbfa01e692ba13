// SPDX-License-Identifier: Apache-2.0
// A density over directions from densities over the square, one for each of a few elevations of wo, and, of
// anisotropic functions, of a few azimuths all around. Between two slices a and b the density is their linear
// mixture, so it stays exact for every wo: either one of the two is chosen with the mixture's probability
// (StochasticPair), or a method blends its tables and inverts the blend.
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

// Between which of `count` equal azimuths from 0 on, and how far; one azimuth serves all.
struct AzimuthPosition {
  std::size_t below, above;
  float t;
};
inline AzimuthPosition locate_azimuth(std::size_t count, Direction wo) {
  if (count == 1) return {0, 0, 0};
  const float turns = std::atan2(wo.y, wo.x) * (0.5f / pi),
              x = (turns < 0 ? turns + 1 : turns) * float(count);
  const auto below = std::min(std::size_t(x), count - 1);
  return {below, (below + 1) % count, std::clamp(x - float(below), 0.f, 1.f)};
}
inline float azimuth_of(std::size_t i, std::size_t count) { return 2 * pi * float(i) / float(count); }

template <class Slice>
class SlicedDensity {
 public:
  // theta_o ascends, at least two; slices: [azimuth][theta_o].
  SlicedDensity(SquareChart chart, std::vector<float> theta_o, std::vector<Slice> slices)
      : chart_(chart),
        azimuths_(slices.size() / theta_o.size()),
        theta_o_(std::move(theta_o)),
        slices_(std::move(slices)) {}

  std::optional<DrawnFromDensity> sample(Direction wo, UniformBits& u) const {
    const AzimuthFrame frame(wo);
    const Direction local{frame.sin_theta, 0, wo.z};
    const AzimuthPosition at = locate_azimuth(azimuths_, wo);
    std::size_t azimuth = at.below;
    if (at.t > 0) {  // the choice comes last, as that of StochasticPair
      UniformBits rest = u;
      const std::array<std::uint32_t, 2> first{rest(), rest()};
      if (to_unit_double(rest()) < double(at.t)) azimuth = at.above;
      u = UniformBits(first, rest.rest());
    }
    const Vec2<float> p = between(local, azimuth).sample(u);
    const ChartPoint point = chart_point(chart_, local, p);
    if (!(point.wi.z > 0) || !(point.jacobian > 0)) return std::nullopt;
    return DrawnFromDensity{normalize(frame.to_world(point.wi)), pdf_square(local, at, p) / point.jacobian};
  }
  float pdf(Direction wo, Direction wi) const {
    const AzimuthFrame frame(wo);
    const Direction local{frame.sin_theta, 0, wo.z};
    const ChartPlace place = chart_place(chart_, local, frame.to_local(wi));
    const AzimuthPosition at = locate_azimuth(azimuths_, wo);
    return place.jacobian > 0 ? pdf_square(local, at, place.p) / place.jacobian : 0.f;
  }
  std::size_t bytes() const {
    std::size_t sum = sizeof(*this) + theta_o_.size() * sizeof(float);
    for (const Slice& slice : slices_) sum += slice.bytes();
    return sum;
  }
  SquareChart chart() const { return chart_; }

 private:
  typename PairOf<Slice>::type between(Direction local, std::size_t azimuth) const {
    const AnglePosition at = locate_angle(theta_o_, theta_of(local));
    const Slice* row = slices_.data() + azimuth * theta_o_.size();
    return {row[at.below], row[at.below + 1], at.t};
  }
  float pdf_square(Direction local, const AzimuthPosition& at, Vec2<float> p) const {
    const float below = between(local, at.below).pdf(p);
    return at.t > 0 ? linear_mix(at.t, below, between(local, at.above).pdf(p)) : below;
  }

  SquareChart chart_;
  std::size_t azimuths_;
  std::vector<float> theta_o_;
  std::vector<Slice> slices_;
};

}  // namespace reflectree
