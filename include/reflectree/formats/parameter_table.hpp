// SPDX-License-Identifier: Apache-2.0
// CSV tables of model parameters: a header `material,NAME,NAME,...`, then one material per line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

struct ParameterTable {
  std::string where;                 // names the file in errors
  std::vector<std::string> columns;  // without the first, `material`
  struct Row {
    std::string material;
    std::vector<double> values;  // one per column, finite
  };
  std::vector<Row> rows;

  // The column's index, or -1.
  int column(std::string_view name) const;
  // The row of that material; an unnamed one only where the table holds a single row. Throws Error that
  // lists the nearest names.
  const Row& row(std::string_view material) const;
};

inline constexpr std::uint64_t max_parameter_table_bytes = std::uint64_t(16) << 20U;

// Whether the bytes begin like such a table.
bool is_parameter_table(ByteView bytes);

// Throws Error with the line of what it cannot read.
ParameterTable read_parameter_table(ByteView bytes, const std::string& where);

}  // namespace reflectree
