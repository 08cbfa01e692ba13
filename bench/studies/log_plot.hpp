// SPDX-License-Identifier: Apache-2.0
// Curves in logarithmic axes, with a key beside them: the plot of every study.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "reflectree/draw/figure.hpp"
#include "reflectree/draw/plot.hpp"

namespace reflectree::study {

struct LogCurve {
  std::string name, css;
  std::vector<double> x, y;
};

inline draw::Figure log_plot(const std::string& title, const std::string& x_title, const std::string& y_title,
                             const std::vector<LogCurve>& curves) {
  double x0 = 1e300, x1 = 0, y0 = 1e300, y1 = 0;
  for (const LogCurve& c : curves) {
    for (const double x : c.x) x0 = std::min(x0, x), x1 = std::max(x1, x);
    for (const double y : c.y) y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  draw::Frame axes;
  axes.x = {x0, x1, 64, 430, true}, axes.y = {y0 / 1.4, y1 * 1.4, 300, 30, true};
  axes.x_ticks = draw::ticks(axes.x), axes.y_ticks = draw::ticks(axes.y);
  axes.x_title = x_title, axes.y_title = y_title;
  draw::Figure figure{600, 345, title, y_title + " over " + x_title + ", logarithmic axes.",
                      draw::frame(axes)};
  double y = 36;
  for (const LogCurve& c : curves) {
    figure.body += draw::curve(axes, c.x, c.y, c.css) + draw::line(446, y - 4, 474, y - 4, c.css) +
                   draw::label(482, y, c.name, draw::Anchor::start, "tick");
    y += 17;
  }
  figure.height = std::max(figure.height, y + 8);
  return figure;
}

}  // namespace reflectree::study
