// SPDX-License-Identifier: Apache-2.0
#include "disk_frame.hpp"

#include <cmath>

#include "reflectree/draw/svg.hpp"

namespace reflectree::draw {

std::string theta_o_text(Direction wo) {
  const double degrees = double(theta_of(wo)) * 180 / pi_v<double>;
  return "*θ*_o = " + number(degrees, degrees > 89 ? 3 : 1) + "°";
}

std::string disk_heading(const std::string& title, Direction wo) {
  return label(16, 24, title, Anchor::start, "head") +
         label(disk_figure_width - 16, 24, theta_o_text(wo), Anchor::end, "aside");
}

std::string disk_overlay(const DiskPlace& place, Direction wo, DiskMarks marks) {
  std::string out;
  if (marks == DiskMarks::light_with_rings) {
    for (const int degrees : {30, 60}) {
      const double r = place.radius * std::sin(degrees * pi_v<double> / 180);
      out += circle(place.x, place.y, r, "ring");
      out += label(place.x, place.y + r - 4, std::to_string(degrees) + "°", Anchor::middle, "over");
    }
  }
  out += circle(place.x, place.y, place.radius, "rim");
  const double x = place.px(double(wo.x)), mirrored = place.px(double(-wo.x));
  PathData cross;
  cross.move_to(mirrored - 3.5, place.y - 3.5);
  cross.line_to(mirrored + 3.5, place.y + 3.5);
  cross.move_to(mirrored - 3.5, place.y + 3.5);
  cross.line_to(mirrored + 3.5, place.y - 3.5);
  const bool ink = marks == DiskMarks::ink;
  for (const char* css : {ink ? "paper-edge" : "mark-edge", ink ? "ink-mark" : "mark"}) {
    out += circle(x, place.y, 4.5, css);
    // A cross would hide a tree's or a sample's densest part; at the pole it would coincide with the ring.
    if (marks == DiskMarks::light_with_rings && wo.x > 0.02f) out += path(cross, css);
  }
  return out + label(x, place.y - 9, "*ω*_o", Anchor::middle, ink ? "over-ink" : "over");
}

}  // namespace reflectree::draw
