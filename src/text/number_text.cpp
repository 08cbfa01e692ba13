// SPDX-License-Identifier: Apache-2.0
#include "reflectree/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

namespace reflectree {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::size_t skip_digits(std::string_view text, std::size_t i) {
  while (i < text.size() && is_digit(text[i])) ++i;
  return i;
}

std::size_t skip_sign(std::string_view text, std::size_t i) {
  return i < text.size() && (text[i] == '+' || text[i] == '-') ? i + 1 : i;
}

// The length of the number at the front of `text`; 0 if there is none.
std::size_t number_length(std::string_view text) {
  const std::size_t start = skip_sign(text, 0);
  std::size_t end = skip_digits(text, start), digits = end - start;
  if (end < text.size() && text[end] == '.') {
    const std::size_t fraction = end + 1;
    end = skip_digits(text, fraction);
    digits += end - fraction;
  }
  if (digits == 0) return 0;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t exponent = skip_sign(text, end + 1);
    const std::size_t last = skip_digits(text, exponent);
    if (last > exponent) end = last;
  }
  return end;
}

// Read as double, which holds every float's decimal neighbourhood; out of its range: 0 or infinity.
float read(std::string_view number) {
  std::istringstream in{std::string(number)};
  in.imbue(std::locale::classic());
  double value = 0;
  in >> value;
  if (in.fail() && std::abs(value) < 1) return 0.f;
  if (std::abs(value) > double(std::numeric_limits<float>::max())) {
    return std::copysign(std::numeric_limits<float>::infinity(), float(value > 0 ? 1 : -1));
  }
  return float(value);
}

}  // namespace

std::string shortest_text(float x) {
  // Few digits would turn 50 into 5e+01: as many as stand before the point, up to a million.
  int digits = 1;
  for (float power = 10; power < 1e6f && std::abs(x) >= power; power *= 10) ++digits;
  for (;; ++digits) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << x;
    if (digits >= std::numeric_limits<float>::max_digits10 || read(out.str()) == x) return out.str();
  }
}

std::optional<float> take_number(std::string_view& text) {
  const std::size_t length = number_length(text);
  if (length == 0) return std::nullopt;
  const float value = read(text.substr(0, length));
  text.remove_prefix(length);
  return value;
}

std::optional<double> parse_number(std::string_view text) {
  std::size_t i = 0;
  const auto sign = [&] {
    const bool negative = i < text.size() && text[i] == '-';
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    return negative;
  };
  const bool negative = sign();
  double mantissa = 0;
  int exponent = 0, digits = 0;
  for (bool fraction = false; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !fraction)); ++i) {
    if (text[i] == '.') {
      fraction = true;
      continue;
    }
    ++digits;
    if (mantissa < 1e17) {
      mantissa = mantissa * 10 + (text[i] - '0');
      exponent -= fraction ? 1 : 0;
    } else {
      exponent += fraction ? 0 : 1;
    }
  }
  if (digits == 0) return std::nullopt;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    const bool down = sign();
    int e = 0;
    const std::size_t first = i;
    for (; i < text.size() && is_digit(text[i]); ++i) e = std::min(e * 10 + (text[i] - '0'), 9999);
    if (i == first) return std::nullopt;
    exponent += down ? -e : e;
  }
  // In two steps: 10^exponent alone may underflow where the number does not.
  const int half = exponent / 2;
  const double value = mantissa * std::pow(10.0, half) * std::pow(10.0, exponent - half);
  if (i != text.size() || !std::isfinite(value)) return std::nullopt;
  return negative ? -value : value;
}

}  // namespace reflectree
