// SPDX-License-Identifier: Apache-2.0
// One door for all files of measured or fitted materials: the formats of format_table.hpp. The format is told
// by the content, never by the file's name.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// The BRDF of a file's member ("" where the file is one BRDF); its name is the canonical material text.
// Throws Error in one line for whatever cannot be read.
AnyBrdf load_brdf(const std::string& path, const std::string& member = "");

// The same for bytes in memory; `path` names them in errors.
AnyBrdf read_brdf(ByteView bytes, const std::string& path, const std::string& member = "");

// What may follow `#`; empty for a file without members.
std::vector<std::string> list_members(const std::string& path);

}  // namespace reflectree
