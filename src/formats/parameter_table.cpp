// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/parameter_table.hpp"

#include <algorithm>
#include <optional>

#include "reflectree/error.hpp"
#include "reflectree/text/edit_distance.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {
namespace {

constexpr std::string_view first_column = "material,";
constexpr std::size_t max_columns = 4096, max_name = 200, max_names_listed = 5;

[[noreturn]] void fail(const std::string& what, std::size_t line, const std::string& where) {
  throw Error("line " + std::to_string(line) + ": " + what, where, "mend the line or fetch the file again");
}

std::string_view take_until(std::string_view& text, char end) {
  const std::size_t n = std::min(text.find(end), text.size());
  const std::string_view taken = text.substr(0, n);
  text.remove_prefix(std::min(n + 1, text.size()));
  return taken;
}

// The first of two equal texts, or an empty one.
std::string repeated(std::vector<std::string> texts) {
  std::sort(texts.begin(), texts.end());
  const auto found = std::adjacent_find(texts.begin(), texts.end());
  return found == texts.end() ? "" : *found;
}

}  // namespace

int ParameterTable::column(std::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1 : int(found - columns.begin());
}

const ParameterTable::Row& ParameterTable::row(std::string_view material) const {
  if (material.empty() && rows.size() == 1) return rows.front();
  for (const Row& r : rows) {
    if (r.material == material) return r;
  }
  std::vector<std::string> names;
  for (const Row& r : rows) names.push_back(r.material);
  if (!material.empty()) {
    std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
      return edit_distance(material, a) < edit_distance(material, b);
    });
  }
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), max_names_listed); ++i) {
    list += (i == 0 ? "" : ", ") + names[i];
  }
  if (material.empty()) {
    throw Error("holds " + std::to_string(rows.size()) + " materials", where,
                "name one as FILE#MATERIAL, for example " + list);
  }
  throw Error("no material '" + std::string(material) + "'", where,
              "the nearest of " + std::to_string(rows.size()) + ": " + list);
}

bool is_parameter_table(ByteView bytes) { return starts_with(bytes, first_column); }

ParameterTable read_parameter_table(ByteView bytes, const std::string& where) {
  if (!is_parameter_table(bytes)) {
    throw Error("not a table of parameters", where, "its first line must read material,NAME,NAME,...");
  }
  if (bytes.size() > max_parameter_table_bytes) {
    throw Error("larger than " + std::to_string(max_parameter_table_bytes) + " bytes", where,
                "keep the materials you need");
  }
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  ParameterTable table;
  table.where = where;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    std::string_view line = take_until(rest, '\n');
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty()) continue;
    const std::string_view name = take_until(line, ',');
    if (name.empty() || name.size() > max_name) fail("no name", number, where);
    if (number == 1) {
      while (!line.empty()) {
        table.columns.emplace_back(take_until(line, ','));
        if (table.columns.back().size() > max_name) fail("a name too long", number, where);
        if (table.columns.size() > max_columns) fail("too many columns", number, where);
      }
      continue;
    }
    ParameterTable::Row row{std::string(name), {}};
    while (!line.empty()) {
      const std::string_view field = take_until(line, ',');
      const std::optional<double> value = parse_number(field);
      if (!value) fail("'" + std::string(field.substr(0, 30)) + "' is not a finite number", number, where);
      row.values.push_back(*value);
      if (row.values.size() > table.columns.size()) break;
    }
    if (row.values.size() != table.columns.size()) {
      fail("the header has " + std::to_string(table.columns.size()) + " numbers, this line another count",
           number, where);
    }
    table.rows.push_back(std::move(row));
  }
  if (table.rows.empty()) throw Error("no material", where, "fetch the file again");
  // Which of two is meant nobody can tell.
  std::vector<std::string> names;
  for (const ParameterTable::Row& row : table.rows) names.push_back(row.material);
  if (const std::string twice = repeated(std::move(names)); !twice.empty()) {
    throw Error("material '" + twice + "' stands in two lines", where, "keep one of them");
  }
  if (const std::string twice = repeated(table.columns); !twice.empty()) {
    throw Error("column '" + twice + "' stands twice", where, "keep one of them");
  }
  return table;
}

}  // namespace reflectree
