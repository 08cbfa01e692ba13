// SPDX-License-Identifier: Apache-2.0
#include "context.hpp"

#include <unistd.h>

#include <cstdlib>

#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree::cli {

void Context::print(const std::string& text) const {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) finish_output();
}

void finish_output() {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return;
  throw Error("writing failed", "stdout", "check that the disk has space left");
}

void Context::print_json(const std::string& command, const Json& result) const {
  Json whole{{"schema_version", schema_version}, {"command", command}};
  whole.update(result);
  // A damaged name must not turn a result into an exception: bytes that are not UTF-8 are replaced.
  print(whole.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void Context::say(const std::string& line) const {
  if (quiet) return;
  std::fflush(stdout);  // a terminal shows both, in order
  fmt::print(stderr, "{}\n", line);
}

void Context::detail(const std::string& line) const {
  if (verbose) say(line);
}

FilePlaces Context::places() const {
  return {data, "", [this](const std::string& path, const std::string& found) {
            detail(path + ": found as " + found);
          }};
}

double shortest(float x) { return std::strtod(shortest_text(x).c_str(), nullptr); }

std::string coloured_verdicts(std::string text) {
  const char* no_color = std::getenv("NO_COLOR");
  if ((no_color && *no_color) || isatty(STDOUT_FILENO) != 1) return text;
  const auto paint = [&text](const std::string& word, const char* code) {
    const std::string painted = std::string(code) + word + "\x1b[0m";
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += painted.size()) {
      text.replace(at, word.size(), painted);
    }
  };
  paint("pass", "\x1b[32m");
  paint("FAIL", "\x1b[1;31m");
  return text;
}

}  // namespace reflectree::cli
