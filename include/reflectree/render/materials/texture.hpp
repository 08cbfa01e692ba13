// SPDX-License-Identifier: Apache-2.0
// A colour that may vary over a surface: one value, or a picture in linear light.
#pragma once

#include <array>
#include <memory>

#include "reflectree/brdf/value.hpp"
#include "reflectree/math/direction.hpp"
#include "reflectree/picture/image.hpp"

namespace reflectree::render {

using Uv = Vec2<float>;

// Outside of [0, 1]^2 a picture is repeated, mirrored, or its rim goes on. v = 0 is the first row.
struct Texture {
  enum class Wrap : std::uint8_t { repeat, mirror, clamp };
  Rgb colour;                            // where there is no picture
  std::shared_ptr<const Image> picture;  // grey, or R, G, B
  bool nearest = false;                  // otherwise bilinear between the centres of texels
  Wrap wrap = Wrap::repeat;
  std::array<float, 6> to_uv{1, 0, 0, 0, 1, 0};  // by rows, of columns (u, v, 1): the picture's place
  friend bool operator==(const Texture&, const Texture&) = default;  // of pictures: the same one
};

Rgb eval_picture(const Texture& texture, Uv uv);
inline Rgb eval(const Texture& texture, Uv uv) {
  return texture.picture ? eval_picture(texture, uv) : texture.colour;
}
// Over the picture.
Rgb mean(const Texture& texture);

}  // namespace reflectree::render
