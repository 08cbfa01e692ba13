// SPDX-License-Identifier: Apache-2.0
// Pictures as plain values: Radiance .hdr, PNG, JPEG, BMP and TGA in, OpenEXR both ways, PNG out
// with tone mapping.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// Rows from the top; the channels of a pixel side by side. A name such as "stderr.R" is channel R
// of the layer "stderr".
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> values;
  std::map<std::string, std::string> metadata;
  bool encoded = false;  // values follow sRGB's curve, as those of 8 and 16 bits do

  std::size_t index(int x, int y) const {
    return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * channels.size();
  }
  // The number of a channel; -1 where there is none of that name.
  int find(const std::string& name) const;
};

// Zeros. Throws Error unless the sizes are positive and at most 2^28 values are asked for.
Image make_image(int width, int height, std::vector<std::string> channels);

// .hdr (RGBE), .exr, .png, .jpg, .bmp or .tga, told by the content (TGA, which says nothing, by its name):
// every channel that the file has, under its own name (of 8 and 16 bits Y, YA, RGB or RGBA). Values of 8 and
// 16 bits are in [0, 1], `encoded`. EXR channels R, G, B come out with the primaries of sRGB, whatever the
// file's are. Throws Error.
Image read_image(const std::string& path);
Image read_hdr(ByteView bytes, const std::string& where);
Image read_exr(ByteView bytes, const std::string& where);
Image read_png(ByteView bytes, const std::string& where);
Image read_jpeg(ByteView bytes, const std::string& where);
Image read_bmp(ByteView bytes, const std::string& where);
Image read_tga(ByteView bytes, const std::string& where);

// What a picture shows: Y alone, or R, G, B, by the channels' names and never by their order; without alpha,
// in linear light. `raw`: values as the file has them. The layer without a name, or the only one. Throws
// Error where the names leave it open, or where a value is not finite.
Image colours_of(const Image& picture, const std::string& where, bool raw = false);
// The same, with three equal channels for a grey picture.
Image rgb_of(const Image& picture, const std::string& where);

// 32-bit floats with every channel and the metadata, atomically.
void write_exr(const std::string& path, const Image& image);
// R, G, B times 2^exposure, clipped to [0, 1], in sRGB; atomically. NaN shows as magenta.
void write_png(const std::string& path, const Image& image, float exposure = 0);

// The transfer function of IEC 61966-2-1.
float to_srgb(float linear);
float from_srgb(float encoded);

}  // namespace reflectree
