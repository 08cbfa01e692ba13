// SPDX-License-Identifier: Apache-2.0
// Floats as text and back, whatever the locale. libc++ 13 has no to_chars or from_chars for float.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace reflectree {

// The fewest digits that read back as the same float: "0.1", "50", "1e+07". Finite x only.
std::string shortest_text(float x);

// Takes [+-]digits[.digits][e[+-]digits] off the front of `text`; nullopt, and nothing taken, where it
// does not start with a number. Beyond the range of float: infinite, or zero.
std::optional<float> take_number(std::string_view& text);

// The number that the whole text is, [+-]digits[.digits][e[+-]digits], good to a few roundings of a double;
// nullopt for anything else, and beyond the range of a double.
std::optional<double> parse_number(std::string_view text);

}  // namespace reflectree
