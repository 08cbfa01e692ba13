// SPDX-License-Identifier: Apache-2.0
// Lists in a sentence.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace reflectree {

// "a, b and c" where `last` is " and ".
inline std::string joined_words(std::span<const std::string_view> words, std::string_view last = ", ") {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace reflectree
