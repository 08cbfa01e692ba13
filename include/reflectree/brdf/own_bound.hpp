// SPDX-License-Identifier: Apache-2.0
// Functions that are known at points alone, and bring a bound of their own. Detected where an AnyBrdf is made:
//   f.bound(cell)    no less than any value of f over a cell of directions, in sr^-1: a number, for all channels,
//                    or a RealInterval that holds all values, which proves more with fewer cells
//   f.lipschitz()    L with |f(wo, wi) - f(wo', wi')| <= L (|wo - wo'| + |wi - wi'|), sr^-1, distances of unit vectors
// certify() rests on what they say, and looks for values at points that contradict it (docs/exactness.md).
#pragma once

#include <functional>
#include <memory>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/math/interval.hpp"

namespace reflectree {

// All pairs whose coordinates lie in these ranges, above the surface. Where traits say that f is isotropic by
// formula, wo.y is 0.
struct DirectionCell {
  Vec3<RealInterval> wo, wi, wh;
  RealInterval cos_theta_d;
};

namespace detail {
inline RealInterval as_bound(RealInterval values) { return values; }
template <class A>
requires std::is_arithmetic_v<A> RealInterval as_bound(A most) { return {0, double(most)}; }

using CellBound = std::function<RealInterval(const DirectionCell&)>;
std::shared_ptr<const BrdfEnclosure> enclosure_by(CellBound bound);

// A pair of the cell, and how far the others are from it: the sum of both distances.
struct CellCentre {
  Direction wo, wi;
  double radius;
};
CellCentre centre_of(const DirectionCell& cell);
}  // namespace detail

template <class F>
concept BoundedBrdf = Brdf<F> && requires(const F& f, const DirectionCell& cell) {
  detail::as_bound(f.bound(cell));
};
template <class F>
concept LipschitzBrdf = Brdf<F> && requires(const F& f) {
  { f.lipschitz() } -> std::convertible_to<double>;
};

namespace detail {
// The enclosure that f brings; none if it brings no bound.
template <Brdf F>
std::shared_ptr<const BrdfEnclosure> own_enclosure(const F& f) {
  if constexpr (BoundedBrdf<F>) {
    return enclosure_by([f](const DirectionCell& cell) { return as_bound(f.bound(cell)); });
  } else if constexpr (LipschitzBrdf<F>) {
    return enclosure_by([f](const DirectionCell& cell) {
      const CellCentre centre = centre_of(cell);
      const ValueOf<F> value = eval(f, centre.wo, centre.wi);
      RealInterval values{infinity, -infinity};
      for (int c = 0; c < channels_of(value); ++c) {
        const double v = double(channel_value(value, c));
        values = hull(values, RealInterval(v, v));
      }
      const double off = double(f.lipschitz()) * centre.radius;
      return values + RealInterval(-off, off);
    });
  } else {
    return nullptr;
  }
}
}  // namespace detail

}  // namespace reflectree
