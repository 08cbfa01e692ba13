// SPDX-License-Identifier: Apache-2.0
// What the parser and the printer of materials must agree on.
#pragma once

#include <string>
#include <string_view>

#include "reflectree/brdf/material/registry.hpp"

namespace reflectree {

// Characters that need no quotes: bytes above the ASCII range are letters of some language.
inline bool is_word_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == '/' || c == '~' || c == '%' || c == '@' || static_cast<unsigned char>(c) >= 0x80;
}

inline bool is_word(std::string_view text) {
  for (const char c : text) {
    if (!is_word_char(c)) return false;
  }
  return !text.empty();
}

// "alpha_x" and "alpha_y".
inline bool is_pair(std::string_view x, std::string_view y) {
  return x.size() > 2 && x.size() == y.size() && x.substr(0, x.size() - 1) == y.substr(0, y.size() - 1) &&
         x.ends_with("_x") && y.ends_with("_y");
}

bool in_range(const ParameterInfo& parameter, Rgb value);
// "alpha must lie between 0.001 and 1"; `name`: of the parameter, or of its pair.
std::string range_text(const ParameterInfo& parameter, std::string_view name);

}  // namespace reflectree
