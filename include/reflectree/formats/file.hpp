// SPDX-License-Identifier: Apache-2.0
// Whole files in and out. Errors name the file and say how to mend it.
#pragma once

#include <string>
#include <string_view>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// Throws Error for what is missing, unreadable, a directory, or larger than `max_bytes`.
Bytes read_file(const std::string& path, std::uint64_t max_bytes);

// Writes a temporary file beside `path`, then renames it: readers see the old file or the new one.
void write_file_atomically(const std::string& path, ByteView bytes);
void write_file_atomically(const std::string& path, std::string_view text);

}  // namespace reflectree
