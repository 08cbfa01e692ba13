// SPDX-License-Identifier: Apache-2.0
// The hash FNV-1a of 64 bits (Fowler, Noll & Vo 1991): tells scenes apart that differ by accident,
// not by malice.
#pragma once

#include <cstdint>

namespace reflectree::render {

constexpr std::uint64_t fnv_start = 0xcbf29ce484222325ULL;

template <class Bytes>
constexpr std::uint64_t fnv(const Bytes& bytes, std::uint64_t hash) {
  for (const auto b : bytes) hash = (hash ^ static_cast<unsigned char>(b)) * 0x100000001b3ULL;
  return (hash ^ 0xffU) * 0x100000001b3ULL;  // ends the string
}

}  // namespace reflectree::render
