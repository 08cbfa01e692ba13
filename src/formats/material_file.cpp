// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/material_file.hpp"

#include <cmath>

#include "material_kind.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/model_tables.hpp"
#include "reflectree/formats/rgl.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t max_material_bytes = max_merl_bytes;
static_assert(max_rgl_bytes <= max_material_bytes && max_parameter_table_bytes <= max_material_bytes);

AnyBrdf read_table_member(ByteView bytes, const std::string& path, const std::string& member) {
  const ParameterTable table = read_parameter_table(bytes, path);
  const ParameterTable::Row& row = table.row(member);
  const std::string name = to_text(Material{{{1, "", {}, path, row.material}}});
  switch (model_of(table)) {
    case TableModel::neural:
      return make_neural(table, row, name);
    case TableModel::sgd:
      return make_sgd(table, row, name);
    case TableModel::abc:
      return make_abc(table, row, name);
  }
  throw Error("no model for its columns", path, "see the documentation for what is read");
}

}  // namespace

namespace detail {

MaterialKind material_kind(ByteView bytes, const std::string& path) {
  if (is_tensor_file(bytes)) return MaterialKind::rgl;
  if (is_merl_file(bytes)) return MaterialKind::merl;
  if (is_parameter_table(bytes)) return MaterialKind::table;
  const std::string how = "name an RGL tensor_file, a MERL .binary, or a CSV of NBRDF, SGD or ABC materials";
  refuse_recognised(bytes, path, how);
  throw Error("not a material", path, how);
}

void refuse_member(const std::string& path, const std::string& member) {
  if (member.empty()) return;
  throw Error("no member '" + member + "': the file is one material", path, "leave out #" + member);
}

TableLookup lookup_of(const std::string& path, const std::string& member) {
  if (member.empty() || member == "nearest") return TableLookup::nearest;
  if (member == "linear") return TableLookup::linear;
  throw Error("no member '" + member + "'", path, "its look-ups are #nearest and #linear");
}

}  // namespace detail

AnyBrdf read_brdf(ByteView bytes, const std::string& path, const std::string& member) {
  const std::string name = to_text(Material{{{1, "", {}, path, member}}});
  switch (detail::material_kind(bytes, path)) {
    case detail::MaterialKind::rgl: {
      detail::refuse_member(path, member);
      RglTable table = read_rgl(bytes, path);
      table.name = name;
      return table;
    }
    case detail::MaterialKind::merl: {
      HalfAngleTable table = read_merl(bytes, path, detail::lookup_of(path, member));
      table.name = name;
      return table;
    }
    case detail::MaterialKind::table:
      return read_table_member(bytes, path, member);
  }
  throw Error("not a material", path, "name a file of measured or fitted materials");
}

AnyBrdf load_brdf(const std::string& path, const std::string& member) {
  return read_brdf(read_file(path, max_material_bytes), path, member);
}

std::vector<std::string> list_members(const std::string& path) {
  const Bytes bytes = read_file(path, max_material_bytes);
  switch (detail::material_kind(bytes, path)) {
    case detail::MaterialKind::rgl:
      return {};
    case detail::MaterialKind::merl:
      return {"nearest", "linear"};
    case detail::MaterialKind::table:
      break;
  }
  std::vector<std::string> names;
  for (const ParameterTable::Row& row : read_parameter_table(bytes, path).rows) names.push_back(row.material);
  return names;
}

}  // namespace reflectree
