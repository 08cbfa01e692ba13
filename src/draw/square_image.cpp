// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/square_image.hpp"

namespace reflectree::draw {

std::string square_raster(const std::function<double(Vec2<float>)>& g, const Axis& range,
                          const SquarePlace& place, int size) {
  const int rows = place.half ? size / 2 : size;
  std::vector<std::uint8_t> pixels;
  Axis position = range;
  position.from = 0;
  position.to = 254;
  for (int row = 0; row < rows; ++row) {
    const float y = (float(rows - row) - 0.5f) / float(rows);
    for (int column = 0; column < size; ++column) {
      const float x = 2 * (float(column) + 0.5f) / float(size) - 1;
      pixels.push_back(std::uint8_t(1.5 + position.at(g({x, place.half ? y : 2 * y - 1}))));
    }
  }
  return element("image", {{"x", number(place.x)},
                           {"y", number(place.y)},
                           {"width", number(place.width)},
                           {"height", number(place.height())},
                           {"preserveAspectRatio", "none"},
                           {"href", png_data_uri(size, rows, pixels, palette())}}) +
         "\n";
}

std::string cell_rectangle(const SquareCell& cell, const SquarePlace& place, std::string_view css_class) {
  const double left = place.px(double(cell.x0)), top = place.py(double(cell.y1));
  return rectangle(left, top, place.px(double(cell.x1)) - left, place.py(double(cell.y0)) - top, css_class);
}

std::string square_axes(const SquarePlace& place) {
  std::string out;
  const double below = place.y + place.height() + 14;
  for (const int degrees : {180, 90, 0}) {
    const double x = place.px(1 - degrees / 90.0);
    const Anchor anchor = degrees == 180 ? Anchor::start : degrees == 0 ? Anchor::end : Anchor::middle;
    out += label(x, below, (degrees == 90 ? "|*φ*| = " : "") + std::to_string(degrees) + "°", anchor, "tick");
  }
  out += label(place.x - 6, place.py(1) + 8, "rim", Anchor::end, "tick");
  return out + label(place.x - 6, place.py(0) + (place.half ? 0 : 4), "pole", Anchor::end, "tick");
}

}  // namespace reflectree::draw
