// SPDX-License-Identifier: Apache-2.0
// Arrays of the C interface, three floats per direction, as directions.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "border.hpp"
#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/sampler/known/incidence.hpp"

namespace reflectree::c {

inline Direction direction_at(const float* w, std::size_t i) {
  return {w[3 * i], w[3 * i + 1], w[3 * i + 2]};
}

inline void store(Direction w, float* out, std::size_t i) {
  out[3 * i] = w.x, out[3 * i + 1] = w.y, out[3 * i + 2] = w.z;
}

// Above the surface and of unit length, up to what a renderer's rounding leaves; no NaN passes.
inline bool is_above(Direction w) { return w.z > 0 && abs(dot(w, w) - 1) <= unit_length_tolerance; }

// Blocks of 64 keep everything on the stack: body(first, count) covers [0, n).
inline constexpr std::size_t block_size = 64;
template <class Body>
void in_blocks(std::size_t n, const Body& body) {
  for (std::size_t first = 0; first < n; first += block_size) body(first, std::min(block_size, n - first));
}

// reflectree_function_eval and reflectree_eval.
void eval_pairs(const AnyBrdf& f, std::size_t n, const float* wo, const float* wi, float* values,
                const char* where);

}  // namespace reflectree::c
