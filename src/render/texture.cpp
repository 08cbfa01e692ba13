// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/texture.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::render {

namespace {

// Pictures are grey, or begin with red, green and blue.
Rgb texel(const Image& p, int x, int y) {
  const float* v = p.values.data() + p.index(x, y);
  return p.channels.size() < 3 ? to_rgb(v[0]) : Rgb{v[0], v[1], v[2]};
}

// The texels on both sides of a place in [0, n], and how far it is from the first one's centre.
struct Between {
  int a, b;
  float t;
};
Between between(float at, int n) {
  const float x = at + .5f;  // not negative: what is cut off is the fraction
  const int after = int(x);
  return {after == 0 ? n - 1 : after - 1, after >= n ? 0 : after, x - float(after)};
}

}  // namespace

Rgb eval_picture(const Texture& texture, Uv uv) {
  const Image& p = *texture.picture;
  const float u = (uv.x - std::floor(uv.x)) * float(p.width);
  const float v = (uv.y - std::floor(uv.y)) * float(p.height);
  if (texture.nearest) return texel(p, std::min(int(u), p.width - 1), std::min(int(v), p.height - 1));
  const Between x = between(u, p.width), y = between(v, p.height);
  return (1 - y.t) * ((1 - x.t) * texel(p, x.a, y.a) + x.t * texel(p, x.b, y.a)) +
         y.t * ((1 - x.t) * texel(p, x.a, y.b) + x.t * texel(p, x.b, y.b));
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
