// SPDX-License-Identifier: Apache-2.0
#include "cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"

namespace reflectree::pictures {

namespace {

constexpr std::uint64_t largest_file = 64U << 20U;

std::string written(const Shot& s) {
  char line[160];
  std::snprintf(line, sizeof line, "\t%d\t%.9g\t%.9g\t%.9g", s.samples, s.seconds, s.error.all,
                s.error.trimmed);
  return line;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, '\t');) fields.push_back(field);
  return fields;
}

double number_of(const std::string& text) {
  std::size_t used = 0;
  const double x = std::stod(text, &used);
  if (used != text.size() || !std::isfinite(x)) throw std::invalid_argument(text);
  return x;
}

Shot shot_of(const std::vector<std::string>& f, std::size_t at) {
  return {int(number_of(f[at])), number_of(f[at + 1]), {number_of(f[at + 2]), number_of(f[at + 3])}};
}

}  // namespace

std::vector<const PictureCell*> Results::of(std::string_view scene, std::string_view method,
                                            std::string_view sampler) const {
  std::vector<const PictureCell*> found;
  for (const PictureCell& c : cells) {
    if (c.scene == scene && c.method == method && c.sampler == sampler) found.push_back(&c);
  }
  std::sort(found.begin(), found.end(),
            [](const PictureCell* a, const PictureCell* b) { return a->round < b->round; });
  return found;
}

// Fields between tabulators: the key, then a cell per line.
void keep(const std::string& path, const Results& results) {
  std::string text = results.key + "\n";
  for (const PictureCell& c : results.cells) {
    text += c.scene + "\t" + c.method + "\t" + c.sampler + "\t" + std::to_string(c.round) + written(c.equal) +
            written(c.timed) + "\n";
  }
  write_file_atomically(path, text);
}

Results kept(const std::string& path, const std::string& key) {
  const Bytes bytes = read_file(path, largest_file);
  std::istringstream in(std::string(bytes.begin(), bytes.end()));
  Results results{key, {}, {}};
  std::string line;
  std::getline(in, line);
  if (line != key)
    throw Error("its cells were measured otherwise (" + line + ")", path, "repeat the options, or remove it");
  while (std::getline(in, line)) {
    const auto f = fields_of(line);
    try {
      if (f.size() != 12) throw std::invalid_argument(line);
      results.cells.push_back({f[0], f[1], f[2], int(number_of(f[3])), shot_of(f, 4), shot_of(f, 8)});
    } catch (const std::logic_error&) {
      throw Error("this is no cell: " + line, path, "remove the file to measure again");
    }
  }
  return results;
}

}  // namespace reflectree::pictures
