// SPDX-License-Identifier: Apache-2.0
// PNG files of 8 bits per channel, written through libpng.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend constexpr bool operator==(Rgb8, Rgb8) = default;
};

// The bytes of a PNG file of `pixels`, rows from the top. Throws Error where size and pixels disagree
// or libpng refuses.
Bytes encode_png(int width, int height, std::span<const Rgb8> pixels);
// The same of indices, which weighs least. Index 0 is transparent; index i + 1 is entry i of the palette, of
// at most 255 entries.
Bytes encode_indexed_png(int width, int height, std::span<const std::uint8_t> pixels,
                         std::span<const Rgb8> palette);

}  // namespace reflectree
