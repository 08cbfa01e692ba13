// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/file_places.hpp"

#include <filesystem>

namespace reflectree {

namespace fs = std::filesystem;

std::string FilePlaces::find(const std::string& path) const {
  std::error_code ignored;
  if (fs::exists(path, ignored) || !fs::path(path).is_relative()) return path;
  for (const fs::path& folder : {fs::path(beside).parent_path(), fs::path(data)}) {
    if (folder.empty()) continue;
    const fs::path other = folder / path;
    if (fs::exists(other, ignored)) return other.string();
  }
  return path;
}

FilePlaces FilePlaces::with_neighbours_of(const std::string& file) const {
  FilePlaces places = *this;
  places.beside = file;
  return places;
}

}  // namespace reflectree
