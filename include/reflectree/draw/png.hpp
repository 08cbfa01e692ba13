// SPDX-License-Identifier: Apache-2.0
// An indexed PNG in memory, through libpng: what a heat map weighs least as.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reflectree/draw/colour_map.hpp"

namespace reflectree::draw {

// Rows from the top. Index 0 is transparent; index i + 1 is entry i of the palette.
struct IndexedImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> index;
};

// The bytes of a PNG file. Throws Error when the sizes disagree or libpng refuses.
std::vector<std::uint8_t> encode_png(const IndexedImage& image, const Palette& colours);

std::string base64(const std::vector<std::uint8_t>& bytes);
// "data:image/png;base64,..."
std::string png_data_uri(const IndexedImage& image, const Palette& colours);

}  // namespace reflectree::draw
