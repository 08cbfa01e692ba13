// SPDX-License-Identifier: Apache-2.0
// The one exception type of building, loading and the command line. Sampling never throws.
#pragma once

#include <stdexcept>
#include <string>

namespace reflectree {

// what: what is wrong; where: file, argument or direction; how: how to mend it. Always one line: control
// characters, which damaged files and arguments may bring along, show as '?'.
class Error : public std::runtime_error {
 public:
  Error(const std::string& what, const std::string& where, const std::string& how)
      : std::runtime_error(one_line(where + ": " + what + "; " + how)) {}

 private:
  static std::string one_line(std::string text) {
    for (char& c : text) {
      if ((c >= 0 && c < ' ') || c == 127) c = '?';
    }
    return text;
  }
};

// Thrown out of long work after `Host::cancelled` returned true.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace reflectree
