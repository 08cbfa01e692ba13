// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/png.hpp"

#include <png.h>

#include <array>
#include <csetjmp>

#include "reflectree/error.hpp"

namespace reflectree::draw {

namespace {

void append(png_structp png, png_bytep data, png_size_t size) {
  auto& bytes = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), data, data + size);
}

}  // namespace

std::vector<std::uint8_t> encode_png(const IndexedImage& image, const Palette& colours) {
  const auto width = std::size_t(image.width), height = std::size_t(image.height);
  if (image.width <= 0 || image.height <= 0 || image.index.size() != width * height) {
    throw Error("the picture's size and its pixels disagree", "PNG encoder", "pass width * height pixels");
  }
  std::array<png_color, 256> table{};
  for (std::size_t i = 0; i < colours.size(); ++i) table[i + 1] = {colours[i].r, colours[i].g, colours[i].b};
  const std::array<png_byte, 1> alpha{0};

  std::vector<std::uint8_t> bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  // libpng reports errors by longjmp to here; nothing with a destructor lives between.
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    throw Error("libpng cannot write the picture", "PNG encoder", "make the picture smaller");
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), 8, PNG_COLOR_TYPE_PALETTE,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_PLTE(png, info, table.data(), int(table.size()));
  png_set_tRNS(png, info, alpha.data(), int(alpha.size()), nullptr);
  png_set_compression_level(png, 9);
  png_set_filter(png, 0, PNG_ALL_FILTERS);
  png_write_info(png, info);
  for (std::size_t y = 0; y < height; ++y) png_write_row(png, image.index.data() + y * width);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = (word << 8U) | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? digits[(word >> (18U - 6U * k)) & 63U] : '=';
    }
  }
  return out;
}

std::string png_data_uri(const IndexedImage& image, const Palette& colours) {
  return "data:image/png;base64," + base64(encode_png(image, colours));
}

}  // namespace reflectree::draw
