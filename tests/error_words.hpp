// SPDX-License-Identifier: Apache-2.0
// What an Error says, for tests of its words.
#pragma once

#include <string>

#include "reflectree/error.hpp"

namespace reflectree {

// The words of the Error that call() throws; `none` where it throws nothing.
template <class Call>
std::string error_words(const Call& call, const char* none = "no error") {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return none;
}

}  // namespace reflectree
