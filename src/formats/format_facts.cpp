// SPDX-License-Identifier: Apache-2.0
#include "format_facts.hpp"

#include <algorithm>
#include <cstdio>

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

bool rgl_as_rgb(ByteView bytes, const std::string& path, const std::string& member) {
  if (member.empty()) return false;
  if (rgl_layout(bytes, path).wavelengths.empty()) {
    throw Error("no member '" + member + "': the file is one material", path, "leave out #" + member);
  }
  if (member != "spectrum" && member != "rgb") {
    throw Error("no member '" + member + "'", path, "its members are #spectrum and #rgb");
  }
  return member == "rgb";
}

namespace {

// Negative entries of colours, for each theta_o, the slices of all azimuths together.
void count_negative(MeasuredFacts& facts, const std::vector<float>& ndf, const std::vector<float>& colours,
                    std::size_t azimuths) {
  const auto is_negative = [](float v) { return v < 0; };
  const std::size_t elevations = facts.theta_o.size(), slice = colours.size() / (elevations * azimuths);
  facts.entries = ndf.size() + colours.size();
  facts.negative = std::uint64_t(std::count_if(ndf.begin(), ndf.end(), is_negative));
  facts.negative_at.assign(elevations, 0);
  for (std::size_t i = 0; i < azimuths * elevations; ++i) {
    const auto first = colours.begin() + std::ptrdiff_t(i * slice);
    const auto count = std::uint64_t(std::count_if(first, first + std::ptrdiff_t(slice), is_negative));
    facts.negative_at[i % elevations] += count, facts.negative += count;
  }
}

// Of a file with more azimuths or other channels.
MeasuredFacts wide_rgl_facts(const RglWideFields& fields, const RglLayout& layout) {
  MeasuredFacts facts;
  facts.kind = "RGL tensor_file";
  if (layout.azimuths > 2) {
    facts.kind += " of " + std::to_string(layout.azimuths) + " azimuths, " +
                  (fields.reduction == 4   ? "mirrored in two planes"
                   : fields.reduction == 2 ? "half a turn alike"
                                           : "without symmetry");
  }
  if (!layout.wavelengths.empty()) {
    char text[64];
    std::snprintf(text, sizeof text, ", %zu wavelengths, %g to %g nm", layout.wavelengths.size(),
                  double(layout.wavelengths.front()), double(layout.wavelengths.back()));
    facts.kind += text;
  }
  facts.theta_o = fields.theta_o;
  count_negative(facts, fields.ndf.values, fields.colours, fields.phi_o.size());
  facts.channels = fields.channels == 3 ? 3 : 1;
  if (!layout.wavelengths.empty() && fields.channels == 3)
    facts.notes.push_back("colours by the CIE 1931 observer under D65");
  const RglWideTable table(fields);
  probe_pairs(facts, [&](const ShadingGeometry<float>& g, int c) {
    const Spectrum value = table.unclipped(g);
    bool negative = value[c < value.channels() ? c : 0] < 0;
    for (int k = 0; fields.channels != 3 && k < value.channels(); ++k) negative = negative || value[k] < 0;
    return negative ? PairVerdict::clipped : PairVerdict::sound;
  });
  return facts;
}

}  // namespace

MeasuredFacts rgl_facts(ByteView bytes, const std::string& path, const std::string& member) {
  const bool as_rgb = rgl_as_rgb(bytes, path, member);
  const RglLayout layout = rgl_layout(bytes, path);
  if (!layout.is_isotropic_rgb()) return wide_rgl_facts(read_rgl_wide_fields(bytes, path, as_rgb), layout);
  const RglFields fields = read_rgl_fields(bytes, path);
  MeasuredFacts facts;
  facts.kind = "RGL tensor_file";
  facts.theta_o = fields.theta_o;
  count_negative(facts, fields.ndf, fields.rgb, 1);
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
