// SPDX-License-Identifier: Apache-2.0
// PNG as it is: 1 to 16 bits, grey or coloured, with or without alpha; a palette is looked up. Values are the
// file's shares of the largest one: gamma and profile chunks are not heeded, as in Mitsuba. (libpng's
// simplified interface takes 16 bits for linear light and lays alpha over a ground.)
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/picture/image.hpp"
#include "reflectree/picture/png.hpp"

namespace reflectree {

namespace {

// What libpng's callbacks see; no destructors, since its errors are jumps.
struct Reading {
  const std::uint8_t* at;
  std::size_t left;
  char message[128];
};

void take(png_structp png, png_bytep out, png_size_t n) {
  auto* r = static_cast<Reading*>(png_get_io_ptr(png));
  if (n > r->left) png_error(png, "the file ends early");
  std::memcpy(out, r->at, n);
  r->at += n, r->left -= n;
}
[[noreturn]] void jump(png_structp png, png_const_charp message) {
  auto* r = static_cast<Reading*>(png_get_error_ptr(png));
  std::snprintf(r->message, sizeof r->message, "%s", message);
  png_longjmp(png, 1);
}
void ignore(png_structp, png_const_charp) {}

struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  Reading reading{};
  png_uint_32 width = 0, height = 0;
  int channels = 0, depth = 0;

  explicit Reader(ByteView bytes) : reading{bytes.data(), bytes.size(), {}} {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading, jump, ignore);
    info = png ? png_create_info_struct(png) : nullptr;
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // Both return false where libpng has an error to tell.
  bool head() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_read_fn(png, &reading, take);
    png_set_user_limits(png, 1U << 16U, 1U << 16U);
    png_read_info(png, info);
    const int colour = png_get_color_type(png, info);
    if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    if (colour == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png, info) < 8)
      png_set_expand_gray_1_2_4_to_8(png);
    if (png_get_valid(png, info, PNG_INFO_tRNS)) png_set_tRNS_to_alpha(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    channels = png_get_channels(png, info), depth = png_get_bit_depth(png, info);
    return true;
  }
  bool body(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows);
    return true;
  }
};

std::vector<std::string> names(int channels) {
  if (channels == 1) return {"Y"};
  if (channels == 2) return {"Y", "A"};
  if (channels == 3) return {"R", "G", "B"};
  return {"R", "G", "B", "A"};
}

}  // namespace

Image read_png(ByteView bytes, const std::string& where) {
  Reader in(bytes);
  const auto fail = [&] {
    return Error("libpng cannot read it (" + std::string(in.reading.message) + ")", where,
                 "save the picture again");
  };
  if (!in.info || !in.head()) throw fail();
  Image image = make_image(int(in.width), int(in.height), names(in.channels));
  image.encoded = true;
  const std::size_t wide = in.depth == 16 ? 2 : 1, row = image.values.size() / in.height * wide;
  Bytes pixels(row * in.height);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < in.height; ++y) rows.push_back(pixels.data() + y * row);
  if (!in.body(rows.data())) throw fail();
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    image.values[i] = wide == 1 ? float(pixels[i]) / 255
                                : float(unsigned(pixels[2 * i]) << 8U | unsigned(pixels[2 * i + 1])) / 65535;
  }
  return image;
}

void write_png(const std::string& path, const Image& image, float exposure) {
  const int channel[3] = {image.find("R"), image.find("G"), image.find("B")};
  if (std::min({channel[0], channel[1], channel[2]}) < 0) {
    throw Error("no channels R, G and B", path, "name the channels so");
  }
  const float scale = std::exp2(exposure);
  std::vector<Rgb8> pixels;
  for (std::size_t at = 0; at < image.values.size(); at += image.channels.size()) {
    float v[3];
    for (int k = 0; k < 3; ++k) v[k] = scale * image.values[at + std::size_t(channel[k])];
    if (std::isnan(v[0] + v[1] + v[2])) v[0] = v[2] = 1, v[1] = 0;
    const auto encoded = [](float linear) {
      return std::uint8_t(std::lround(255 * to_srgb(std::clamp(linear, 0.f, 1.f))));
    };
    pixels.push_back({encoded(v[0]), encoded(v[1]), encoded(v[2])});
  }
  write_file_atomically(path, ByteView(encode_png(image.width, image.height, pixels)));
}

}  // namespace reflectree
