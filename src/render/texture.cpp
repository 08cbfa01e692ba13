// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/texture.hpp"

#include <cmath>

namespace reflectree::render {

namespace {

// Pictures are grey, or begin with red, green and blue.
Rgb texel(const Image& p, int x, int y) {
  const auto wrapped = [](int i, int n) { return (i % n + n) % n; };
  const float* v = p.values.data() + p.index(wrapped(x, p.width), wrapped(y, p.height));
  return p.channels.size() < 3 ? to_rgb(v[0]) : Rgb{v[0], v[1], v[2]};
}

}  // namespace

Rgb eval(const Texture& texture, Uv uv) {
  if (!texture.picture) return texture.colour;
  const Image& p = *texture.picture;
  const float u = (uv.x - std::floor(uv.x)) * float(p.width);
  const float v = (uv.y - std::floor(uv.y)) * float(p.height);
  if (texture.nearest) return texel(p, int(u), int(v));
  const float x = std::floor(u - .5f), y = std::floor(v - .5f), s = u - .5f - x, t = v - .5f - y;
  const int i = int(x), j = int(y);
  return (1 - t) * ((1 - s) * texel(p, i, j) + s * texel(p, i + 1, j)) +
         t * ((1 - s) * texel(p, i, j + 1) + s * texel(p, i + 1, j + 1));
}

Rgb mean(const Texture& texture) {
  if (!texture.picture) return texture.colour;
  double sum[3] = {};
  const Image& p = *texture.picture;
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      for (int k = 0; k < 3; ++k) sum[k] += double(channel(texel(p, x, y), k));
    }
  }
  const double n = double(p.width) * double(p.height);
  return {float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
}

}  // namespace reflectree::render
