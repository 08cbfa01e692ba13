// SPDX-License-Identifier: Apache-2.0
// Radiance RGBE: a text header, a line of resolution, then scanlines, each flat or run-length coded by
// component. Ward 1991, "Real Pixels". Nothing in the file is trusted: every run is checked.
#include <charconv>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/picture/image.hpp"

namespace reflectree {

namespace {

std::string line_of(ByteReader& in) {
  std::string line;
  while (line.size() < 4096) {
    const char c = char(in.u8());
    if (c == '\n') return line;
    line += c;
  }
  throw Error("a line of the header does not end", in.where(), "the file is damaged");
}

int number_after(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(key);
  int value = 0;
  if (at != std::string::npos)
    std::from_chars(line.data() + at + key.size(), line.data() + line.size(), value);
  return value;
}

// One scanline as four planes.
void read_scanline(ByteReader& in, std::size_t width, std::vector<std::uint8_t>& planes) {
  const auto damaged = [&] { return Error("a scanline is damaged", in.where(), "fetch the file again"); };
  const auto take4 = [&](std::uint8_t* out) {
    for (int k = 0; k < 4; ++k) out[k] = in.u8();
  };
  std::uint8_t head[4];
  take4(head);
  const bool coded = width >= 8 && width < 32768 && head[0] == 2 && head[1] == 2 && head[2] < 128;
  if (!coded) {
    for (std::size_t x = 0; x < width; ++x) {
      if (x > 0) take4(head);
      if (head[0] == 1 && head[1] == 1 && head[2] == 1) throw damaged();  // the coding of before 1991
      for (std::size_t k = 0; k < 4; ++k) planes[k * width + x] = head[k];
    }
    return;
  }
  if (std::size_t(head[2]) * 256 + head[3] != width) throw damaged();
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t x = 0; x < width;) {
      const unsigned count = in.u8();
      const bool run = count > 128;
      const std::size_t length = run ? count - 128 : count;
      if (length == 0 || length > width - x) throw damaged();
      const std::uint8_t same = run ? in.u8() : std::uint8_t(0);
      for (std::size_t i = 0; i < length; ++i) planes[k * width + x++] = run ? same : in.u8();
    }
  }
}

}  // namespace

Image read_hdr(ByteView bytes, const std::string& where) {
  ByteReader in(bytes, where);
  bool rgbe = false;
  for (std::string line = line_of(in); !line.empty(); line = line_of(in)) {
    rgbe = rgbe || line == "FORMAT=32-bit_rle_rgbe";
  }
  const std::string size = line_of(in);
  const int height = number_after(size, "-Y "), width = number_after(size, "+X ");
  if (!rgbe || size.rfind("-Y ", 0) != 0 || width <= 0 || height <= 0) {
    throw Error("not an RGBE picture with rows from the top ('-Y H +X W')", where, "convert it");
  }
  // A scanline takes at least two bytes for each 127 of its pixels: sizes beyond that are lies.
  if (std::uint64_t(width) * std::uint64_t(height) / 64 > bytes.size()) {
    throw Error("shorter than its size says", where, "fetch the file again");
  }
  Image image = make_image(width, height, {"R", "G", "B"});
  const auto w = std::size_t(width);
  std::vector<std::uint8_t> planes(4 * w);
  float* out = image.values.data();
  for (int y = 0; y < height; ++y) {
    read_scanline(in, w, planes);
    for (std::size_t x = 0; x < w; ++x) {
      const int e = planes[3 * w + x];
      const float scale = e ? std::ldexp(1.f, e - 136) : 0.f;
      for (std::size_t k = 0; k < 3; ++k) *out++ = float(planes[k * w + x]) * scale;
    }
  }
  return image;
}

}  // namespace reflectree
