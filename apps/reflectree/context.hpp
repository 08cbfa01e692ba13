// SPDX-License-Identifier: Apache-2.0
// What every subcommand shares: the global options, words on stderr, results on stdout, the host.
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "reflectree/formats/file_places.hpp"
#include "reflectree/host.hpp"

namespace reflectree::cli {

enum ExitCode : int {
  exit_success = 0,
  exit_check_failed = 1,
  exit_bad_input = 2,
  exit_internal = 3,
  exit_interrupted = 130
};

// Keys of results keep the order in which they are written.
using Json = nlohmann::ordered_json;
inline constexpr int schema_version = 1;

struct Context {
  bool json = false, quiet = false, verbose = false;
  std::uint64_t seed = 1;
  int threads = 0;   // 0: as many as there are cores
  std::string data;  // folder of measured data; empty: none

  // Results: text on stdout as it is; JSON with `schema_version` and `command` in front.
  void print(const std::string& text) const;
  void print_json(const std::string& command, const Json& result) const;
  // Words: a line on stderr, silenced by -q; details only with -v.
  void say(const std::string& line) const;
  void detail(const std::string& line) const;

  // Where files are looked for; -v tells where they were found.
  FilePlaces places() const;
  // Where a file or folder is: as named, or in the folder of measured data. The name itself
  // where it is nowhere.
  std::string locate(const std::string& path) const { return places().find(path); }

  // The program's threads, progress shown under `label`, and Ctrl-C.
  Host host(const std::string& label) const;
};

// Throws Error if stdout could not take all that was printed.
void finish_output();

// The double that prints with as few digits as the float needs.
double shortest(float x);

// "pass" and "FAIL" in colour on a terminal, unless NO_COLOR is set.
std::string coloured_verdicts(std::string text);

}  // namespace reflectree::cli
