// SPDX-License-Identifier: Apache-2.0
// Columns of text, aligned; widths count characters, not bytes.
#pragma once

#include <string>
#include <vector>

namespace reflectree::cli {

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
// The first column is left-aligned, the others right-aligned.
std::string to_text(const Table& table);

}  // namespace reflectree::cli
