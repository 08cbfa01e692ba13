// SPDX-License-Identifier: Apache-2.0
// Writes each target's seeds into FOLDER/<target>/.
#include <cstdio>
#include <filesystem>
#include <string>

#include "reflectree/formats/file.hpp"
#include "targets.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_corpus FOLDER\n");
    return 2;
  }
  for (const auto& target : reflectree::fuzz::targets()) {
    const auto folder = std::filesystem::path(argv[1]) / target.name;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const auto& seed : target.seeds()) {
      reflectree::write_file_atomically((folder / ("seed_" + std::to_string(number++))).string(), seed);
    }
  }
  return 0;
}
