// SPDX-License-Identifier: Apache-2.0
#include "format_facts.hpp"

#include <algorithm>

#include "probe_pairs.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/model_tables.hpp"
#include "reflectree/formats/rgl.hpp"

namespace reflectree {
namespace {

template <class F>
void probe_sign(MeasuredFacts& facts, const F& f) {
  probe_pairs(facts, [&f](const ShadingGeometry<float>& g, int c) {
    return channel_value(f.unclipped(g), c) < 0 ? PairVerdict::clipped : PairVerdict::sound;
  });
}

}  // namespace

TableLookup merl_lookup(const std::string& path, const std::string& member) {
  if (member.empty() || member == "nearest") return TableLookup::nearest;
  if (member == "linear") return TableLookup::linear;
  throw Error("no member '" + member + "'", path, "its look-ups are #nearest and #linear");
}

MeasuredFacts rgl_facts(ByteView bytes, const std::string& path, const std::string&) {
  const RglFields fields = read_rgl_fields(bytes, path);
  const auto is_negative = [](float v) { return v < 0; };
  MeasuredFacts facts;
  facts.kind = "RGL tensor_file";
  facts.entries = fields.ndf.size() + fields.rgb.size();
  facts.negative = std::uint64_t(std::count_if(fields.ndf.begin(), fields.ndf.end(), is_negative));
  facts.theta_o = fields.theta_o;
  const auto slice = std::ptrdiff_t(fields.rgb.size() / fields.theta_o.size());
  for (auto first = fields.rgb.begin(); first != fields.rgb.end(); first += slice) {
    facts.negative_at.push_back(std::uint64_t(std::count_if(first, first + slice, is_negative)));
    facts.negative += facts.negative_at.back();
  }
  probe_sign(facts, RglTable(fields));
  return facts;
}

MeasuredFacts merl_facts(ByteView bytes, const std::string& path, const std::string& member) {
  const TableLookup lookup = merl_lookup(path, member);
  const HalfAngleTable table = read_merl(bytes, path, lookup);
  MeasuredFacts facts;
  facts.kind = lookup == TableLookup::linear ? "MERL table, linear" : "MERL table, nearest";
  facts.entries = table.rgb.size();
  facts.not_measured =
      std::uint64_t(std::count_if(table.rgb.begin(), table.rgb.end(), [](float v) { return v < 0; }));
  probe_pairs(facts, [&table](const ShadingGeometry<float>& g, int c) {
    const float share = channel_value(table.unmeasured(g), c);
    return share <= 0 ? PairVerdict::sound : share >= 1 ? PairVerdict::dark : PairVerdict::bridged;
  });
  return facts;
}

MeasuredFacts table_facts(ByteView bytes, const std::string& path, const std::string& member) {
  const ParameterTable table = read_parameter_table(bytes, path);
  const ParameterTable::Row& row = table.row(member);
  MeasuredFacts facts;
  switch (model_of(table)) {
    case TableModel::neural:
      facts.kind = "NBRDF network";
      probe_sign(facts, make_neural(table, row, row.material));
      break;
    case TableModel::sgd:
      facts.kind = "SGD fit";
      probe_sign(facts, make_sgd(table, row, row.material));
      break;
    case TableModel::abc:  // every term is positive
      make_abc(table, row, row.material);
      facts.kind = "ABC fit";
      break;
  }
  return facts;
}

}  // namespace reflectree
