// SPDX-License-Identifier: Apache-2.0
// Where the files lie that a text names.
#pragma once

#include <functional>
#include <string>

namespace reflectree {

// Where the files of a text are looked for: as named; beside the file `beside`; in the folder `data`. What is
// found elsewhere keeps its name in texts and errors.
struct FilePlaces {
  std::string data;    // empty: none
  std::string beside;  // a file, such as the sampler whose material is meant; empty: none
  // Told of a file that was found under another path than its own.
  std::function<void(const std::string& path, const std::string& found)> elsewhere = nullptr;

  // The path itself where the file is nowhere.
  std::string find(const std::string& path) const;
  FilePlaces with_neighbours_of(const std::string& file) const;
};

}  // namespace reflectree
