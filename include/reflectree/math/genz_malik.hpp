// SPDX-License-Identifier: Apache-2.0
// The cubature rule of Genz & Malik (1980) in two dimensions: 17 points, degree 7 with an embedded degree 5.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "reflectree/math/direction.hpp"

namespace reflectree {

inline constexpr std::size_t genz_malik_points = 17;

// On [-1, 1]^2. Orbits: the centre, (+-l2, 0), (+-l4, 0), (+-l4, +-l4), (+-l5, +-l5).
template <class T>
const std::array<Vec2<T>, genz_malik_points>& genz_malik_nodes() {
  static const T l2 = std::sqrt(T(9) / T(70)), l4 = std::sqrt(T(9) / T(10)), l5 = std::sqrt(T(9) / T(19));
  static const std::array<Vec2<T>, genz_malik_points> nodes{{{0, 0},
                                                             {-l2, 0},
                                                             {l2, 0},
                                                             {0, -l2},
                                                             {0, l2},
                                                             {-l4, 0},
                                                             {l4, 0},
                                                             {0, -l4},
                                                             {0, l4},
                                                             {-l4, -l4},
                                                             {l4, -l4},
                                                             {-l4, l4},
                                                             {l4, l4},
                                                             {-l5, -l5},
                                                             {l5, -l5},
                                                             {-l5, l5},
                                                             {l5, l5}}};
  return nodes;
}

// Means over the square by both rules, and the fourth differences along each axis, which tell where to cut.
struct GenzMalikSums {
  double degree7, degree5;
  double difference_x, difference_y;
};
// value(i): the integrand at node i.
template <class Value>
GenzMalikSums genz_malik(const Value& value) {
  const auto sum4 = [&](std::size_t i) {
    return double(value(i)) + double(value(i + 1)) + double(value(i + 2)) + double(value(i + 3));
  };
  const double f0 = double(value(0)), s2 = sum4(1), s3 = sum4(5), s4 = sum4(9), s5 = sum4(13);
  const double ratio = (9. / 70) / 0.9;  // l2^2 / l4^2
  const auto difference = [&](std::size_t i, std::size_t j) {
    return std::abs(double(value(i)) + double(value(i + 1)) - 2 * f0 -
                    ratio * (double(value(j)) + double(value(j + 1)) - 2 * f0));
  };
  return {(-3816 * f0 + 2940 * s2 + 1020 * s3 + 200 * s4 + 6859. / 4 * s5) / 19683,
          (-1942 * f0 + 735 * s2 + 65 * s3 + 50 * s4) / 1458, difference(1, 5), difference(3, 7)};
}

}  // namespace reflectree
