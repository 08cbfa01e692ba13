// SPDX-License-Identifier: Apache-2.0
// Pictures go out and come back; damaged ones end in an Error, never in a crash.
#include "reflectree/picture/image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "../error_words.hpp"
#include "../scratch.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

Image noise(int width, int height, std::vector<std::string> channels) {
  Image image = make_image(width, height, std::move(channels));
  Pcg32 u(7);
  for (float& v : image.values) v = std::exp2(20 * to_unit_float(u()) - 10);
  return image;
}

TEST(Image, ExrReturnsEveryBitLayerAndWord) {
  Image image = noise(17, 5, {"B", "G", "R", "stderr.B", "stderr.R"});
  image.metadata["seed"] = "11";
  const std::string path = scratch("a.exr");
  write_exr(path, image);
  const Image back = read_image(path);
  EXPECT_EQ(back.channels, image.channels);
  EXPECT_EQ(back.values, image.values);
  EXPECT_EQ(back.metadata.at("seed"), "11");
  Bytes bytes = read_file(path, 1 << 20);
  for (std::size_t n = 0; n < bytes.size(); n += 7) {
    EXPECT_THROW(read_exr(ByteView(bytes).first(n), path), Error) << n;
  }
  std::filesystem::remove(path);
}

TEST(Image, ExrHeadersThatLieAreRefusedBeforeMemoryIsAskedFor) {
  const std::string path = scratch("lies.exr");
  write_exr(path, noise(4, 4, {"B", "G", "R"}));
  const Bytes good = read_file(path, 1 << 20);
  const std::string text(good.begin(), good.end());
  const auto with = [&](const std::string& name, std::size_t behind, std::uint32_t v) {
    Bytes bad = good;
    const std::size_t at = text.find(name) + name.size() + 1 + behind;
    for (std::size_t i = 0; i < 4; ++i) bad[at + i] = std::uint8_t(v >> (8 * i));
    return bad;
  };
  // Name, 0, "box2i", 0, size, then the box.
  EXPECT_THROW(read_exr(with("dataWindow", 6 + 4 + 8, 1000000), path), Error) << "a million columns";
  EXPECT_THROW(read_exr(with("dataWindow", 6, 0x7fffffff), path), Error) << "an attribute of 2 GB";
  EXPECT_NO_THROW(read_exr(with("dataWindow", 6 + 4 + 8, 3), path)) << "as it was";
}

TEST(Image, PngReturnsColoursAndRefusesDamage) {
  Image image = make_image(3, 1, {"R", "G", "B"});
  image.values = {0, .5f, 1, 2, -1, .25f, NAN, 0, 0};
  const std::string path = scratch("a.png");
  write_png(path, image);
  const Image back = read_image(path);
  const float expected[] = {0, .5f, 1, 1, 0, .25f, 1, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(from_srgb(back.values[i]), expected[i], .005) << i;
  const Bytes bytes = read_file(path, 1 << 20);
  EXPECT_THROW(read_png(ByteView(bytes).first(40), path), Error);
  std::filesystem::remove(path);
}

// Pixel 0 of a picture of one pixel whose channels hold 1, 2, 3, ...
std::vector<float> shown(const std::vector<std::string>& channels) {
  Image image = make_image(1, 1, channels);
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(i + 1);
  return colours_of(image, "a.exr").values;
}

std::string refused(const std::vector<std::string>& channels) {
  return error_words([&] { shown(channels); }, "taken");
}

TEST(Image, ColoursAreFoundByName) {
  using Values = std::vector<float>;
  EXPECT_EQ(shown({"B", "G", "R"}), (Values{3, 2, 1}));
  EXPECT_EQ(shown({"A", "B", "G", "R"}), (Values{4, 3, 2}));
  EXPECT_EQ(shown({"b", "g", "r"}), (Values{3, 2, 1}));
  EXPECT_EQ(shown({"A", "Y"}), (Values{2}));
  EXPECT_EQ(shown({"Y", "Z"}), (Values{1})) << "luminance and depth";
  EXPECT_EQ(shown({"B", "G", "R", "Z", "stderr.B", "stderr.G", "stderr.R"}), (Values{3, 2, 1}));
  EXPECT_EQ(shown({"diffuse.B", "diffuse.G", "diffuse.R"}), (Values{3, 2, 1}));
  EXPECT_NE(refused({"B", "R"}).find("no channel G"), std::string::npos);
  EXPECT_NE(refused({"R"}).find("no channel G"), std::string::npos);
  EXPECT_NE(refused({"A"}).find("no channels R, G and B"), std::string::npos);
  EXPECT_NE(refused({"a.B", "a.G", "a.R", "b.Y"}).find("several layers"), std::string::npos);
  EXPECT_NE(refused({"BY", "RY", "Y"}).find("chroma"), std::string::npos);
}

TEST(Image, EncodedValuesBecomeLightUnlessTheyAreRaw) {
  Image image = make_image(1, 1, {"R", "G", "B"});
  image.values = {128 / 255.f, 0, 1}, image.encoded = true;
  EXPECT_NEAR(colours_of(image, "a.png").values[0], .2159, 1e-4);
  EXPECT_FALSE(colours_of(image, "a.png").encoded);
  EXPECT_EQ(colours_of(image, "a.png", true).values, image.values);
  image.values[1] = NAN;
  EXPECT_THROW(colours_of(image, "a.png"), Error);
}

Bytes hdr(const std::string& size, std::initializer_list<int> pixels) {
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
  Bytes bytes(head.begin(), head.end());
  for (const int v : pixels) bytes.push_back(std::uint8_t(v));
  return bytes;
}

TEST(Image, HdrFlatAndCoded) {
  const Image flat = read_hdr(hdr("-Y 1 +X 2", {128, 64, 0, 129, 1, 2, 3, 0}), "flat");
  EXPECT_EQ(flat.values, (std::vector<float>{1, .5f, 0, 0, 0, 0}));
  const Image coded = read_hdr(hdr("-Y 1 +X 8", {2, 2, 0, 8, 136, 128, 136, 64, 136, 32, 136, 129}), "coded");
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(coded.values[3 * i + 1], .5f);
}

TEST(Image, HdrNeverTrustsALength) {
  const Bytes good = hdr("-Y 1 +X 8", {2, 2, 0, 8, 136, 128, 136, 64, 136, 32, 136, 129});
  for (std::size_t n = 0; n < good.size(); ++n) EXPECT_THROW(read_hdr(ByteView(good).first(n), "cut"), Error);
  EXPECT_THROW(read_hdr(hdr("-Y 1 +X 8", {2, 2, 0, 8, 137, 128}), "run beyond the row"), Error);
  EXPECT_THROW(read_hdr(hdr("-Y 1 +X 8", {2, 2, 0, 8, 0, 128}), "run of nothing"), Error);
  EXPECT_THROW(read_hdr(hdr("-Y 99999 +X 99999", {2, 2}), "a size that lies"), Error);
  EXPECT_THROW(read_hdr(hdr("-Y -1 +X 8", {2, 2}), "a negative size"), Error);
}

}  // namespace
}  // namespace reflectree
