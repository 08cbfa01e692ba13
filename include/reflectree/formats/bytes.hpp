// SPDX-License-Identifier: Apache-2.0
// A bounded little-endian reader: every length, offset and count of a file is checked here, once.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace reflectree {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

// Reads from front to back; throws Error, naming `where`, when bytes are missing.
class ByteReader {
 public:
  ByteReader(ByteView bytes, std::string where) : bytes_(bytes), where_(std::move(where)) {}

  std::uint8_t u8() { return std::uint8_t(integer(1)); }
  std::uint16_t u16() { return std::uint16_t(integer(2)); }
  std::uint32_t u32() { return std::uint32_t(integer(4)); }
  std::uint64_t u64() { return integer(8); }
  float f32();
  double f64();
  ByteView take(std::uint64_t count);
  std::string text(std::uint64_t count);
  void seek(std::uint64_t offset);

  std::uint64_t remaining() const { return bytes_.size() - position_; }
  const std::string& where() const { return where_; }

 private:
  std::uint64_t integer(int bytes);

  ByteView bytes_;
  std::uint64_t position_ = 0;
  std::string where_;
};

// Whether the bytes begin with `magic`.
bool starts_with(ByteView bytes, std::string_view magic);

// Appends little-endian values.
void append_u32(Bytes& out, std::uint32_t v);
void append_u64(Bytes& out, std::uint64_t v);
void append_f32(Bytes& out, float v);
void append_f64(Bytes& out, double v);
void append_text(Bytes& out, std::string_view text);

}  // namespace reflectree
