// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/plot.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::draw {

double Axis::at(double value) const {
  const double v = std::clamp(value, lo, hi);
  const double t = log ? std::log(v / lo) / std::log(hi / lo) : (v - lo) / (hi - lo);
  return from + std::clamp(t, 0.0, 1.0) * (to - from);
}

std::vector<Tick> ticks(const Axis& axis, int wanted) {
  std::vector<Tick> out;
  const double slack = 1e-9;
  const double decades = axis.log ? std::log10(axis.hi / axis.lo) : 0;
  if (decades > 0.6) {
    const int every = std::max(1, int(std::ceil(decades / wanted)));
    const int first = int(std::ceil(std::log10(axis.lo) - slack)),
              last = int(std::floor(std::log10(axis.hi) + slack));
    for (int e = first - 1; e <= last; ++e) {
      for (const int m : {1, 2, 5}) {
        const double v = m * std::pow(10.0, e);
        const bool shown = decades < 2 ? true : m == 1 && (e - first) % every == 0;
        if (shown && v >= axis.lo * (1 - slack) && v <= axis.hi * (1 + slack))
          out.push_back({v, pretty(v, 1)});
      }
    }
    return out;
  }
  const double raw = (axis.hi - axis.lo) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  const double step = power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
  const int decimals = std::max(0, -int(std::floor(std::log10(step) + slack)));
  for (double k = std::ceil(axis.lo / step - slack); k * step <= axis.hi + slack * step; ++k) {
    const double v = k * step;
    std::string text = decimals > 4 || std::abs(v) >= 1e5 ? pretty(v, 2) : number(v, decimals);
    if (text.front() == '-') text.replace(0, 1, "−");
    out.push_back({v, std::move(text)});
  }
  return out;
}

std::vector<Tick> ticks_every(const Axis& axis, double step, std::string_view unit) {
  std::vector<Tick> out;
  for (int k = 0; axis.lo + k * step <= axis.hi * (1 + 1e-9); ++k) {
    const double v = axis.lo + k * step;
    out.push_back({v, (v < 0 ? "−" : "") + number(std::abs(v)) + std::string(unit)});
  }
  return out;
}

std::string frame(const Frame& f) {
  const double left = f.x.from, right = f.x.to, bottom = f.y.from, top = f.y.to;
  std::string out = rectangle(left, top, right - left, bottom - top, "plane");
  for (const Tick& t : f.x_ticks) {
    const double x = f.x.at(t.value);
    out += line(x, bottom, x, top, "grid") + label(x, bottom + 14, t.text, Anchor::middle, "tick");
  }
  for (const Tick& t : f.y_ticks) {
    const double y = f.y.at(t.value);
    out += line(left, y, right, y, "grid") + label(left - 5, y + 3.5, t.text, Anchor::end, "tick");
  }
  out += line(left, bottom, right, bottom, "axis");
  if (!f.x_title.empty()) out += label((left + right) / 2, bottom + 30, f.x_title, Anchor::middle, "note");
  if (!f.y_title.empty()) out += label(left, top - 7, f.y_title, Anchor::start, "note");
  return out;
}

std::string curve(const Frame& f, std::span<const double> x, std::span<const double> y,
                  std::string_view css_class) {
  PathData data;
  bool pen_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool drawn = std::isfinite(y[i]) && std::isfinite(x[i]) && (!f.y.log || y[i] > 0);
    if (drawn && pen_down) data.line_to(f.x.at(x[i]), f.y.at(y[i]));
    if (drawn && !pen_down) data.move_to(f.x.at(x[i]), f.y.at(y[i]));
    pen_down = drawn;
  }
  return path(data, css_class);
}

std::string colour_bar(const ColourBar& bar) {
  std::vector<std::uint8_t> strip(255);
  for (std::size_t i = 0; i < 255; ++i) strip[i] = std::uint8_t(i + 1);
  const double left = bar.values.from, right = bar.values.to, below = bar.y + bar.height;
  std::string out = element("image", {{"x", number(left)},
                                      {"y", number(bar.y)},
                                      {"width", number(right - left)},
                                      {"height", number(bar.height)},
                                      {"preserveAspectRatio", "none"},
                                      {"href", png_data_uri(255, 1, strip, *bar.colours)}}) +
                    "\n";
  out += rectangle(left, bar.y, right - left, bar.height, "bar-edge");
  for (const Tick& t : ticks(bar.values)) {
    const double x = bar.values.at(t.value);
    out += line(x, below, x, below + 3, "axis") + label(x, below + 14, t.text, Anchor::middle, "tick");
  }
  return out + label((left + right) / 2, below + 31, bar.title, Anchor::middle, "note");
}

}  // namespace reflectree::draw
