// SPDX-License-Identifier: Apache-2.0
// A folder of the test program's own, which is gone when it ends: two users, or two runs at once, do not
// meet in it.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace reflectree {

// The path of `name` in the folder.
inline std::string scratch(const std::string& name) {
  static const struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("reflectree_test_" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
  } folder;
  return (folder.path / name).string();
}

}  // namespace reflectree
