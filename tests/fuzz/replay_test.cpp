// SPDX-License-Identifier: Apache-2.0
// The fuzz targets without a fuzzer, so that they run in every build: their seeds, cut short, and with
// random bytes changed, inserted or doubled. A failure aborts.
#include <gtest/gtest.h>

#include "reflectree/math/random.hpp"
#include "targets.hpp"

namespace reflectree::fuzz {
namespace {

Bytes mutated(Bytes bytes, Pcg32& bits) {
  const std::uint32_t changes = 1 + bits() % 4;
  for (std::uint32_t i = 0; i < changes && !bytes.empty(); ++i) {
    const auto at = std::ptrdiff_t(bits() % bytes.size());
    switch (bits() % 5) {
      case 0:
        bytes[std::size_t(at)] = std::uint8_t(bits());
        break;
      case 1:
        bytes[std::size_t(at)] ^= std::uint8_t(1U << (bits() % 8));
        break;
      case 2:
        bytes.insert(bytes.begin() + at, std::uint8_t(bits()));
        break;
      case 3:
        bytes.erase(bytes.begin() + at);
        break;
      default:
        bytes.resize(std::size_t(at));
    }
  }
  return bytes;
}

TEST(Fuzz, TargetsSurviveMutatedSeeds) {
  for (const Target& target : targets()) {
    Pcg32 bits(1, 7);
    const std::vector<Bytes> seeds = target.seeds();
    ASSERT_FALSE(seeds.empty());
    const int mutations = target.name == "merl" ? 8 : 1000;
    for (const Bytes& seed : seeds) {
      if (target.name != "merl") target.run(seed);
      for (int i = 0; i < mutations / int(seeds.size()); ++i) target.run(mutated(seed, bits));
    }
    target.run({});
  }
}

}  // namespace
}  // namespace reflectree::fuzz
