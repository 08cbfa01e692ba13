// SPDX-License-Identifier: Apache-2.0
// Text files line by line and word by word, with the numbers of lines for errors.
#pragma once

#include <algorithm>
#include <string_view>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

inline constexpr std::string_view blanks = " \t\r\f\v";

// Lines that are not empty and do not start with '#', without blanks at either end; a byte order mark before
// the first is passed over.
class TextLines {
 public:
  explicit TextLines(ByteView bytes) : rest_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {
    if (rest_.rfind("\xef\xbb\xbf", 0) == 0) rest_.remove_prefix(3);
  }

  // The next line; false, and an empty one, where there is none.
  bool next(std::string_view& line) {
    while (!rest_.empty()) {
      const std::size_t length = std::min(rest_.find('\n'), rest_.size());
      line = rest_.substr(0, length);
      rest_.remove_prefix(std::min(length + 1, rest_.size()));
      ++number_;
      line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
      line = line.substr(0, line.find_last_not_of(blanks) + 1);
      if (!line.empty() && line[0] != '#') return true;
    }
    line = {};
    return false;
  }
  // Of the line that was returned last, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

// Takes the first word off a line that is trimmed; empty where there is none.
inline std::string_view take_word(std::string_view& line) {
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  return word;
}

}  // namespace reflectree
