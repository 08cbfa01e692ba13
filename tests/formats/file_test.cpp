// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/npy.hpp"

namespace reflectree {
namespace {

std::string error_of(const std::string& path, std::uint64_t limit = 100) {
  return error_words([&] { read_file(path, limit); });
}

TEST(File, RoundTripReplacesAndLeavesNothingBehind) {
  const TemporaryFolder folder("file");
  write_file_atomically(folder / "a", "old and longer");
  write_file_atomically(folder / "a", std::string_view("new\0", 4));
  EXPECT_EQ(read_file(folder / "a", 4), (Bytes{'n', 'e', 'w', 0}));
  int entries = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
    EXPECT_EQ(entry.path().filename(), "a");
    ++entries;
  }
  EXPECT_EQ(entries, 1);
}

TEST(File, ErrorsAreOneLineWithWhatWhereAndHow) {
  const TemporaryFolder folder("file");
  write_file_atomically(folder / "five", "12345");
  EXPECT_EQ(error_of(folder / "none"), (folder / "none") + ": no such file; check the path");
  EXPECT_NE(error_of(folder / "").find(": is a directory; "), std::string::npos);
  EXPECT_NE(error_of(folder / "five", 4).find(": larger than 4 bytes; "), std::string::npos);
  EXPECT_EQ(error_of(folder / "five", 5), "no error");
  EXPECT_THROW(write_file_atomically(folder / "no/such/folder", "x"), Error);
  EXPECT_THROW(write_file_atomically(folder / "", "x"), Error);
  for (const char* path : {"none", "", "five"}) {
    try {
      load_brdf(folder / path);
      ADD_FAILURE() << path;
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(File, OversizedMaterialsAreRefusedBeforeTheyAreParsed) {
  const TemporaryFolder folder("file");
  write_file_atomically(folder / "big", "material,a\n");
  std::filesystem::resize_file(folder / "big", 100'000'000);  // sparse
  try {
    load_brdf(folder / "big");
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("larger than 16777216 bytes"), std::string::npos) << e.what();
  }
}

TEST(File, AFailedWriteKeepsTheOldFile) {
  const TemporaryFolder folder("file");
  std::filesystem::create_directories(folder / "taken/inside");  // a folder cannot be replaced by a file
  EXPECT_THROW(write_file_atomically(folder / "taken", "x"), Error);
  EXPECT_TRUE(std::filesystem::is_directory(folder / "taken/inside"));
  int entries = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
    entries += entry.exists() ? 1 : 0;
  EXPECT_EQ(entries, 1) << "the temporary file must be gone";
}

TEST(Bytes, ReaderIsBoundedAndLittleEndian) {
  Bytes bytes;
  append_u32(bytes, 0x04030201);
  append_f32(bytes, -1.5f);
  append_f64(bytes, 0.1);
  append_u64(bytes, 0x0102030405060708);
  EXPECT_EQ(bytes[0], 1);
  EXPECT_EQ(bytes[3], 4);
  ByteReader in(bytes, "b");
  EXPECT_EQ(in.u16(), 0x0201);
  EXPECT_EQ(in.u16(), 0x0403);
  EXPECT_EQ(in.f32(), -1.5f);
  EXPECT_EQ(in.f64(), 0.1);
  EXPECT_EQ(in.u64(), 0x0102030405060708U);
  EXPECT_EQ(in.remaining(), 0U);
  EXPECT_THROW(in.u8(), Error);
  EXPECT_THROW(in.seek(bytes.size() + 1), Error);
  in.seek(20);
  EXPECT_THROW(in.take(~std::uint64_t{0}), Error);
  EXPECT_EQ(in.take(4).size(), 4U);
}

TEST(Npy, HeaderIsThatOfTheFormat) {
  const std::vector<float> values{1, 2, 3, 4, 5, 6};
  const std::size_t shape[] = {2, 3}, flat[] = {6};
  for (const Bytes& bytes : {encode_npy(values, shape), encode_npy(values, flat)}) {
    ASSERT_TRUE(starts_with(bytes, std::string_view("\x93NUMPY\x01\x00", 8)));
    const std::size_t header = bytes[8] + 256U * bytes[9];
    EXPECT_EQ((10 + header) % 64, 0U);
    EXPECT_EQ(bytes[10 + header - 1], '\n');
    EXPECT_EQ(bytes.size(), 10 + header + 24);
    ByteReader in(bytes, "npy");
    in.seek(10 + header);
    for (const float v : values) EXPECT_EQ(in.f32(), v);
  }
  const Bytes bytes = encode_npy(values, shape);
  const std::string text(bytes.begin() + 10, bytes.begin() + 80);
  EXPECT_NE(text.find("{'descr': '<f4', 'fortran_order': False, 'shape': (2,3,), }"), std::string::npos);
}

TEST(Npy, NumpyReadsIt) {
  if (std::string(REFLECTREE_PYTHON).empty()) GTEST_SKIP() << "no python3 with numpy";
  const TemporaryFolder folder("npy");
  const std::vector<float> values{1, 2, 3, 4, 5, 6};
  const std::size_t shape[] = {2, 3};
  write_file_atomically(folder / "a.npy", encode_npy(values, shape));
  const std::string command =
      std::string("\"") + REFLECTREE_PYTHON +
      "\" -c \"import numpy, sys; a = numpy.load(sys.argv[1]); assert a.dtype == 'f4' and "
      "a.shape == (2, 3) and a[1, 0] == 4\" \"" +
      (folder / "a.npy") + "\"";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace reflectree
