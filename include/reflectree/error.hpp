// SPDX-License-Identifier: Apache-2.0
// The one exception type of building, loading and the command line. Sampling never throws.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>

namespace reflectree {

// what: what is wrong; where: file, argument or direction; how: how to mend it. Always one line: control
// characters, which damaged files and arguments may bring along, show as '?'.
class Error : public std::runtime_error {
 public:
  Error(const std::string& what, const std::string& where, const std::string& how)
      : std::runtime_error(one_line(where + ": " + what + "; " + how)),
        parts_(std::make_shared<const std::array<std::string, 3>>(
            std::array{one_line(what), one_line(where), one_line(how)})) {}

  // For faces that show the three apart.
  const std::string& wrong() const { return (*parts_)[0]; }
  const std::string& where() const { return (*parts_)[1]; }
  const std::string& how() const { return (*parts_)[2]; }

 private:
  std::shared_ptr<const std::array<std::string, 3>> parts_;  // copies of exceptions must not throw

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
