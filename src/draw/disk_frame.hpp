// SPDX-License-Identifier: Apache-2.0
// What the pictures over the disk share: place, rim, rings of theta_i, marks of wo and of its mirror image.
#pragma once

#include <string>

#include "reflectree/math/direction.hpp"

namespace reflectree::draw {

struct DiskPlace {
  double x = 180, y = 190, radius = 146;
  double px(double u) const { return x + radius * u; }
  double py(double v) const { return y - radius * v; }
};
inline constexpr double disk_figure_width = 360, disk_figure_height = 412;

// "theta_o = 45°" as a rich label.
std::string theta_o_text(Direction wo);
// Title on the left, theta_o on the right.
std::string disk_heading(const std::string& title, Direction wo);
// The rim and a ring at wo, over colours (with rings at theta_i = 30 and 60 degrees and a cross at wo's
// mirror image) or in ink over a pale picture.
enum class DiskMarks { light, light_with_rings, ink };
std::string disk_overlay(const DiskPlace& place, Direction wo, DiskMarks marks);

}  // namespace reflectree::draw
