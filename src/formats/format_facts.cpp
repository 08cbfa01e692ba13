// SPDX-License-Identifier: Apache-2.0
#include "format_facts.hpp"

#include <algorithm>

#include "reflectree/error.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/model_tables.hpp"
#include "reflectree/formats/rgl.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t pair_count = 20000, seed = 38;

Direction uniform_direction(Pcg32& random) {
  const float z = 1 - to_unit_float(random()), phi = 2 * pi * to_unit_float(random());
  const float r = sqrt(max(1 - z * z, 0.f));
  return {r * cos(phi), r * sin(phi), z};
}

enum class Verdict { sound, clipped, bridged, dark };

// Asks judge(g, channel) of random pairs.
template <class Judge>
void probe(MeasuredFacts& facts, const Judge& judge) {
  Pcg32 random(seed);
  while (facts.pairs < pair_count) {
    const Direction wo = uniform_direction(random);
    Direction wi = uniform_direction(random);
    if (facts.pairs % 2 == 0) {
      const float x = to_unit_float(random()) - 0.5f, y = to_unit_float(random()) - 0.5f;
      wi = reflect(wo, normalize(Direction{0.5f * x, 0.5f * y, 1}));
    }
    if (!(wi.z > 0)) continue;
    const ShadingGeometry<float> g = shading_geometry(wo, wi);
    const double elevation_deg = std::acos(double(min(wo.z, wi.z))) * 180 / pi_v<double>;
    std::size_t band = 0;
    while (band + 1 < facts.pairs_in_band.size() && elevation_deg >= MeasuredFacts::bands_deg[band + 1])
      ++band;
    bool touched = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const Verdict verdict = judge(g, int(c));
      touched = touched || verdict != Verdict::sound;
      if (verdict == Verdict::clipped) ++facts.clipped[c];
      if (verdict == Verdict::bridged) ++facts.bridged[c];
      if (verdict == Verdict::dark) ++facts.dark[c];
    }
    ++facts.pairs, ++facts.pairs_in_band[band];
    if (touched) ++facts.touched_in_band[band];
  }
}

template <class F>
void probe_sign(MeasuredFacts& facts, const F& f) {
  probe(facts, [&f](const ShadingGeometry<float>& g, int c) {
    return channel_value(f.unclipped(g), c) < 0 ? Verdict::clipped : Verdict::sound;
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
  probe(facts, [&table](const ShadingGeometry<float>& g, int c) {
    const float share = channel_value(table.unmeasured(g), c);
    return share <= 0 ? Verdict::sound : share >= 1 ? Verdict::dark : Verdict::bridged;
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
