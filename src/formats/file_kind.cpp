// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/file_kind.hpp"

#include <algorithm>

#include "reflectree/error.hpp"
#include "reflectree/formats/format_table.hpp"

namespace reflectree {
namespace {

constexpr std::size_t looked_at = std::size_t(64) << 10U;

struct Magic {
  std::string_view bytes;
  FileKind kind;
};
using namespace std::string_view_literals;
constexpr std::string_view unpack = "unpack it and name a file inside it";
// Longer ones before those with which they begin.
constexpr Magic magics[] = {
    {"PK\x03\x04"sv, {"a ZIP archive", unpack}},
    {"PK\x05\x06"sv, {"an empty ZIP archive", "fetch the file again"}},
    {"\x1f\x8b"sv, {"compressed by gzip", "unpack it with gunzip"}},
    {"BZh"sv, {"compressed by bzip2", "unpack it with bunzip2"}},
    {"\xfd\x37zXZ\0"sv, {"compressed by xz", "unpack it with unxz"}},
    {"\x28\xb5\x2f\xfd"sv, {"compressed by Zstandard", "unpack it with unzstd"}},
    {"7z\xbc\xaf\x27\x1c"sv, {"a 7-Zip archive", unpack}},
    {"Rar!"sv, {"a RAR archive", unpack}},
    {"\x89RFL\r\n\x1a\n"sv, {"a sampler file", ""}},
    {"\x89PNG"sv, {"a PNG picture", ""}},
    {"\xff\xd8\xff"sv, {"a JPEG picture", ""}},
    {"\x76\x2f\x31\x01"sv, {"an OpenEXR picture", ""}},
    {"#?RADIANCE"sv, {"a Radiance .hdr picture", ""}},
    {"#?RGBE"sv, {"a Radiance .hdr picture", ""}},
    {"GIF8"sv, {"a GIF picture", ""}},
    {"II*\0"sv, {"a TIFF picture", ""}},
    {"MM\0*"sv, {"a TIFF picture", ""}},
    {"DDS "sv, {"a DDS picture", ""}},
    {"ply\n"sv, {"a PLY mesh", ""}},
    {"ply\r\n"sv, {"a PLY mesh", ""}},
    {"glTF"sv, {"a glTF scene", ""}},
    {"\x93NUMPY"sv, {"a NumPy array", ""}},
    {"\x89HDF\r\n\x1a\n"sv, {"an HDF5 file", ""}},
    {"%PDF-"sv, {"a PDF document", ""}},
    {"\x7f"
     "ELF"sv,
     {"a program", ""}},
    {"\xff\xfe"sv, {"text in UTF-16", "save it as UTF-8"}},
    {"\xfe\xff"sv, {"text in UTF-16", "save it as UTF-8"}},
    {"OPTIS - "sv, {"a Speos surface file, a format that is not read", ""}},
};

constexpr std::string_view lfs = "version https://git-lfs.github.com/spec/";

// In lower case: HTML does not mind capitals.
std::string lowered(std::string_view text) {
  std::string out(text.substr(0, 1024));
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? char(c + ('a' - 'A')) : c;
  return out;
}

bool contains(std::string_view text, std::string_view word) { return text.find(word) != text.npos; }

FileKind markup(std::string_view text) {
  const std::string start = lowered(text);
  if (start.rfind("<!doctype html", 0) == 0 || start.rfind("<html", 0) == 0 ||
      (start.rfind("<", 0) == 0 && contains(start, "<html"))) {
    return {"an HTML page", "fetch the file itself: the address led to a page about it, or to an error"};
  }
  if (text.rfind("<?xml", 0) != 0 && text.rfind("<scene", 0) != 0 && text.rfind("<!--", 0) != 0) return {};
  return {contains(text, "<scene") ? "a scene in Mitsuba's XML" : "an XML file", "", true};
}

}  // namespace

FileKind recognise_file(ByteView bytes) {
  if (bytes.empty()) return {"empty", "fetch the file again"};
  if (const MaterialFormat* format = find_format(bytes)) return {format->kind, ""};
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), looked_at));
  for (const Magic& magic : magics) {
    if (all.rfind(magic.bytes, 0) == 0) return magic.kind;
  }
  if (std::all_of(all.begin(), all.end(), [](char c) { return c == 0; })) {
    return {"nothing but zeros", "fetch the file again"};
  }
  std::string_view text = all;
  if (text.rfind("\xef\xbb\xbf", 0) == 0) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.rfind(lfs, 0) == 0) return {"a Git LFS pointer", "fetch the file with git lfs pull"};
  return markup(text);
}

void refuse_recognised(ByteView bytes, const std::string& where, const std::string& how) {
  const FileKind kind = recognise_file(bytes);
  if (!kind.what.empty()) {
    throw Error(std::string(kind.what), where, kind.how.empty() ? how : std::string(kind.how));
  }
}

}  // namespace reflectree
