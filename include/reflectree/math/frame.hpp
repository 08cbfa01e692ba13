// SPDX-License-Identifier: Apache-2.0
// A right-handed orthonormal basis about a normal, without branches or square roots. Duff et al. 2017,
// "Building an Orthonormal Basis, Revisited", JCGT 6(1): error of a few ulp for every unit normal.
#pragma once

#include "reflectree/math/direction.hpp"

namespace reflectree {

// s x t = n; all of unit length.
template <class T>
struct LocalFrame {
  Vec3<T> s, t, n;
};

// `n` is a unit vector; n = +z gives the axes themselves.
template <class T>
LocalFrame<T> frame_from_normal(Vec3<T> n) {
  const T sign = std::copysign(T(1), n.z);
  const T a = T(-1) / (sign + n.z);
  const T b = n.x * n.y * a;
  return {{T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

template <class T>
constexpr Vec3<T> to_local(const LocalFrame<T>& frame, Vec3<T> w) {
  return {dot(w, frame.s), dot(w, frame.t), dot(w, frame.n)};
}
template <class T>
constexpr Vec3<T> to_world(const LocalFrame<T>& frame, Vec3<T> w) {
  return w.x * frame.s + w.y * frame.t + w.z * frame.n;
}

}  // namespace reflectree
