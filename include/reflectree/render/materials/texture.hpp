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

// What few textures and materials ask about a point of a surface, in its shading frame.
inline constexpr std::size_t max_attributes = 4;  // of meshes, in a scene
struct SurfaceDetail {
  std::array<Rgb, max_attributes> attributes{};
  Direction du{}, dv{};  // how the point moves with u and v
  Direction face{};      // the surface's own normal
};
// Where a texture is looked up. `detail`: of surfaces whose materials ask for it.
struct Place {
  Uv uv{};
  const SurfaceDetail* detail = nullptr;
};

// Outside of [0, 1]^2 a picture is repeated, mirrored, or its rim goes on. v = 0 is the first row.
struct Texture {
  enum class Wrap : std::uint8_t { repeat, mirror, clamp };
  Rgb colour;                            // where there is no picture
  std::shared_ptr<const Image> picture;  // grey, or R, G, B
  bool nearest = false;                  // otherwise bilinear between the centres of texels
  Wrap wrap = Wrap::repeat;
  std::array<float, 6> to_uv{1, 0, 0, 0, 1, 0};  // by rows, of columns (u, v, 1): the picture's place
  int attribute = -1;  // >= 0: that attribute of the mesh times `scale`, in place of all above
  float scale = 1;
  bool grey = false;                                                 // its luminance
  friend bool operator==(const Texture&, const Texture&) = default;  // of pictures: the same one
};

Rgb eval_picture(const Texture& texture, Uv uv);
Rgb eval_attribute(const Texture& texture, const SurfaceDetail* detail);
inline Rgb eval(const Texture& texture, Place place) {
  if (texture.picture) return eval_picture(texture, place.uv);
  return texture.attribute >= 0 ? eval_attribute(texture, place.detail) : texture.colour;
}
inline bool varies(const Texture& texture) { return texture.picture || texture.attribute >= 0; }
// Of the luminance, by u and v.
Vec2<float> gradient(const Texture& texture, Uv uv);
// ITU-R BT.709, with Mitsuba's digits.
inline float luminance(Rgb c) { return .212671f * c.r + .715160f * c.g + .072169f * c.b; }
// Over the picture.
Rgb mean(const Texture& texture);

}  // namespace reflectree::render
