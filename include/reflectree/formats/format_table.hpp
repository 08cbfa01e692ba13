// SPDX-License-Identifier: Apache-2.0
// The one table of the formats of material files: loading, listings, folders, help, error texts and fuzzers
// read it. A new format is a reader and a row in format_table.cpp.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/formats/measured_facts.hpp"

namespace reflectree {

// What may follow `#` in FILE#MEMBER.
enum class FileMembers : std::uint8_t {
  none,       // the file is one material
  ways,       // one material, read in one of several ways; the first is the default
  materials,  // a material each
};

struct MaterialFormat {
  std::string_view key;      // a word, for tests and fuzzers
  std::string_view name;     // as one asks for it: "a MERL .binary"
  std::string_view kind;     // as one calls it where something else was wanted
  std::string_view example;  // how a file is named in a material: "gold.binary"
  std::string_view ending;   // of most files; what a file is, its content alone tells
  std::uint64_t max_bytes;
  FileMembers members;
  bool (*recognised)(ByteView bytes);
  // The BRDF of a member ("": the default one), its name file_text(path, member). Throws Error in one line;
  // `path` names the bytes in it.
  AnyBrdf (*read)(ByteView bytes, const std::string& path, const std::string& member);
  // Of a file that has members, in order; nullptr: none.
  std::vector<std::string> (*list_members)(ByteView bytes, const std::string& path) = nullptr;
  // What is doubtful in the file; nullptr: nothing is known.
  MeasuredFacts (*facts)(ByteView bytes, const std::string& path, const std::string& member) = nullptr;
};

std::span<const MaterialFormat> material_formats();

// By the content; nullptr: none of the table.
const MaterialFormat* find_format(ByteView bytes);
// The same, or Error, which names what the file is instead.
const MaterialFormat& format_of(ByteView bytes, const std::string& path);

// Of the largest file of any format.
std::uint64_t max_material_bytes();

// "an RGL tensor_file, a MERL .binary, or ..."
std::string format_names();
// Endings of the formats whose files are one material each: ".bsdf", ".binary", ...
std::vector<std::string_view> material_endings();

}  // namespace reflectree
