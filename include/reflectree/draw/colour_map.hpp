// SPDX-License-Identifier: Apache-2.0
// The colour map of every heat map: from night blue through plum and coral to pale gold.
// Lightness in OKLab (Ottosson 2020) rises linearly from 0.19 to 0.96, so that equal steps look equal,
// in grey and to colour-blind eyes too; hue turns one way, chroma is the most that sRGB has, up to 0.17.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "reflectree/picture/png.hpp"

namespace reflectree::draw {

// t in [0, 1]; clamped; NaN is 0.
Rgb8 colour(double t);
// For ratios: t = 0 teal, 0.5 near white, 1 rust; lightness is symmetric about the middle.
Rgb8 diverging_colour(double t);

using Palette = std::array<Rgb8, 255>;
const Palette& palette();            // colour(i / 254)
const Palette& diverging_palette();  // diverging_colour(i / 254)

// An indexed PNG as "data:image/png;base64,...": index 0 is transparent, i + 1 is entry i. Throws Error where
// size and pixels disagree.
std::string png_data_uri(int width, int height, std::span<const std::uint8_t> pixels, const Palette& colours);

// Lightness L in OKLab of an sRGB colour, 0 black to 1 white.
double oklab_lightness(Rgb8 c);

}  // namespace reflectree::draw
