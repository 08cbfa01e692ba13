// SPDX-License-Identifier: Apache-2.0
// Light from infinitely far away: one radiance, or a latitude-longitude picture read as Mitsuba 3 does.
// Its columns' centres lie at (x + 1/2) / width of the turn from -z towards x, its first and last row *on*
// the poles +y and -y, and between them it is bilinear. Importance sampling: one constant density a cell
// between four texels, drawn by rows and columns (Pharr, Jakob & Humphreys 2016, 14.2.4).
#pragma once

#include <memory>
#include <vector>

#include "reflectree/brdf/value.hpp"
#include "reflectree/io/image.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/render/path_bits.hpp"

namespace reflectree::render {

class Environment {
 public:
  explicit Environment(Rgb radiance) : constant_(radiance) {}
  // `frame`: where the picture's x, y and z axes point. Throws Error for a picture without light.
  Environment(Image picture, Frame<float> frame, float scale, const std::string& where);

  // `direction` points away from the scene.
  Rgb radiance(Direction direction) const;
  float pdf(Direction direction) const;
  Direction sample(PathBits& u) const;

 private:
  struct Cell {
    int x, y;
    float s, t;
  };
  Cell cell(Direction local) const;
  Rgb texel(int x, int y) const;
  float mass(int x, int y) const;

  Rgb constant_;
  std::shared_ptr<const Image> picture_;
  Frame<float> frame_{};
  float scale_ = 1;
  std::vector<float> columns_;  // [y][x]: cumulative mass in a row of cells
  std::vector<double> rows_;    // cumulative mass of rows
};

}  // namespace reflectree::render
