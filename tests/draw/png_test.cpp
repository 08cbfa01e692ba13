// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/png.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include "reflectree/error.hpp"

namespace reflectree::draw {
namespace {

TEST(Png, LibpngReadsBackEveryPixel) {
  IndexedImage image{31, 17, std::vector<std::uint8_t>(31 * 17)};
  for (std::size_t i = 0; i < image.index.size(); ++i) image.index[i] = std::uint8_t(i * 7 % 256);
  const std::vector<std::uint8_t> bytes = encode_png(image, palette());
  png_image reader{};
  reader.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&reader, bytes.data(), bytes.size()), 0) << reader.message;
  ASSERT_EQ(reader.width, 31U);
  ASSERT_EQ(reader.height, 17U);
  reader.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(reader));
  ASSERT_NE(png_image_finish_read(&reader, nullptr, rgba.data(), 0, nullptr), 0) << reader.message;
  for (std::size_t i = 0; i < image.index.size(); ++i) {
    const std::uint8_t index = image.index[i];
    EXPECT_EQ(rgba[4 * i + 3], index == 0 ? 0 : 255);
    if (index > 0) {
      EXPECT_EQ((Rgb8{rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]}), palette()[index - 1U]);
    }
  }
}

TEST(Png, RefusesSizesThatDisagree) {
  EXPECT_THROW(encode_png({4, 4, std::vector<std::uint8_t>(15)}, palette()), Error);
  EXPECT_THROW(encode_png({0, 4, {}}, palette()), Error);
}

TEST(Base64, Rfc4648Vectors) {
  const auto encoded = [](const std::string& s) {
    return base64(std::vector<std::uint8_t>(s.begin(), s.end()));
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace reflectree::draw
