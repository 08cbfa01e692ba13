// SPDX-License-Identifier: Apache-2.0
// What compare shows on the screen.
#include "compare.hpp"
#include "table.hpp"

namespace reflectree::cli {

using namespace study;

void show(const Context& context, const std::vector<MaterialResult>& all, const Verdict& v,
          std::span<const Illumination> lights, const StudyOptions& o) {
  for (const MaterialResult& m : all) {
    Table table{{m.material, "theta_o", "variance", "sum", "worst", "dead %", "bias", "+-", "ns", "x floor",
                 "pdf ns", "KiB", "build s"},
                {}};
    for (const Illumination& light : lights) table.head.push_back("eff " + light.name);
    for (const SamplerResult& s : m.samplers) {
      if (!s.fault.empty()) table.rows.push_back({s.sampler, "fault"});
      for (std::size_t i = 0; i < s.cells.size(); ++i) {
        const study::StudyCell& c = s.cells[i];
        table.rows.push_back(
            {s.sampler, fmt::format("{}", o.theta_o_deg[i]), fmt::format("{:.3g}", c.target_variance),
             fmt::format("{:.3g}", c.sum_variance), fmt::format("{:.3g}", c.worst_variance),
             fmt::format("{:.2g}", c.dead * 100), fmt::format("{:.1e}{}", c.bias, c.biased ? "!" : ""),
             fmt::format("{:.0e}", c.bias_interval), fmt::format("{:.0f}", c.sample_ns),
             fmt::format("{:.1f}", c.sample_ns / c.floor_ns),
             c.pdf_ns > 0 ? fmt::format("{:.0f}", c.pdf_ns) : "-",
             fmt::format("{:.0f}", double(s.bytes) / 1024), fmt::format("{:.2f}", s.build_seconds)});
        for (std::size_t e = 0; e < lights.size(); ++e) {
          table.rows.back().push_back(fmt::format("{:.2e}", c.efficiency(e)));
        }
      }
    }
    context.print(to_text(table) + "\n");
  }
  Table scores{{"sampler", "kind", "materials", "efficiency", "biased cells", "faults"}, {}};
  for (const Score& s : v.scores) {
    if (s.materials + s.faults == 0) continue;
    scores.rows.push_back({s.sampler,
                           s.ours      ? "ours"
                           : s.general ? "general"
                                       : "special",
                           std::to_string(s.materials), fmt::format("{:.3g}", s.relative_efficiency),
                           std::to_string(s.biased_cells), std::to_string(s.faults)});
  }
  if (v.materials == 0) {
    context.print("no verdict: ours and a general competitor are wanted on one material at least\n");
    return;
  }
  context.print(to_text(scores));
  context.print(fmt::format(
      "\n{}  best of all general methods in geometric mean\n{}  best on nine materials in ten: {} of {}\n",
      v.best_in_mean ? "holds" : "fails", v.nine_in_ten ? "holds" : "fails", v.won, v.materials));
  for (const Loss& l : v.losses) {
    context.print(fmt::format(
        "loss  {}: {:.3g} of {}, most at {} deg under {}: it has {:.3g} of our RMSE^2, {:.3g} of our time: "
        "{}\n",
        l.material, l.ratio, l.winner, l.theta_o_deg, l.light, l.error_ratio, l.time_ratio, cause_of(l)));
  }
}

}  // namespace reflectree::cli
