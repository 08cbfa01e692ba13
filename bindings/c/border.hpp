// SPDX-License-Identifier: Apache-2.0
// The border between C and the library: nothing is thrown across it. What goes wrong becomes a status and the
// sentence of the calling thread.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "reflectree.h"
#include "reflectree/error.hpp"

namespace reflectree::c {

// Misuse of the interface itself, and a callback that failed; everything else is the library's own.
struct ArgumentError : Error {
  using Error::Error;
};
struct CallbackError : Error {
  using Error::Error;
};

// The status of the exception that is being handled; its sentence is kept.
reflectree_status status_of_exception() noexcept;

// Runs body() and returns how it went.
template <class Body>
reflectree_status at_border(const Body& body) noexcept {
  try {
    body();
    return REFLECTREE_OK;
  } catch (...) {
    return status_of_exception();
  }
}

// Throws ArgumentError. where: the function that was called.
[[noreturn]] void refuse(const char* where, const std::string& what, const char* how);
template <class T>
T* needed(T* pointer, const char* where, const char* name) {
  if (!pointer) refuse(where, std::string(name) + " is null", "pass an address");
  return pointer;
}
// Null is allowed where there is nothing to read or write.
template <class T>
T* needed_for(std::size_t n, T* pointer, const char* where, const char* name) {
  return n == 0 ? pointer : needed(pointer, where, name);
}
// Throws ArgumentError where arrays of n items of `each` numbers cannot exist.
void check_count(std::size_t n, std::size_t each, const char* where);

}  // namespace reflectree::c
