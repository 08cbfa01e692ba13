// SPDX-License-Identifier: Apache-2.0
#include "reflectree/picture/png.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include "reflectree/error.hpp"

namespace reflectree {
namespace {

TEST(Png, LibpngReadsBackEveryPixel) {
  std::vector<std::uint8_t> indices(31 * 17);
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = std::uint8_t(i * 7 % 256);
  std::vector<Rgb8> palette;
  for (int i = 0; i < 255; ++i)
    palette.push_back({std::uint8_t(i), std::uint8_t(255 - i), std::uint8_t(i / 2)});
  const Bytes bytes = encode_indexed_png(31, 17, indices, palette);
  png_image reader{};
  reader.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&reader, bytes.data(), bytes.size()), 0) << reader.message;
  ASSERT_EQ(reader.width, 31U);
  ASSERT_EQ(reader.height, 17U);
  reader.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(reader));
  ASSERT_NE(png_image_finish_read(&reader, nullptr, rgba.data(), 0, nullptr), 0) << reader.message;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::uint8_t index = indices[i];
    EXPECT_EQ(rgba[4 * i + 3], index == 0 ? 0 : 255);
    if (index > 0) {
      EXPECT_EQ((Rgb8{rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]}), palette[index - 1U]);
    }
  }
}

TEST(Png, RefusesSizesThatDisagree) {
  const std::vector<std::uint8_t> fifteen(15);
  const std::vector<Rgb8> colours(15);
  EXPECT_THROW(encode_indexed_png(4, 4, fifteen, colours), Error);
  EXPECT_THROW(encode_indexed_png(0, 4, {}, colours), Error);
  EXPECT_THROW(encode_indexed_png(3, 5, fifteen, std::vector<Rgb8>(256)), Error);
  EXPECT_THROW(encode_png(4, 4, colours), Error);
  EXPECT_NO_THROW(encode_png(3, 5, colours));
}

}  // namespace
}  // namespace reflectree
