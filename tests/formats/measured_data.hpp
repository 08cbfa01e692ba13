// SPDX-License-Identifier: Apache-2.0
// Where the measured data is, and random pairs of directions.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {

// The folder named by REFLECTREE_DATA, or "".
inline std::string measured_data() {
  const char* folder = std::getenv("REFLECTREE_DATA");
  return folder ? folder : "";
}

inline Direction random_direction(Pcg32& bits) {
  const float z = 1 - to_unit_float(bits()), phi = 2 * pi * to_unit_float(bits()),
              r = sqrt(max(1 - z * z, 0.f));
  return {r * cos(phi), r * sin(phi), z};
}

struct Pairs {
  std::vector<Direction> wo, wi;
};
// Half of them independent, half within `spread` of the mirror direction.
inline Pairs random_pairs(int count, float spread, std::uint64_t seed) {
  Pcg32 bits(seed);
  Pairs pairs;
  while (int(pairs.wo.size()) < count) {
    const Direction wo = random_direction(bits);
    Direction wi = random_direction(bits);
    if (pairs.wo.size() % 2 == 0) {
      const float x = to_unit_float(bits()) - 0.5f, y = to_unit_float(bits()) - 0.5f;
      wi = reflect(wo, normalize(Direction{spread * x, spread * y, 1}));
    }
    if (wi.z <= 0 || wo.z <= 0) continue;
    pairs.wo.push_back(wo);
    pairs.wi.push_back(wi);
  }
  return pairs;
}

inline bool finite_and_not_negative(Rgb v) {
  for (const float c : {v.r, v.g, v.b}) {
    if (!(c >= 0 && std::isfinite(c))) return false;
  }
  return true;
}

// A folder of its own for a test's files, removed at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("reflectree_" + name + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& file) const { return (path_ / file).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace reflectree
