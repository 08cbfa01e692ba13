// SPDX-License-Identifier: Apache-2.0
// A point of a domain's square, lifted to a direction.
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"

namespace reflectree {

// A point of the square, lifted. `projected_area` = d(projected solid angle of wi) / d(share of the
// square), so that T = t * projected_area integrates over the whole square (area 1) to the albedo;
// pdf_disk = density per share / projected_area.
template <class T>
struct DomainPointT {
  ShadingGeometry<T> geometry;
  T projected_area;  // > 0
};
using DomainPoint = DomainPointT<float>;

namespace detail {

// Rounding may carry the very rim of the square to the horizon or below: it stays just above.
inline constexpr float min_cos_theta_i = 1e-7f;

}  // namespace detail

}  // namespace reflectree
