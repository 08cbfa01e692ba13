// SPDX-License-Identifier: Apache-2.0
// A table of floats as subcommands print and save it.
#pragma once

#include <string>
#include <vector>

#include "context.hpp"

namespace reflectree::cli {

struct Rows {
  std::vector<std::string> columns;
  std::vector<float> values;  // row after row
  bool doubles = false;       // in .npy: float64 in place of float32
  std::size_t count() const { return values.size() / columns.size(); }
};

// "r", "g", "b" of three channels, else their numbers, behind a stem: "f_r", "weight_0".
std::string channel_name(const std::string& stem, int c, int channels);

// CSV, or .npy where the name of the file ends so; to stdout where there is no file. With --json the
// rows stand in `json`, or the name of the file; it is printed for `command`.
void put_out(const Context& context, const std::string& command, Json json, const Rows& rows,
             const std::string& file);

}  // namespace reflectree::cli
