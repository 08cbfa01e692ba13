// SPDX-License-Identifier: Apache-2.0
#include "reflectree/io/npy.hpp"

#include <cassert>

namespace reflectree {

Bytes encode_npy(std::span<const float> values, std::span<const std::size_t> shape) {
  std::string dimensions;
  std::size_t count = 1;
  for (const std::size_t n : shape) {
    dimensions += std::to_string(n) + ",";  // the comma after a single one makes it a tuple
    count *= n;
  }
  assert(count == values.size());
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + dimensions + "), }";
  // Magic, version and length take 10 bytes; blanks and a line feed fill up to a multiple of 64.
  header.append((64 - (10 + header.size() + 1) % 64) % 64, ' ');
  header += '\n';

  Bytes out;
  out.reserve(10 + header.size() + 4 * count);
  append_text(out, std::string_view("\x93NUMPY\x01\x00", 8));
  out.push_back(std::uint8_t(header.size() & 0xffU));
  out.push_back(std::uint8_t(header.size() >> 8U));
  append_text(out, header);
  for (const float v : values) append_f32(out, v);
  return out;
}

}  // namespace reflectree
