// SPDX-License-Identifier: Apache-2.0
// libFuzzer's way in, compiled once a target with REFLECTREE_FUZZ_TARGET = its name.
#include "targets.hpp"

namespace {

const reflectree::fuzz::Target& chosen() {
  for (const auto& target : reflectree::fuzz::targets()) {
    if (target.name == REFLECTREE_FUZZ_TARGET) return target;
  }
  __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto& target = chosen();
  target.run({data, size});
  return 0;
}
