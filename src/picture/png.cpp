// SPDX-License-Identifier: Apache-2.0
#include "reflectree/picture/png.hpp"

#include <png.h>

#include <array>
#include <csetjmp>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

void append(png_structp png, png_bytep data, png_size_t size) {
  auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), data, data + size);
}

// Rows of 1 byte per pixel with a palette, of 3 without.
Bytes encode(int width, int height, const std::uint8_t* rows, std::span<const Rgb8> palette, bool indexed) {
  std::array<png_color, 256> table{};
  for (std::size_t i = 0; i < palette.size(); ++i) table[i + 1] = {palette[i].r, palette[i].g, palette[i].b};
  const std::array<png_byte, 1> alpha{0};
  const std::size_t row_bytes = std::size_t(width) * (indexed ? 1 : 3);

  Bytes bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  // libpng reports errors by longjmp to here; nothing with a destructor lives between.
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    throw Error("libpng cannot write the picture", "PNG encoder", "make the picture smaller");
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), 8,
               indexed ? PNG_COLOR_TYPE_PALETTE : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (indexed) {
    png_set_PLTE(png, info, table.data(), int(table.size()));
    png_set_tRNS(png, info, alpha.data(), int(alpha.size()), nullptr);
    png_set_compression_level(png, 9);
    png_set_filter(png, 0, PNG_ALL_FILTERS);
  } else {
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  }
  png_write_info(png, info);
  for (int y = 0; y < height; ++y) png_write_row(png, rows + std::size_t(y) * row_bytes);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

void check_size(int width, int height, std::size_t pixels) {
  if (width <= 0 || height <= 0 || pixels != std::size_t(width) * std::size_t(height)) {
    throw Error("the picture's size and its pixels disagree", "PNG encoder", "pass width * height pixels");
  }
}

}  // namespace

Bytes encode_png(int width, int height, std::span<const Rgb8> pixels) {
  check_size(width, height, pixels.size());
  static_assert(sizeof(Rgb8) == 3);
  return encode(width, height, &pixels.data()->r, {}, false);
}

Bytes encode_indexed_png(int width, int height, std::span<const std::uint8_t> pixels,
                         std::span<const Rgb8> palette) {
  check_size(width, height, pixels.size());
  if (palette.size() > 255) throw Error("more than 255 colours", "PNG encoder", "pass a smaller palette");
  return encode(width, height, pixels.data(), palette, true);
}

}  // namespace reflectree
