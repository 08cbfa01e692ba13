// SPDX-License-Identifier: Apache-2.0
// Damaged files of every kind: each is either refused with a one-line Error, or read as a BRDF that is
// finite and not negative. Nothing else may happen; the sanitizers watch.
#include <gtest/gtest.h>

#include "measured_data.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/merl.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

struct Outcome {
  bool refused = false;
  std::string words;
};

Outcome read(ByteView bytes, const std::string& member = "") {
  static const Pairs pairs = random_pairs(20, 0.5f, 13);
  try {
    const AnyBrdf f = read_brdf(bytes, "file", member);
    std::vector<float> values(pairs.wo.size() * 3);
    f.eval(pairs.wo, pairs.wi, values);
    for (const float v : values) EXPECT_TRUE(v >= 0 && std::isfinite(v)) << v;
    return {};
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).rfind("file: ", 0), 0U) << e.what();
    return {true, e.what()};
  }
}

// A file that is read whole and refused at every shorter length in `lengths`.
void expect_truncations_refused(const Bytes& bytes, const std::string& member, std::size_t step) {
  EXPECT_FALSE(read(bytes, member).refused);
  for (std::size_t n = 0; n < bytes.size(); n += step) {
    ASSERT_TRUE(read(ByteView(bytes).first(n), member).refused) << n << " of " << bytes.size();
  }
  EXPECT_TRUE(read(ByteView(bytes).first(bytes.size() - 1), member).refused);
}

// How many single flipped bits are noticed.
int refused_flips(Bytes bytes, const std::string& member, std::size_t first, std::size_t last,
                  std::size_t step) {
  int refused = 0;
  for (std::size_t bit = first * 8; bit < last * 8; bit += step) {
    const auto mask = std::uint8_t(1U << (bit % 8));
    bytes[bit / 8] ^= mask;
    refused += read(bytes, member).refused ? 1 : 0;
    bytes[bit / 8] ^= mask;
  }
  return refused;
}

TEST(Damage, EmptyAndForeignFilesAreNamed) {
  EXPECT_NE(read({}).words.find("empty"), std::string::npos);
  for (const char* text : {"x", "tensor_fil", "solid cube\n", "version https://example.com\n"}) {
    EXPECT_NE(read(synthetic::as_bytes(text)).words.find("not a material"), std::string::npos) << text;
  }
  EXPECT_TRUE(read(Bytes(100, 0)).refused);
  EXPECT_TRUE(read(Bytes(100, 0xff)).refused);
}

TEST(Damage, Rgl) {
  const Bytes bytes = synthetic::rgl_file();
  expect_truncations_refused(bytes, "", 1);
  // The header: names, types, offsets, shapes.
  const std::size_t header = 18 + 7 * 13 + 8 * 16 + 50;
  EXPECT_GT(refused_flips(bytes, "", 0, header, 1), 1000);
  refused_flips(bytes, "", header, bytes.size(), 13);
  EXPECT_TRUE(read(bytes, "member").refused);
}

TEST(Damage, RglWithImpossibleSizes) {
  using synthetic::floats;
  const auto refused = [](std::size_t index, const synthetic::Field& field) {
    auto fields = synthetic::rgl_fields({});
    fields[index] = field;
    return read(synthetic::tensor_file(fields)).refused;
  };
  const std::uint64_t huge = std::uint64_t(1) << 62U;
  EXPECT_TRUE(refused(4, {"vndf", 10, {1, huge, huge, 16}, {}}));
  EXPECT_TRUE(refused(4, {"vndf", 10, {1, 4, 0, 0}, {}}));
  EXPECT_TRUE(refused(4, {"vndf", 10, {1, 4, 1, 1}, Bytes(16, 0)}));
  EXPECT_TRUE(refused(4, {"vndf", 10, std::vector<std::uint64_t>(9, 1), Bytes(4, 0)}));
  EXPECT_TRUE(refused(1, floats("theta_i", {4}, {0, 1, 1, 1.5f}))) << "must ascend";
  EXPECT_TRUE(refused(1, floats("theta_i", {4}, {0, 0.5f, 1, 3}))) << "beyond pi/2";
  EXPECT_TRUE(refused(1, floats("theta_i", {4}, {0, 0.5f, std::nanf(""), 1.5f})));
  EXPECT_TRUE(refused(2, floats("sigma", {2, 2}, {1, 0, 1, 0}))) << "divides";
  EXPECT_TRUE(refused(2, floats("sigma", {2, 2}, {1, 0.5f, 1, 0.4f}))) << "varies with azimuth";
  EXPECT_TRUE(refused(3, floats("ndf", {2, 2}, {1, INFINITY, 1, INFINITY})));
  EXPECT_TRUE(refused(6, {"jacobian", 10, {1}, Bytes(4, 0)}));
  // A warp without mass and a material without light are odd, not wrong.
  synthetic::RglRecipe dark;
  dark.vndf = [](int, float, float) { return 0.f; };
  EXPECT_FALSE(read(synthetic::rgl_file(dark)).refused);
}

TEST(Damage, ControlCharactersOfAFileDoNotReachTheTerminal) {
  auto fields = synthetic::rgl_fields({});
  fields[4] = {"a\nb\x1b[31m", 10, {1U << 30U}, {}};
  EXPECT_NE(read(synthetic::tensor_file(fields)).words.find("'a?b?[31m'"), std::string::npos);
}

TEST(Damage, Merl) {
  Bytes bytes = write_merl(tabulate_merl(Lambert{}));
  EXPECT_FALSE(read(bytes).refused);
  EXPECT_FALSE(read(bytes, "linear").refused);
  EXPECT_TRUE(read(bytes, "cubic").refused);
  for (const std::size_t n : {std::size_t{1}, std::size_t{11}, std::size_t{12}, std::size_t{13},
                              bytes.size() / 2, bytes.size() - 1}) {
    EXPECT_TRUE(read(ByteView(bytes).first(n)).refused) << n;
  }
  EXPECT_EQ(refused_flips(bytes, "", 0, 12, 1), 96) << "every bit of the dimensions counts";
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_TRUE(read(longer).refused);
  Bytes infinite;
  append_f64(infinite, HUGE_VAL);
  std::copy(infinite.begin(), infinite.end(), bytes.begin() + 12 + 8 * 1000);
  EXPECT_NE(read(bytes).words.find("entry 1000 is not finite"), std::string::npos);
}

TEST(Damage, Tables) {
  for (const std::string& text : {synthetic::sgd_csv(), synthetic::abc_csv()}) {
    const Bytes bytes = synthetic::as_bytes(text);
    for (std::size_t n = 0; n < bytes.size(); ++n) read(ByteView(bytes).first(n));
    EXPECT_TRUE(read(ByteView(bytes).first(text.find('\n'))).refused);
    EXPECT_TRUE(read(ByteView(bytes).first(text.rfind(','))).refused);
    EXPECT_GT(refused_flips(bytes, "", 0, bytes.size(), 1), 100);
  }
  const Bytes networks = synthetic::as_bytes(synthetic::neural_csv());
  for (std::size_t n = 0; n < networks.size(); n += 97)
    EXPECT_TRUE(read(ByteView(networks).first(n), "two").refused);
  refused_flips(networks, "two", 0, networks.size(), 401);
  std::string wide = "material";
  for (int i = 0; i < 5000; ++i) wide += ",c";
  EXPECT_NE(read(synthetic::as_bytes(wide + "\n")).words.find("too many columns"), std::string::npos);
  EXPECT_TRUE(read(synthetic::as_bytes("material," + std::string(100000, 'x'))).refused);
}

}  // namespace
}  // namespace reflectree
