// SPDX-License-Identifier: Apache-2.0
// What the handles of the C interface hold. The first word tells one kind from the other, which other
// languages' untyped pointers do not.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "border.hpp"
#include "reflectree/formats/open.hpp"

struct reflectree_function {
  static constexpr std::uint64_t own_kind = 0x6e6f6974636e7566;  // "function"
  std::uint64_t kind = own_kind;
  reflectree::AnyBrdf building;  // what a builder sees
  reflectree::AnyBrdf f;         // what samplers evaluate: a callback's values are checked
};

struct reflectree_sampler {
  static constexpr std::uint64_t own_kind = 0x72656c706d6173;  // "sampler"
  std::uint64_t kind = own_kind;
  reflectree::SamplerData data;
  reflectree::Sampler<reflectree::AnyBrdf> sampler;
  std::string info_text = {}, info_json = {};
};

namespace reflectree::c {

// The facts of a sampler, and where they are kept as words.
void describe(reflectree_sampler& s);

// The handle itself; throws ArgumentError where it is none of its kind.
template <class Handle>
const Handle& checked(const Handle* handle, const char* where, const char* name) {
  if (needed(handle, where, name)->kind != Handle::own_kind) {
    refuse(where, std::string(name) + " is a handle of another kind", "pass what this library made for it");
  }
  return *handle;
}

}  // namespace reflectree::c
