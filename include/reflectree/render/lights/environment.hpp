// SPDX-License-Identifier: Apache-2.0
// Light from infinitely far away: one radiance, or a latitude-longitude picture read as Mitsuba 3 does.
// Its columns' centres lie at (x + 1/2) / width of the turn from -z towards x, its first and last row *on*
// the poles +y and -y, and between them it is bilinear. Importance sampling: one constant density per cell
// between four texels, drawn by rows and columns (Pharr, Jakob & Humphreys 2016, 14.2.4), each found by a
// guide table (Chen & Asau 1974): monotone, in constant time, and seldom out of the cache.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "reflectree/brdf/value.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/picture/image.hpp"
#include "reflectree/render/integrators/path_bits.hpp"

namespace reflectree::render {

class Environment {
 public:
  explicit Environment(Rgb radiance) : constant_(radiance) {}
  // `frame`: where the picture's x, y and z axes point. Throws Error for a picture without light.
  Environment(const Image& picture, LocalFrame<float> frame, float scale, const std::string& where);

  // Directions point away from the scene; `pdf` is the density of `sample`.
  struct Light {
    Rgb radiance;
    float pdf;
  };
  Light at(Direction direction) const;
  void at(std::span<const Direction> directions, std::span<Light> out) const;
  Rgb radiance(Direction direction) const { return at(direction).radiance; }
  float pdf(Direction direction) const { return at(direction).pdf; }
  struct Drawn {
    Direction direction;
    Light light;
  };
  Drawn sample(PathBits& u) const;
  // One for each of `u`.
  void sample(std::span<PathBits* const> u, std::span<Drawn> out) const;

 private:
  // Cell (x, y) lies between the texels (x, y) and (x + 1, y + 1).
  struct Sky {
    LocalFrame<float> frame;
    int width, rows;             // of cells
    std::vector<Rgb> texels;     // [rows + 1][width + 1], scaled; the last column is the first again
    std::vector<float> columns;  // [y][x]: cumulative mass in a row of cells
    std::vector<double> mass;    // cumulative, of rows
    std::vector<float> sines;    // in the middle of a row
    // Guides: where in `columns` and `mass` the search for a share k / size begins.
    std::vector<std::uint16_t> first_column, first_row;

    // A place in a cell.
    struct Place {
      int x, y;
      float s, t, sine;
    };
    // A draw under way: a row, a share of its mass, and a place in a cell that is still to be found.
    struct Aim {
      std::size_t y, guide;
      float share, s, t;
    };
    Place place_of(Direction direction) const;
    Aim aim(PathBits& u) const;
    Drawn drawn(const Aim& aim, std::size_t x) const;
    std::size_t column(const Aim& aim) const;
    const Rgb* texel(std::size_t x, std::size_t y) const {
      return texels.data() + y * (std::size_t(width) + 1) + x;
    }
    Light in_cell(const Place& p) const;
  };

  Rgb constant_;
  std::shared_ptr<const Sky> sky_;
};

}  // namespace reflectree::render
