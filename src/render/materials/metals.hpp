// SPDX-License-Identifier: Apache-2.0
// Metals by name.
#pragma once

#include <string>
#include <string_view>

#include "reflectree/brdf/value.hpp"

namespace reflectree::render {

struct Metal {
  std::string_view name;
  Rgb eta, k;  // index of refraction and extinction
};

const Metal* find_metal(std::string_view name);  // null: unknown
std::string metal_names();

}  // namespace reflectree::render
