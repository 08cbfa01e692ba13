// SPDX-License-Identifier: Apache-2.0
// SVG and HTML as text: escaping, numbers and elements. The same values give the same bytes on every
// machine and in every locale.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "reflectree/math/direction.hpp"

namespace reflectree::draw {

// Text made safe inside an element and inside a quoted attribute. Bytes that XML 1.0 forbids (control
// characters, broken UTF-8) become U+FFFD.
std::string escape(std::string_view text);

// Fixed notation, at most `decimals` of them, without trailing zeros; "-0" is "0"; not finite: "nan",
// "inf", "-inf" (never seen in a drawing that validates).
std::string number(double x, int decimals = 2);
// For people: `digits` significant digits, 1.2e-7 as "1.2 × 10⁻⁷" with superscripts, 12345 as "12 345".
std::string pretty(double x, int digits = 3);

using Attributes = std::initializer_list<std::pair<std::string_view, std::string_view>>;

// <name a="escaped">content</name>; content is markup. Empty content closes the tag itself.
std::string element(std::string_view name, Attributes attributes, std::string_view content = {});

// Labels in a drawing: *x* is italic, _x or _{xy} a subscript, everything else is plain text, escaped.
std::string rich(std::string_view label);

enum class Anchor { start, middle, end };
// A rich label whose baseline begins, centres or ends at (x, y).
std::string label(double x, double y, std::string_view rich_text, Anchor anchor = Anchor::start,
                  std::string_view css_class = "label");

std::string line(double x0, double y0, double x1, double y1, std::string_view css_class);
std::string circle(double x, double y, double radius, std::string_view css_class);
std::string rectangle(double x, double y, double width, double height, std::string_view css_class);

// Path data of many polylines, with one decimal and relative steps: small, exact to 0.05 units.
class PathData {
 public:
  void move_to(double x, double y);
  void line_to(double x, double y);
  void close() { data_ += 'z', x_ = start_x_, y_ = start_y_, last_ = 'z'; }
  // A dot: drawn by a stroke with round caps.
  void dot(double x, double y);
  bool empty() const { return data_.empty(); }
  const std::string& text() const { return data_; }

 private:
  void put(long value);
  std::string data_;
  long x_ = 0, y_ = 0, start_x_ = 0, start_y_ = 0;  // tenths of a unit, so that rounding never adds up
  char last_ = 0;
};
std::string path(const PathData& data, std::string_view css_class);

}  // namespace reflectree::draw
