// SPDX-License-Identifier: Apache-2.0
// Values of an independent reading, by a script of this folder.
#pragma once

#include <cstdlib>
#include <stdexcept>

#include "measured_data.hpp"
#include "reflectree/formats/file.hpp"

namespace reflectree {

// Runs PYTHON -B SCRIPT BEFORE... PAIRS OUT AFTER...: PAIRS holds wo.xyz wi.xyz of every pair as 32-bit floats,
// and the script writes 64-bit floats to OUT.
inline std::vector<double> reference_values(const std::string& script, const std::vector<std::string>& before,
                                            const Pairs& pairs, const std::vector<std::string>& after = {},
                                            const std::string& python = "python3") {
  const TemporaryFolder folder("reference");
  Bytes raw;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    for (const Direction& w : {pairs.wo[i], pairs.wi[i]}) {
      for (const float v : {w.x, w.y, w.z}) append_f32(raw, v);
    }
  }
  write_file_atomically(folder / "pairs", raw);
  std::string command;
  const auto add = [&command](const std::string& word) { command += " \"" + word + "\""; };
  add(python), add("-B"), add(std::string(REFLECTREE_SOURCE) + "/" + script);
  for (const std::string& word : before) add(word);
  add(folder / "pairs"), add(folder / "out");
  for (const std::string& word : after) add(word);
  if (std::system(command.c_str()) != 0) throw std::runtime_error("the reference failed:" + command);
  const Bytes result = read_file(folder / "out", 1U << 28U);
  ByteReader reader(result, "out");
  std::vector<double> values(result.size() / 8);
  for (double& v : values) v = reader.f64();
  return values;
}

}  // namespace reflectree
