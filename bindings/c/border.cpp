// SPDX-License-Identifier: Apache-2.0
#include "border.hpp"

#include <cstdint>
#include <cstdio>
#include <new>

namespace reflectree::c {

namespace {

// In place: keeping a sentence never fails.
thread_local char sentence[1024] = "";

reflectree_status keep(reflectree_status status, const char* text) noexcept {
  int end = std::snprintf(sentence, sizeof sentence, "%s", text);
  if (end < 0) sentence[0] = 0;
  if (end >= int(sizeof sentence)) {  // cut before a character of several bytes, not inside
    end = int(sizeof sentence) - 1;
    while (end > 0 && (std::uint8_t(text[end]) & 0xc0U) == 0x80U) --end;
    sentence[end] = 0;
  }
  return status;
}

}  // namespace

reflectree_status status_of_exception() noexcept {
  try {
    throw;
  } catch (const ArgumentError& error) {
    return keep(REFLECTREE_ERROR_ARGUMENT, error.what());
  } catch (const CallbackError& error) {
    return keep(REFLECTREE_ERROR_CALLBACK, error.what());
  } catch (const Error& error) {
    return keep(REFLECTREE_ERROR_REFUSED, error.what());
  } catch (const Cancelled&) {
    return keep(REFLECTREE_CANCELLED, "reflectree_build: cancelled by `progress`; nothing was built");
  } catch (const std::bad_alloc&) {
    return keep(REFLECTREE_ERROR_MEMORY, "memory: not enough; free some, or ask for less at once");
  } catch (const std::exception& error) {
    char text[900];
    std::snprintf(text, sizeof text, "internal fault: %.800s; please report it with the call", error.what());
    return keep(REFLECTREE_ERROR_INTERNAL, text);
  } catch (...) {
    return keep(REFLECTREE_ERROR_INTERNAL,
                "a callback threw something that is no std::exception; catch it there and return an error");
  }
}

void refuse(const char* where, const std::string& what, const char* how) {
  throw ArgumentError(what, where, how);
}

void check_count(std::size_t n, std::size_t each, const char* where) {
  if (n > std::size_t(PTRDIFF_MAX) / sizeof(double) / each) {
    refuse(where, "n is " + std::to_string(n) + ", more than fits into memory",
           "pass the number of directions");
  }
}

}  // namespace reflectree::c

extern "C" {

const char* reflectree_last_error(void) { return reflectree::c::sentence; }

const char* reflectree_status_name(reflectree_status status) {
  switch (status) {
    case REFLECTREE_OK:
      return "ok";
    case REFLECTREE_ERROR_ARGUMENT:
      return "argument";
    case REFLECTREE_ERROR_REFUSED:
      return "refused";
    case REFLECTREE_ERROR_CALLBACK:
      return "callback";
    case REFLECTREE_CANCELLED:
      return "cancelled";
    case REFLECTREE_ERROR_MEMORY:
      return "memory";
    case REFLECTREE_ERROR_INTERNAL:
      return "internal";
  }
  return "unknown";
}

uint32_t reflectree_interface_version(void) { return REFLECTREE_INTERFACE_VERSION; }
const char* reflectree_version(void) { return REFLECTREE_VERSION; }
}
