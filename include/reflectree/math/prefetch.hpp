// SPDX-License-Identifier: Apache-2.0
// Asks for a cache line that is soon to be read. Tables larger than the cache are looked up for many at once,
// stage by stage, so that the waits for memory overlap instead of adding up.
#pragma once

namespace reflectree {

inline void prefetch([[maybe_unused]] const void* at) {
#if defined(__GNUC__)
  __builtin_prefetch(at);
#endif
}

}  // namespace reflectree
