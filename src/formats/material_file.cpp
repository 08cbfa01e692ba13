// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/material_file.hpp"

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"

namespace reflectree {
namespace {

// The format of a file that may have that member.
const MaterialFormat& checked_format(ByteView bytes, const std::string& path, const std::string& member) {
  const MaterialFormat& format = format_of(bytes, path);
  if (bytes.size() > format.max_bytes) {
    throw Error("larger than " + std::to_string(format.max_bytes) + " bytes", path,
                "check that this is the file you meant");
  }
  if (format.members == FileMembers::none && !member.empty()) {
    throw Error("no member '" + member + "': the file is one material", path, "leave out #" + member);
  }
  return format;
}

}  // namespace

AnyBrdf read_brdf(ByteView bytes, const std::string& path, const std::string& member) {
  return checked_format(bytes, path, member).read(bytes, path, member);
}

AnyBrdf load_brdf(const std::string& path, const std::string& member) {
  return read_brdf(read_file(path, max_material_bytes()), path, member);
}

std::vector<std::string> list_members(const std::string& path) {
  const Bytes bytes = read_file(path, max_material_bytes());
  const MaterialFormat& format = checked_format(bytes, path, "");
  return format.list_members ? format.list_members(bytes, path) : std::vector<std::string>{};
}

std::optional<MeasuredFacts> measured_facts(ByteView bytes, const std::string& path,
                                            const std::string& member) {
  const MaterialFormat& format = checked_format(bytes, path, member);
  return format.facts ? std::optional(format.facts(bytes, path, member)) : std::nullopt;
}

}  // namespace reflectree
