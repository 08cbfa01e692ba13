// SPDX-License-Identifier: Apache-2.0
// What a target may do with its bytes: go on, or end in an Error of one line.
#pragma once

#include <cstdlib>
#include <string_view>

#include "reflectree/error.hpp"

namespace reflectree::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

template <class Run>
void expect_error_or_success(Run run) {
  try {
    run();
  } catch (const Error& e) {
    require(std::string_view(e.what()).find('\n') == std::string_view::npos);
  }
}

}  // namespace reflectree::fuzz
