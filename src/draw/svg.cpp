// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/svg.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace reflectree::draw {

namespace {

// The length of the UTF-8 sequence at text[i], 0 where it is broken or XML forbids it.
std::size_t sequence_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned lead = byte(i);
  if (lead < 0x80) return lead >= 0x20 || lead == '\t' || lead == '\n' || lead == '\r' ? 1 : 0;
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || i + length > text.size()) return 0;
  std::uint32_t code = lead & (0x7fU >> length);
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xc0U) != 0x80U) return 0;
    code = (code << 6U) | (byte(i + k) & 0x3fU);
  }
  constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (code < smallest[length] || code > 0x10ffff || surrogate || code == 0xfffe || code == 0xffff) return 0;
  return length;
}

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = sequence_length(text, i);
    if (length == 0) {
      out += "\xef\xbf\xbd";
      ++i;
      continue;
    }
    switch (text[i]) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += text.substr(i, length);
    }
    i += length;
  }
  return out;
}

std::string number(double x, int decimals) {
  if (!std::isfinite(x)) return std::isnan(x) ? "nan" : x < 0 ? "-inf" : "inf";
  std::array<char, 400> buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), x, std::chars_format::fixed, decimals);
  std::string text(buffer.data(), end.ptr);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string pretty(double x, int digits) {
  if (!std::isfinite(x)) return std::isnan(x) ? "–" : x < 0 ? "−∞" : "∞";
  if (x == 0) return "0";
  if (x < 0) return "−" + pretty(-x, digits);
  // Round to the digits first: 9.996 with three digits has the exponent of 10.0.
  std::array<char, 64> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x,
                                 std::chars_format::scientific, digits - 1);
  const std::string text(buffer.data(), end.ptr);
  const std::size_t e = text.find('e');
  int exponent = 0;
  const char* sign = text.data() + e + 1 + (text[e + 1] == '+' ? 1 : 0);
  std::from_chars(sign, text.data() + text.size(), exponent);
  if (exponent < -3 || exponent > 6) {
    constexpr std::array<const char*, 10> superscript{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string mantissa = text.substr(0, e);
    if (mantissa.find('.') != std::string::npos) mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
    std::string power;
    for (const char c : std::to_string(std::abs(exponent))) power += superscript[std::size_t(c - '0')];
    return (mantissa == "1" ? "" : mantissa + " × ") + "10" + (exponent < 0 ? "⁻" : "") + power;
  }
  std::string fixed = number(x, std::max(digits - 1 - exponent, 0));
  const std::size_t point = std::min(fixed.find('.'), fixed.size());
  if (point > 4) {  // thin spaces between thousands
    for (std::size_t i = point; i > 3; i -= 3) fixed.insert(i - 3, "\u2009");
  }
  return fixed;
}

std::string element(std::string_view name, Attributes attributes, std::string_view content) {
  std::string out = "<" + std::string(name);
  for (const auto& [key, value] : attributes) {
    if (!value.empty()) out += " " + std::string(key) + "=\"" + escape(value) + "\"";
  }
  if (content.empty()) return out + "/>";
  return out + ">" + std::string(content) + "</" + std::string(name) + ">";
}

std::string rich(std::string_view text) {
  std::string out;
  bool italic = false;
  std::size_t plain = 0;
  const auto flush = [&](std::size_t end) { out += escape(text.substr(plain, end - plain)); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '*') {
      flush(i);
      out += italic ? "</tspan>" : "<tspan class=\"math\">";
      italic = !italic;
      plain = i + 1;
    } else if (text[i] == '_' && i + 1 < text.size()) {
      flush(i);
      const bool braces = text[i + 1] == '{';
      const std::size_t from = i + (braces ? 2 : 1);
      const std::size_t to = braces ? std::min(text.find('}', from), text.size()) : from + 1;
      // A zero-width space carries the baseline back up.
      out += "<tspan dy=\"0.28em\" font-size=\"72%\">" + escape(text.substr(from, to - from)) +
             "</tspan><tspan dy=\"-0.2em\">\xe2\x80\x8b</tspan>";
      i = braces ? to : from;
      plain = std::min(i + 1, text.size());
    }
  }
  flush(text.size());
  return italic ? out + "</tspan>" : out;
}

std::string label(double x, double y, std::string_view rich_text, Anchor anchor, std::string_view css_class) {
  const std::string_view where = anchor == Anchor::start ? "" : anchor == Anchor::middle ? "middle" : "end";
  return element("text",
                 {{"class", css_class}, {"x", number(x, 1)}, {"y", number(y, 1)}, {"text-anchor", where}},
                 rich(rich_text)) +
         "\n";
}

std::string line(double x0, double y0, double x1, double y1, std::string_view css_class) {
  return element("line", {{"class", css_class},
                          {"x1", number(x0)},
                          {"y1", number(y0)},
                          {"x2", number(x1)},
                          {"y2", number(y1)}}) +
         "\n";
}

std::string circle(double x, double y, double radius, std::string_view css_class) {
  return element("circle",
                 {{"class", css_class}, {"cx", number(x)}, {"cy", number(y)}, {"r", number(radius)}}) +
         "\n";
}

std::string rectangle(double x, double y, double width, double height, std::string_view css_class) {
  return element("rect", {{"class", css_class},
                          {"x", number(x)},
                          {"y", number(y)},
                          {"width", number(width)},
                          {"height", number(height)}}) +
         "\n";
}

void PathData::put(long value) {
  // Tenths as text: "12.3", "-.4", "5"; a separator only where the sign does not separate.
  std::string text = value < 0 ? "-" : "";
  const long magnitude = value < 0 ? -value : value;
  if (magnitude >= 10 || magnitude == 0) text += std::to_string(magnitude / 10);
  if (magnitude % 10 != 0) text += "." + std::to_string(magnitude % 10);
  const bool after_letter = data_.empty() || (data_.back() >= 'A' && data_.back() <= 'z');
  if (!after_letter && value >= 0) data_ += ' ';
  data_ += text;
}

void PathData::move_to(double x, double y) {
  const long nx = std::lround(x * 10), ny = std::lround(y * 10);
  const bool first = data_.empty();
  data_ += first ? 'M' : 'm';
  put(first ? nx : nx - x_);
  put(first ? ny : ny - y_);
  x_ = start_x_ = nx;
  y_ = start_y_ = ny;
  last_ = 'm';
}

void PathData::line_to(double x, double y) {
  const long nx = std::lround(x * 10), ny = std::lround(y * 10);
  if (nx == x_ && ny == y_) return;
  if (last_ != 'l') data_ += 'l';
  put(nx - x_);
  put(ny - y_);
  x_ = nx;
  y_ = ny;
  last_ = 'l';
}

void PathData::dot(double x, double y) {
  move_to(x, y);
  data_ += "h0";
  last_ = 'h';
}

std::string path(const PathData& data, std::string_view css_class) {
  return data.empty() ? "" : element("path", {{"class", css_class}, {"d", data.text()}}) + "\n";
}

}  // namespace reflectree::draw
