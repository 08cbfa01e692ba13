// SPDX-License-Identifier: Apache-2.0
// A colour that may vary over a surface: one value, or a picture in linear light.
#pragma once

#include <memory>

#include "reflectree/brdf/value.hpp"
#include "reflectree/io/image.hpp"
#include "reflectree/math/direction.hpp"

namespace reflectree::render {

using Uv = Vec2<float>;

struct Texture {
  Rgb colour;                            // where there is no picture
  std::shared_ptr<const Image> picture;  // repeated in u and v; v = 0 is the first row
  bool nearest = false;                  // otherwise bilinear between the centres of texels
};

Rgb eval_picture(const Texture& texture, Uv uv);
inline Rgb eval(const Texture& texture, Uv uv) {
  return texture.picture ? eval_picture(texture, uv) : texture.colour;
}
// Over the picture.
Rgb mean(const Texture& texture);

}  // namespace reflectree::render
