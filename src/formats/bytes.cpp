// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/bytes.hpp"

#include <algorithm>
#include <cstring>

#include "reflectree/error.hpp"

namespace reflectree {

ByteView ByteReader::take(std::uint64_t count) {
  if (count > remaining()) {
    throw Error("truncated: " + std::to_string(count) + " bytes wanted at offset " +
                    std::to_string(position_) + ", " + std::to_string(remaining()) + " left",
                where_, "fetch the file again");
  }
  const ByteView view = bytes_.subspan(position_, count);
  position_ += count;
  return view;
}

void ByteReader::seek(std::uint64_t offset) {
  if (offset > bytes_.size()) {
    throw Error("damaged: offset " + std::to_string(offset) + " lies beyond the end at " +
                    std::to_string(bytes_.size()),
                where_, "fetch the file again");
  }
  position_ = offset;
}

std::uint64_t ByteReader::integer(int bytes) {
  const ByteView view = take(std::uint64_t(bytes));
  std::uint64_t v = 0;
  for (int i = bytes - 1; i >= 0; --i) v = (v << 8U) | view[std::size_t(i)];
  return v;
}

float ByteReader::f32() {
  const std::uint32_t bits = u32();
  float v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

double ByteReader::f64() {
  const std::uint64_t bits = u64();
  double v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

std::string ByteReader::text(std::uint64_t count) {
  const ByteView view = take(count);
  return {view.begin(), view.end()};
}

bool starts_with(ByteView bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return std::uint8_t(a) == b; });
}

void append_u32(Bytes& out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out.push_back(std::uint8_t(v >> (8 * i)));
}

void append_u64(Bytes& out, std::uint64_t v) {
  for (int i = 0; i < 8; ++i) out.push_back(std::uint8_t(v >> (8 * i)));
}

void append_f32(Bytes& out, float v) {
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  append_u32(out, bits);
}

void append_f64(Bytes& out, double v) {
  std::uint64_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  append_u64(out, bits);
}

void append_text(Bytes& out, std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }

}  // namespace reflectree
