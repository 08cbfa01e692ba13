// SPDX-License-Identifier: Apache-2.0
#include "rows.hpp"

#include "reflectree/formats/file.hpp"
#include "reflectree/formats/npy.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree::cli {

namespace {

std::string csv(const Rows& rows) {
  std::string text;
  for (const std::string& name : rows.columns) text += (text.empty() ? "" : ",") + name;
  text += '\n';
  for (std::size_t i = 0; i < rows.values.size(); ++i) {
    text += shortest_text(rows.values[i]);
    text += (i + 1) % rows.columns.size() ? ',' : '\n';
  }
  return text;
}

Json json_rows(const Rows& rows) {
  Json all = Json::array();
  for (std::size_t i = 0; i < rows.values.size(); i += rows.columns.size()) {
    Json row = Json::array();
    for (std::size_t k = 0; k < rows.columns.size(); ++k) row.push_back(shortest(rows.values[i + k]));
    all.push_back(std::move(row));
  }
  return all;
}

}  // namespace

std::string channel_name(const std::string& stem, int c, int channels) {
  return stem + "_" + (channels == 3 ? std::string(1, "rgb"[c]) : std::to_string(c));
}

void put_out(const Context& context, const std::string& command, Json json, const Rows& rows,
             const std::string& file) {
  if (file.ends_with(".npy")) {
    const std::size_t shape[] = {rows.count(), rows.columns.size()};
    const std::vector<double> wide(rows.values.begin(), rows.values.end());
    write_file_atomically(file, rows.doubles ? encode_npy(wide, shape) : encode_npy(rows.values, shape));
  } else if (!file.empty()) {
    write_file_atomically(file, csv(rows));
  } else if (!context.json) {
    context.print(csv(rows));
  }
  if (!context.json) return;
  json["columns"] = rows.columns;
  if (file.empty()) {
    json["rows"] = json_rows(rows);
  } else {
    json["output"] = file;
  }
  context.print_json(command, json);
}

}  // namespace reflectree::cli
