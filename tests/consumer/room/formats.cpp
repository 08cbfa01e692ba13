// SPDX-License-Identifier: Apache-2.0
// A sampler through a file's bytes; nothing but the standard library comes along.
#include <reflectree/formats/sampler_file.hpp>
#include <reflectree/sampler/sampler.hpp>

int main() {
  using namespace reflectree;
  const SamplerData data = build([](Direction, Direction) { return 0.3f; });
  return decode_sampler(encode_sampler(data), "memory") == data ? 0 : 1;
}
