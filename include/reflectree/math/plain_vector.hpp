// SPDX-License-Identifier: Apache-2.0
// What lanes.hpp asks of the compiler's vectors, written with loops: for compilers without them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "reflectree/math/scalar.hpp"

namespace reflectree::detail {

template <class E, std::size_t n>
struct PlainVector {
  E e[n];
  constexpr E& operator[](std::size_t i) { return e[i]; }
  constexpr E operator[](std::size_t i) const { return e[i]; }
};

#define REFLECTREE_PLAIN_OPERATOR(op, Result, value)                                       \
  template <class E, std::size_t n>                                                        \
  constexpr PlainVector<Result, n> operator op(PlainVector<E, n> a, PlainVector<E, n> b) { \
    PlainVector<Result, n> r{};                                                            \
    for (std::size_t i = 0; i < n; ++i) r[i] = value;                                      \
    return r;                                                                              \
  }
REFLECTREE_PLAIN_OPERATOR(+, E, a[i] + b[i])
REFLECTREE_PLAIN_OPERATOR(-, E, a[i] - b[i])
REFLECTREE_PLAIN_OPERATOR(*, E, a[i] * b[i])
REFLECTREE_PLAIN_OPERATOR(/, E, a[i] / b[i])
REFLECTREE_PLAIN_OPERATOR(&, E, a[i] & b[i])
REFLECTREE_PLAIN_OPERATOR(|, E, a[i] | b[i])
REFLECTREE_PLAIN_OPERATOR(^, E, a[i] ^ b[i])
REFLECTREE_PLAIN_OPERATOR(<, std::int32_t, a[i] < b[i] ? -1 : 0)
REFLECTREE_PLAIN_OPERATOR(<=, std::int32_t, a[i] <= b[i] ? -1 : 0)
REFLECTREE_PLAIN_OPERATOR(==, std::int32_t, a[i] == b[i] ? -1 : 0)
#undef REFLECTREE_PLAIN_OPERATOR

}  // namespace reflectree::detail
