// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/materials/texture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "reflectree/math/scalar.hpp"

namespace reflectree::render {

namespace {

Rgb texel(const Image& p, int x, int y) {
  const float* v = p.values.data() + p.index(x, y);
  return p.channels.size() < 3 ? to_rgb(v[0]) : Rgb{v[0], v[1], v[2]};
}

int wrapped(std::int64_t i, int n, Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::clamp) return int(std::clamp<std::int64_t>(i, 0, n - 1));
  const std::int64_t turn = wrap == Texture::Wrap::mirror ? 2 * std::int64_t(n) : n;
  const std::int64_t in = i >= 0 && i < turn ? i : ((i % turn) + turn) % turn;
  return int(in < n ? in : turn - 1 - in);
}

// The texels on both sides of a place, in texels, and how far it is from the first one's centre.
struct Between {
  int a, b;
  float t;
};
REFLECTREE_INLINE Between between(float place, int n, Texture::Wrap wrap) {
  const float x = place - .5f, before = std::floor(x);
  const auto i = std::int64_t(before);
  return {wrapped(i, n, wrap), wrapped(i + 1, n, wrap), x - before};
}

// Far out a float knows no fraction; and what is no number must not become an index.
float within_reach(float x) { return std::abs(x) < 1e9f ? x : 0; }

}  // namespace

Rgb eval_picture(const Texture& texture, Uv uv) {
  const Image& p = *texture.picture;
  const auto& m = texture.to_uv;
  const float u = within_reach((m[0] * uv.x + m[1] * uv.y + m[2]) * float(p.width)),
              v = within_reach((m[3] * uv.x + m[4] * uv.y + m[5]) * float(p.height));
  if (texture.nearest) {
    return texel(p, wrapped(std::int64_t(std::floor(u)), p.width, texture.wrap),
                 wrapped(std::int64_t(std::floor(v)), p.height, texture.wrap));
  }
  const Between x = between(u, p.width, texture.wrap), y = between(v, p.height, texture.wrap);
  return (1 - y.t) * ((1 - x.t) * texel(p, x.a, y.a) + x.t * texel(p, x.b, y.a)) +
         y.t * ((1 - x.t) * texel(p, x.a, y.b) + x.t * texel(p, x.b, y.b));
}

Rgb eval_attribute(const Texture& texture, const SurfaceDetail* detail) {
  if (!detail) return {};
  const Rgb v = texture.scale * detail->attributes[std::size_t(texture.attribute)];
  return texture.grey ? to_rgb(luminance(v)) : v;
}

// Of the bilinear patch between four texels; of the nearest one none.
Vec2<float> gradient(const Texture& texture, Uv uv) {
  if (!texture.picture || texture.nearest) return {0, 0};
  const Image& p = *texture.picture;
  const auto& m = texture.to_uv;
  const float u = within_reach((m[0] * uv.x + m[1] * uv.y + m[2]) * float(p.width)),
              v = within_reach((m[3] * uv.x + m[4] * uv.y + m[5]) * float(p.height));
  const Between x = between(u, p.width, texture.wrap), y = between(v, p.height, texture.wrap);
  const auto at = [&](int i, int j) { return luminance(texel(p, i, j)); };
  const float f00 = at(x.a, y.a), f10 = at(x.b, y.a), f01 = at(x.a, y.b), f11 = at(x.b, y.b);
  const float du = float(p.width) * linear_mix(y.t, f10 - f00, f11 - f01),
              dv = float(p.height) * linear_mix(x.t, f01 - f00, f11 - f10);
  return {m[0] * du + m[3] * dv, m[1] * du + m[4] * dv};
}

Rgb mean(const Texture& texture) {
  if (texture.attribute >= 0) return to_rgb(.5f);  // it is not known here
  if (!texture.picture) return texture.colour;
  double sum[3] = {};
  const Image& p = *texture.picture;
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      for (int k = 0; k < 3; ++k) sum[k] += double(channel_value(texel(p, x, y), k));
    }
  }
  const double n = double(p.width) * double(p.height);
  return {float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
}

}  // namespace reflectree::render
