// SPDX-License-Identifier: Apache-2.0
// What is fuzzed: each target feeds arbitrary bytes to one reader. Error is a fine answer; whatever is
// accepted must make sense: functions have finite values that are not negative, corners of triangles exist, a
// scene renders; anything else aborts.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree::fuzz {

struct Target {
  std::string_view name;
  void (*run)(ByteView bytes);
  std::vector<Bytes> (*seeds)();  // small valid inputs, made from formulas
};

// targets.cpp: rgl, merl, zemax, klems, table, material, sampler, grammar; render_targets.cpp: pictures, meshes, scene.
std::span<const Target> targets();

}  // namespace reflectree::fuzz
