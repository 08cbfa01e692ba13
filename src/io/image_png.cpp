// SPDX-License-Identifier: Apache-2.0
// PNG through libpng's simplified interface, which reports errors as values.
#include <png.h>

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/io/file.hpp"
#include "reflectree/io/image.hpp"

namespace reflectree {

Image read_png(ByteView bytes, const std::string& where) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto fail = [&] {
    const std::string why = png.message;
    png_image_free(&png);
    return Error("libpng cannot read it (" + why + ")", where, "save the picture again");
  };
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) throw fail();
  png.format = PNG_FORMAT_RGB;
  if (png.width > (1U << 16U) || png.height > (1U << 16U)) throw fail();
  Image image = make_image(int(png.width), int(png.height), {"R", "G", "B"});
  Bytes pixels(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr)) throw fail();
  std::transform(pixels.begin(), pixels.end(), image.values.begin(),
                 [](std::uint8_t v) { return float(v) / 255; });
  return image;
}

void write_png(const std::string& path, const Image& image, float exposure) {
  const int channel[3] = {image.find("R"), image.find("G"), image.find("B")};
  if (std::min({channel[0], channel[1], channel[2]}) < 0) {
    throw Error("no channels R, G and B", path, "name the channels so");
  }
  const float scale = std::exp2(exposure);
  Bytes pixels;
  for (std::size_t at = 0; at < image.values.size(); at += image.channels.size()) {
    float v[3];
    for (int k = 0; k < 3; ++k) v[k] = scale * image.values[at + std::size_t(channel[k])];
    if (std::isnan(v[0] + v[1] + v[2])) v[0] = v[2] = 1, v[1] = 0;
    for (const float linear : v) {
      pixels.push_back(std::uint8_t(std::lround(255 * to_srgb(std::clamp(linear, 0.f, 1.f)))));
    }
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(image.width), png.height = png_uint_32(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  Bytes out(size);
  if (!png_image_write_to_memory(&png, out.data(), &size, 0, pixels.data(), 0, nullptr)) {
    throw Error(std::string("libpng cannot write it (") + png.message + ")", path, "make it smaller");
  }
  out.resize(size);
  write_file_atomically(path, ByteView(out));
}

}  // namespace reflectree
