// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/file.hpp"

#include <filesystem>
#include <fstream>
#include <random>

#include "reflectree/error.hpp"

namespace reflectree {

namespace fs = std::filesystem;

Bytes read_file(const std::string& path, std::uint64_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw Error("no such file", path, "check the path");
  if (fs::is_directory(status)) throw Error("is a directory", path, "name a file inside it");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("cannot be read", path, "check its permissions");
  // Read in blocks rather than trust a size: pipes have none, and a file may grow meanwhile.
  Bytes bytes;
  constexpr std::size_t block = std::size_t(1) << 20U;
  while (in) {
    const std::size_t old = bytes.size();
    bytes.resize(old + block);
    in.read(reinterpret_cast<char*>(bytes.data() + old), std::streamsize(block));
    bytes.resize(old + std::size_t(in.gcount()));
    if (bytes.size() > max_bytes) {
      throw Error("larger than " + std::to_string(max_bytes) + " bytes", path,
                  "check that this is the file you meant");
    }
  }
  if (in.bad()) throw Error("reading failed", path, "check the disk");
  return bytes;
}

void write_file_atomically(const std::string& path, ByteView bytes) {
  const std::string temporary = path + ".tmp" + std::to_string(std::random_device{}());
  const auto fail = [&](const std::string& what) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error(what, path, "check that the folder exists, may be written to and has space left");
  };
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    if (!out) fail("cannot be written");
    out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    out.close();
    if (!out) fail("writing failed");
  }
  std::error_code error;
  fs::rename(temporary, path, error);
  if (error) fail("cannot be replaced (" + error.message() + ")");
}

void write_file_atomically(const std::string& path, std::string_view text) {
  write_file_atomically(path, ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

}  // namespace reflectree
