// SPDX-License-Identifier: Apache-2.0
// Exact sampling beside, and together with, other ways of reducing variance.
#include "report.hpp"
#include "ways.hpp"

namespace reflectree::pictures {

void add_ways(Page& page, const Results& results, const Plan& plan) {
  page.section("Combined with other variance reduction");
  page.words(
      "Direct light, which admits every way; pixels that show a sampled material. Plain: independent points, "
      "the material's own directions, no lights. Each row follows " +
      std::to_string(plan.directions) +
      " directions per pixel from the material, one or four for a camera sample; MIS adds a sample of a "
      "light for each, resampling draws eight candidates for each. Gains over plain of the same sampler: "
      "variance at equal samples, efficiency, 1 / (variance × CPU time), and variance without the one pixel "
      "in a "
      "thousand whose error is largest. Where a lamp is small, the few directions that hit it by chance are "
      "plain's variance: the first two are then as uncertain as their errors say, and the third is of "
      "pictures in which that lamp is missing.");
  for (const Setting* setting : plan.settings) {
    Table t{{"way"}, {}};
    for (const char* sampler : {"exact", "one-shot", "one-shot-monotone"}) {
      for (const char* figure : {": variance", ": efficiency (*)", ": variance, trimmed"})
        t.head.push_back(std::string(sampler) + figure);
    }
    for (const Way& way : ways()) {
      std::vector<std::string> row{way.alone ? way.name : "together: " + std::string(way.name)};
      bool any = false;
      for (const char* sampler : {"exact", "one-shot", "one-shot-monotone"}) {
        const Cells plain = results.of(setting->name, ways().front().name, sampler),
                    cells = results.of(setting->name, way.name, sampler);
        if (plain.empty() || cells.empty()) {
          row.insert(row.end(), 3, "–");
          continue;
        }
        const Gain gain = gain_of(plain, cells);
        row.insert(row.end(), {shown(gain.variance), shown(gain.efficiency), shown(gain.trimmed)});
        any = true;
      }
      if (any) t.rows.push_back(row);
    }
    if (t.rows.empty()) continue;
    page.part(setting->words);
    page.table(t);
  }
}

}  // namespace reflectree::pictures
