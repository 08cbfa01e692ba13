// SPDX-License-Identifier: Apache-2.0
// Names files that stand in the place of another, as a clone, a download or a slip of the hand leaves them.
// Formats of materials are known from their table, other files by what they begin with. Every reader asks here
// before it says "not what I read".
#pragma once

#include <string>
#include <string_view>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// what: the kind in words, such as "a Git LFS pointer"; empty where it is not known. how: how to mend it;
// empty where that depends on what is wanted. may_be_scene: XML that is not known to be something else.
struct FileKind {
  std::string_view what, how;
  bool may_be_scene = false;
};

// Told by the content alone; the first 64 KiB are looked at.
FileKind recognise_file(ByteView bytes);

// Throws Error that names the kind of the bytes, where it is known; `how` mends what has no mending of its
// own, such as "name a mesh".
void refuse_recognised(ByteView bytes, const std::string& where, const std::string& how);

}  // namespace reflectree
