// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/colour_map.hpp"

#include <cmath>
#include <span>

#include "reflectree/text/base64.hpp"

namespace reflectree::draw {

namespace {

// Even steps of the paths that the header describes, as sRGB; linear in between.
constexpr std::array<std::uint32_t, 33> sequential{
    0x09122a, 0x0d1735, 0x121b3f, 0x181f4b, 0x1f2456, 0x262861, 0x2e2c6d, 0x363078, 0x3f3384,
    0x4c368b, 0x5a3991, 0x683c96, 0x773f9b, 0x85429d, 0x94459f, 0xa4489d, 0xb34b98, 0xc24f92,
    0xd1548a, 0xde5b81, 0xea6277, 0xf46b6d, 0xfb7666, 0xfe8463, 0xfe9365, 0xfea169, 0xfeae6f,
    0xfebb77, 0xfec781, 0xfed38b, 0xfdde9b, 0xfbe9b0, 0xfbf4c5};
constexpr std::array<std::uint32_t, 17> diverging{0x06666e, 0x097983, 0x0c8e99, 0x10a3af, 0x58b3bd, 0x83c3cb,
                                                  0xaad3d8, 0xcfe3e6, 0xf3f3f3, 0xecdbd3, 0xe4c2b3, 0xdbaa94,
                                                  0xd29275, 0xc77955, 0xbc6033, 0xa84c1b, 0x923b04};

Rgb8 interpolate(std::span<const std::uint32_t> table, double t) {
  const double x = (t > 0 ? t < 1 ? t : 1 : 0) * double(table.size() - 1);
  const auto i = std::min(std::size_t(x), table.size() - 2);
  const double u = x - double(i);
  const auto mix = [&](unsigned shift) {
    const double a = (table[i] >> shift) & 0xffU, b = (table[i + 1] >> shift) & 0xffU;
    return std::uint8_t(a + (b - a) * u + 0.5);
  };
  return {mix(16), mix(8), mix(0)};
}

Palette sampled(std::span<const std::uint32_t> table) {
  Palette p;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = interpolate(table, double(i) / double(p.size() - 1));
  return p;
}

}  // namespace

Rgb8 colour(double t) { return interpolate(sequential, t); }
Rgb8 diverging_colour(double t) { return interpolate(diverging, t); }

const Palette& palette() {
  static const Palette p = sampled(sequential);
  return p;
}
const Palette& diverging_palette() {
  static const Palette p = sampled(diverging);
  return p;
}

double oklab_lightness(Rgb8 c) {
  const auto linear = [](std::uint8_t v) {
    const double x = v / 255.0;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  };
  const double r = linear(c.r), g = linear(c.g), b = linear(c.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

std::string png_data_uri(int width, int height, std::span<const std::uint8_t> pixels,
                         const Palette& colours) {
  return "data:image/png;base64," + base64(encode_indexed_png(width, height, pixels, colours));
}

}  // namespace reflectree::draw
