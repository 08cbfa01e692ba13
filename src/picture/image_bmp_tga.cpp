// SPDX-License-Identifier: Apache-2.0
// BMP and TGA by stb_image, which takes what a cut file lacks for zeros:
// whether all pixels are there is asked before.
#include <cstdlib>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#include <stb/stb_image.h>

#include <algorithm>

#include "reflectree/error.hpp"
#include "reflectree/picture/image.hpp"

namespace reflectree {

namespace {

// Throws Error where the bytes end before.
void need(ByteView bytes, const std::string& where, std::uint64_t count) {
  ByteReader(bytes, where).take(count);
}

// Rows of uncompressed pixels, each filled up to four bytes.
void need_all_of_bmp(ByteView bytes, const std::string& where) {
  ByteReader in(bytes, where);
  in.seek(10);
  const std::uint64_t begin = in.u32();
  const bool old = in.u32() == 12;
  const std::int64_t width = old ? in.u16() : std::int32_t(in.u32()),
                     height = old ? in.u16() : std::int32_t(in.u32());
  in.take(2);
  const std::uint64_t row = (std::uint64_t(std::abs(width)) * in.u16() + 31) / 32 * 4;
  need(bytes, where, begin + row * std::uint64_t(std::abs(height)));
}

// A header of 18 bytes, a name, a palette, pixels: as they are, or in packets of up to 128, alike or not.
void need_all_of_tga(ByteView bytes, const std::string& where) {
  ByteReader in(bytes, where);
  const std::uint64_t name = in.u8(), palette = in.u8(), kind = in.u8();
  in.take(2);
  const std::uint64_t entries = in.u16(), entry_bits = in.u8();
  in.take(4);
  const std::uint64_t width = in.u16(), height = in.u16(), size = (std::uint64_t(in.u8()) + 7) / 8;
  in.take(1);
  in.take(name + (palette ? entries * ((entry_bits + 7) / 8) : 0));
  if (kind < 8) {
    in.take(width * height * size);
    return;
  }
  for (std::uint64_t left = width * height; left > 0;) {
    const std::uint64_t head = in.u8(), count = head % 128 + 1;
    in.take((head < 128 ? count : 1) * size);
    left -= std::min(left, count);
  }
}

Image read(ByteView bytes, const std::string& where, const char* kind) {
  int width = 0, height = 0, channels = 0;
  const auto fail = [&] {
    const char* reason = stbi_failure_reason();
    return Error(
        "a " + std::string(kind) + " picture that cannot be read (" + (reason ? reason : "damaged") + ")",
        where, "save it as PNG");
  };
  const auto size = int(std::min<std::size_t>(bytes.size(), std::size_t(1) << 30U));
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels)) throw fail();
  // A run of TGA takes two bytes for 128 pixels.
  if (std::uint64_t(std::abs(width)) * std::uint64_t(std::abs(height)) / 128 > bytes.size())
    throw Error("shorter than its size says", where, "fetch the file again");
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 0), stbi_image_free);
  if (!pixels) throw fail();
  const std::vector<std::string> names[] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  if (channels < 1 || channels > 4) throw fail();
  Image image = make_image(width, height, names[channels - 1]);
  image.encoded = true;
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(pixels.get()[i]) / 255;
  return image;
}

}  // namespace

Image read_bmp(ByteView bytes, const std::string& where) {
  need_all_of_bmp(bytes, where);
  return read(bytes, where, "BMP");
}
Image read_tga(ByteView bytes, const std::string& where) {
  need_all_of_tga(bytes, where);
  return read(bytes, where, "TGA");
}

}  // namespace reflectree
