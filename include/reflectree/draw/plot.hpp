// SPDX-License-Identifier: Apache-2.0
// Axes, ticks, frames and colour bars: what every plot is put together from.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reflectree/draw/colour_map.hpp"
#include "reflectree/draw/svg.hpp"

namespace reflectree::draw {

// Values lo..hi on pixels from..to, evenly or by decades (lo > 0).
struct Axis {
  double lo = 0, hi = 1, from = 0, to = 1;
  bool log = false;
  double at(double value) const;  // pixels; values outside are clamped to the ends
};

struct Tick {
  double value;
  std::string text;
};
// About `wanted` round values within the axis. Decades on a log axis, with 2 and 5 where there are few.
std::vector<Tick> ticks(const Axis& axis, int wanted = 5);
// Every `step` from lo on, with a unit after the number ("30°").
std::vector<Tick> ticks_every(const Axis& axis, double step, std::string_view unit);

// A plot's frame: plane, grid, axes, tick labels and axis titles (rich text).
struct Frame {
  Axis x, y;  // x.from left .. x.to right; y.from bottom .. y.to top
  std::vector<Tick> x_ticks, y_ticks;
  std::string x_title, y_title;
};
std::string frame(const Frame& f);

// y over x as a polyline; points that are not finite break it.
std::string curve(const Frame& f, std::span<const double> x, std::span<const double> y,
                  std::string_view css_class);

// The colours between lo and hi, horizontally, with ticks and a rich title below.
struct ColourBar {
  Axis values;  // from..to: x
  double y = 0, height = 8;
  std::string title;
  const Palette* colours = &palette();
};
std::string colour_bar(const ColourBar& bar);

}  // namespace reflectree::draw
