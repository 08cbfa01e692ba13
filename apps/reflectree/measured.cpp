// SPDX-License-Identifier: Apache-2.0
#include "measured.hpp"

#include <algorithm>

namespace reflectree::cli {

namespace {

using Counts = std::array<std::uint64_t, 3>;

double share(std::uint64_t part, std::uint64_t whole) { return whole ? double(part) / double(whole) : 0; }
std::string percent(std::uint64_t part, std::uint64_t whole) {
  return part ? fmt::format("{:.3g} %", 100 * share(part, whole)) : "0";
}

bool any(const Counts& counts) { return counts != Counts{}; }

double degrees(float radians) { return double(radians) * 180 / pi_v<double>; }

// "red 1 %, green 0, blue 0.3 % of 20000 random pairs"
std::string by_channel(const Counts& counts, std::uint64_t pairs, int channels) {
  if (channels == 1) return fmt::format("{} of {} random pairs", percent(counts[0], pairs), pairs);
  return fmt::format("red {}, green {}, blue {} of {} random pairs", percent(counts[0], pairs),
                     percent(counts[1], pairs), percent(counts[2], pairs), pairs);
}

// The band of elevations where most of what is told above happens.
std::string worst_band(const MeasuredFacts& facts) {
  std::size_t worst = 0;
  const auto in = [&](std::size_t i) { return share(facts.touched_in_band[i], facts.pairs_in_band[i]); };
  for (std::size_t i = 1; i < facts.pairs_in_band.size(); ++i) worst = in(i) > in(worst) ? i : worst;
  return fmt::format("; most where the larger elevation is {:g} to {:g} deg: {} of the pairs there",
                     facts.bands_deg[worst], facts.bands_deg[worst + 1],
                     percent(facts.touched_in_band[worst], facts.pairs_in_band[worst]));
}

std::string entries_text(const MeasuredFacts& facts) {
  if (facts.entries == 0) return "a formula";
  if (facts.not_measured) {
    return fmt::format("{} of {} entries were not measured ({})", facts.not_measured, facts.entries,
                       percent(facts.not_measured, facts.entries));
  }
  if (!facts.negative) return fmt::format("none of {} entries is negative", facts.entries);
  std::string text = fmt::format("{} of {} entries are negative ({})", facts.negative, facts.entries,
                                 percent(facts.negative, facts.entries));
  const auto most = std::max_element(facts.negative_at.begin(), facts.negative_at.end());
  if (most != facts.negative_at.end() && *most) {
    const auto node = std::size_t(most - facts.negative_at.begin());
    text += fmt::format(", {} of them at theta_o = {:.1f} deg", *most, degrees(facts.theta_o[node]));
  }
  return text;
}

Json counts_json(const Counts& counts, std::uint64_t pairs) {
  return Json{share(counts[0], pairs), share(counts[1], pairs), share(counts[2], pairs)};
}

}  // namespace

std::vector<MeasuredFile> measured_files(const std::string& material, const FilePlaces& places) {
  std::vector<MeasuredFile> files;
  for (const MaterialTerm& term : parse_material(material, places).terms) {
    if (term.path.empty()) continue;
    const Bytes bytes = read_material_file(term.path, places);
    if (auto facts = measured_facts(bytes, term.path, term.member))
      files.push_back({file_text(term.path, term.member), *std::move(facts)});
  }
  return files;
}

Json measured_json(const std::vector<MeasuredFile>& files) {
  Json all = Json::array();
  for (const auto& [text, facts] : files) {
    Json bands = Json::array();
    for (std::size_t i = 0; i < facts.pairs_in_band.size(); ++i) {
      bands.push_back({{"from_deg", facts.bands_deg[i]},
                       {"to_deg", facts.bands_deg[i + 1]},
                       {"pairs", facts.pairs_in_band[i]},
                       {"touched", facts.touched_in_band[i]}});
    }
    Json nodes = Json::array();
    for (std::size_t i = 0; i < facts.theta_o.size(); ++i) {
      nodes.push_back({{"theta_o_deg", degrees(facts.theta_o[i])}, {"negative", facts.negative_at[i]}});
    }
    all.push_back({{"file", text},
                   {"kind", facts.kind},
                   {"entries", facts.entries},
                   {"negative_entries", facts.negative},
                   {"not_measured_entries", facts.not_measured},
                   {"negative_by_theta_o", nodes},
                   {"pairs", facts.pairs},
                   {"clipped_share", counts_json(facts.clipped, facts.pairs)},
                   {"bridged_share", counts_json(facts.bridged, facts.pairs)},
                   {"dark_share", counts_json(facts.dark, facts.pairs)},
                   {"by_elevation", bands},
                   {"notes", facts.notes}});
  }
  return all;
}

std::vector<NamedLine> measured_lines(const MeasuredFile& file) {
  const MeasuredFacts& facts = file.facts;
  std::vector<NamedLine> lines{
      {"measured", fmt::format("{}: {}, {}", file.text, facts.kind, entries_text(facts))}};
  const auto ends_at = [&](const char* side, float theta_o) {
    lines.push_back({"", fmt::format("nothing was measured for theta_o {} {:.1f} deg: what was measured "
                                     "there stands in",
                                     side, degrees(theta_o))});
  };
  if (!facts.theta_o.empty() && degrees(facts.theta_o.front()) > 0.5) ends_at("below", facts.theta_o.front());
  if (!facts.theta_o.empty() && degrees(facts.theta_o.back()) < 89.5) ends_at("beyond", facts.theta_o.back());
  const auto told = [&](const char* name, const Counts& counts) {
    if (any(counts)) lines.push_back({name, by_channel(counts, facts.pairs, facts.channels)});
  };
  told("clipped at 0", facts.clipped);
  told("bridged gaps", facts.bridged);
  told("gaps read as 0", facts.dark);
  if (lines.back().value.ends_with("random pairs")) lines.back().value += worst_band(facts);
  for (const std::string& note : facts.notes) lines.push_back({"", note});
  return lines;
}

}  // namespace reflectree::cli
