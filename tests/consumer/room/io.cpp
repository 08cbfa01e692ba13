// SPDX-License-Identifier: Apache-2.0
// A sampler through a file's bytes, and the pictures' libraries.
#include <reflectree/error.hpp>
#include <reflectree/io/image.hpp>
#include <reflectree/io/sampler_file.hpp>
#include <reflectree/sampler/sampler.hpp>

int main() {
  using namespace reflectree;
  const SamplerData data = build([](Direction, Direction) { return 0.3f; });
  if (decode_sampler(encode_sampler(data), "memory") != data) return 1;
  try {
    read_png({}, "nothing");
  } catch (const Error&) {
    return 0;
  }
  return 1;
}
