// SPDX-License-Identifier: Apache-2.0
// Functions over the square of a domain, and its cells. x, the azimuth, runs to the right; y, the radius,
// upwards: a half square has the pole at its lower edge, a full one on the line through its middle.
#pragma once

#include <functional>
#include <string>

#include "reflectree/draw/plot.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::draw {

// Where the square is drawn: its left upper corner and its width.
struct SquarePlace {
  double x = 0, y = 0, width = 0;
  bool half = true;
  double height() const { return half ? width / 2 : width; }
  double px(double u) const { return x + width * (u + 1) / 2; }
  double py(double v) const { return y + height() - width * (v - (half ? 0 : -1)) / 2; }
};

// g as an <image>, one point per pixel.
std::string square_raster(const std::function<double(Vec2<float>)>& g, const Axis& range,
                          const SquarePlace& place, int size = 320);

std::string cell_rectangle(const SquareCell& cell, const SquarePlace& place, std::string_view css_class);

// What the edges are: the azimuth below, pole and rim on the left.
std::string square_axes(const SquarePlace& place);

}  // namespace reflectree::draw
