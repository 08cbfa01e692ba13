// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/npy.hpp"

#include <cassert>

namespace reflectree {

namespace {

// Everything before the values.
Bytes npy_header(const std::string& type, std::size_t values, std::span<const std::size_t> shape) {
  std::string dimensions;
  [[maybe_unused]] std::size_t count = 1;
  for (const std::size_t n : shape) {
    dimensions += std::to_string(n) + ",";  // the comma after a single one makes it a tuple
    count *= n;
  }
  assert(count == values);
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + dimensions + "), }";
  // Magic, version and length take 10 bytes; blanks and a line feed fill up to a multiple of 64.
  header.append((64 - (10 + header.size() + 1) % 64) % 64, ' ');
  header += '\n';

  Bytes out;
  out.reserve(10 + header.size() + 8 * values);
  append_text(out, std::string_view("\x93NUMPY\x01\x00", 8));
  out.push_back(std::uint8_t(header.size() & 0xffU));
  out.push_back(std::uint8_t(header.size() >> 8U));
  append_text(out, header);
  return out;
}

}  // namespace

Bytes encode_npy(std::span<const float> values, std::span<const std::size_t> shape) {
  Bytes out = npy_header("<f4", values.size(), shape);
  for (const float v : values) append_f32(out, v);
  return out;
}

Bytes encode_npy(std::span<const double> values, std::span<const std::size_t> shape) {
  Bytes out = npy_header("<f8", values.size(), shape);
  for (const double v : values) append_f64(out, v);
  return out;
}

}  // namespace reflectree
