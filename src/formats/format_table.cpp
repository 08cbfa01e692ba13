// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/format_table.hpp"

#include <algorithm>

#include "format_facts.hpp"
#include "klems.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/models/enclosed_fits.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/model_tables.hpp"
#include "reflectree/formats/rgl.hpp"
#include "reflectree/text/joined_words.hpp"
#include "zemax.hpp"

namespace reflectree {

// A reader that nobody else calls needs no header: its functions are declared here.

namespace {

std::vector<std::string> rgl_members(ByteView bytes, const std::string& path) {
  if (rgl_layout(bytes, path).wavelengths.empty()) return {};
  return {"spectrum", "rgb"};
}

AnyBrdf read_rgl_material(ByteView bytes, const std::string& path, const std::string& member) {
  const bool as_rgb = rgl_as_rgb(bytes, path, member);
  if (rgl_layout(bytes, path).is_isotropic_rgb()) {
    RglTable table = read_rgl(bytes, path);
    table.name = file_text(path, "");
    return table;
  }
  RglWideTable table(read_rgl_wide_fields(bytes, path, as_rgb));
  table.name = file_text(path, member);
  return table;
}

std::vector<std::string> merl_lookups(ByteView, const std::string&) { return {"nearest", "linear"}; }

AnyBrdf read_merl_material(ByteView bytes, const std::string& path, const std::string& member) {
  HalfAngleTable table = read_merl(bytes, path, merl_lookup(path, member));
  table.name = file_text(path, member);
  return enclosed(std::move(table));
}

std::vector<std::string> table_rows(ByteView bytes, const std::string& path) {
  const ParameterTable table = read_parameter_table(bytes, path);
  model_of(table);  // none is listed that cannot be read
  std::vector<std::string> names;
  for (const ParameterTable::Row& row : table.rows) names.push_back(row.material);
  return names;
}

AnyBrdf read_table_row(ByteView bytes, const std::string& path, const std::string& member) {
  const ParameterTable table = read_parameter_table(bytes, path);
  const ParameterTable::Row& row = table.row(member);
  const std::string name = file_text(path, row.material);
  switch (model_of(table)) {
    case TableModel::neural:
      return make_neural(table, row, name);
    case TableModel::sgd:
      return Enclosed<Sgd>(make_sgd(table, row, name));
    case TableModel::abc:
      return Enclosed<AbcMicrofacet>(make_abc(table, row, name));
  }
  throw Error("no model for its columns", path, "see the documentation for what is read");
}

// clang-format off
constexpr MaterialFormat formats[] = {
    {.key = "rgl",
     .name = "an RGL tensor_file",
     .kind = "a measured material (RGL tensor_file)",
     .example = "paper_white.bsdf",
     .ending = ".bsdf",
     .max_bytes = max_rgl_bytes,
     .members = FileMembers::ways,
     .recognised = is_tensor_file,
     .read = read_rgl_material,
     .list_members = rgl_members,
     .facts = rgl_facts},
    {.key = "merl",
     .name = "a MERL .binary",
     .kind = "a measured material (MERL .binary)",
     .example = "gold.binary",
     .ending = ".binary",
     .max_bytes = max_merl_bytes,
     .members = FileMembers::ways,
     .recognised = is_merl_file,
     .read = read_merl_material,
     .list_members = merl_lookups,
     .facts = merl_facts},
    {.key = "zemax",
     .name = "a Zemax .bsdf",
     .kind = "a measured material (Zemax .bsdf)",
     .example = "paint.bsdf",
     .ending = ".bsdf",
     .max_bytes = max_zemax_bytes,
     .members = FileMembers::ways,
     .recognised = is_zemax_file,
     .read = read_zemax,
     .list_members = zemax_members,
     .facts = zemax_facts},
    {.key = "klems",
     .name = "a WINDOW/Radiance BSDF XML",
     .kind = "a measured material (WINDOW/Radiance BSDF XML)",
     .example = "blinds.xml",
     .ending = ".xml",
     .max_bytes = max_klems_bytes,
     .members = FileMembers::ways,
     .recognised = is_window_xml,
     .read = read_klems,
     .list_members = klems_members,
     .facts = klems_facts},
    {.key = "table",
     .name = "a CSV of NBRDF, SGD or ABC materials",
     .kind = "a table of materials (CSV)",
     .example = "table.csv#name",
     .ending = ".csv",
     .max_bytes = max_parameter_table_bytes,
     .members = FileMembers::materials,
     .recognised = is_parameter_table,
     .read = read_table_row,
     .list_members = table_rows,
     .facts = table_facts},
};
// clang-format on

}  // namespace

std::span<const MaterialFormat> material_formats() { return formats; }

const MaterialFormat* find_format(ByteView bytes) {
  for (const MaterialFormat& format : formats) {
    if (format.recognised(bytes)) return &format;
  }
  return nullptr;
}

const MaterialFormat& format_of(ByteView bytes, const std::string& path) {
  if (const MaterialFormat* format = find_format(bytes)) return *format;
  const std::string how = "name " + format_names();
  refuse_recognised(bytes, path, how);
  throw Error("not a material", path, how);
}

std::uint64_t max_material_bytes() {
  std::uint64_t largest = 0;
  for (const MaterialFormat& format : formats) largest = std::max(largest, format.max_bytes);
  return largest;
}

std::string format_names() {
  std::vector<std::string_view> names;
  for (const MaterialFormat& format : formats) names.push_back(format.name);
  return joined_words(names, ", or ");
}

std::vector<std::string_view> material_endings() {
  std::vector<std::string_view> endings;
  for (const MaterialFormat& format : formats) {
    const bool new_one = std::find(endings.begin(), endings.end(), format.ending) == endings.end();
    if (format.members != FileMembers::materials && new_one) endings.push_back(format.ending);
  }
  return endings;
}

}  // namespace reflectree
