// SPDX-License-Identifier: Apache-2.0
#include "demo.hpp"
#include "table.hpp"

namespace reflectree::cli {

namespace {

std::string build_text(const draw::ReportFigures& f) {
  return f.build_seconds ? fmt::format("{:.2f}", *f.build_seconds) : "-";
}

Table table_of(const std::vector<Outcome>& outcomes) {
  Table table{{"material", "domain", "slabs", "leaves", "KiB", "build s", "trials", "chi2", "overshoot",
               "at most", "exact ns", "1-shot ns", "variance"},
              {}};
  for (const Outcome& o : outcomes) {
    const draw::ReportFigures& f = o.report.figures;
    table.rows.push_back(
        {o.name, f.domain, fmt::format("{}+{}", f.exact_slabs, f.one_shot_slabs),
         fmt::format("{}+{}", f.exact_leaves, f.one_shot_leaves), fmt::format("{:.0f}", f.kib.value_or(0)),
         build_text(f), fmt::format("{:.3f}", o.speed.mean_trials), all_passed(o.checks) ? "pass" : "FAIL",
         fmt::format("{:.1g}", o.overshoot.mass.estimate), fmt::format("{:.1g}", o.overshoot.mass.upper),
         fmt::format("{:.0f}", o.speed.exact_ns), fmt::format("{:.0f}", o.speed.one_shot_ns),
         fmt::format("{:.4f}", f.relative_variance.value_or(0))});
  }
  return table;
}

Json json_of(const Outcome& o) {
  const draw::ReportFigures& f = o.report.figures;
  Json json{{"material", o.text},
            {"sampler", o.saved},
            {"domain", f.domain},
            {"exact_slabs", f.exact_slabs},
            {"one_shot_slabs", f.one_shot_slabs},
            {"exact_leaves", f.exact_leaves},
            {"one_shot_leaves", f.one_shot_leaves},
            {"kib", f.kib.value_or(0)},
            {"build_seconds", nullptr},
            {"mean_trials", o.speed.mean_trials},
            {"chi_square_passed", all_passed(o.checks)},
            {"chi_square_tests", o.checks.size()},
            {"smallest_p_value", f.chi_square ? f.chi_square->smallest_p : 1.},
            {"overshoot_mass", o.overshoot.mass.estimate},
            {"overshoot_mass_upper", o.overshoot.mass.upper},
            {"exact_ns", o.speed.exact_ns},
            {"one_shot_ns", o.speed.one_shot_ns},
            {"relative_variance", f.relative_variance.value_or(0)}};
  if (f.build_seconds) json["build_seconds"] = *f.build_seconds;
  return json;
}

}  // namespace

void show_outcomes(const Context& context, const std::vector<Outcome>& outcomes, const std::string& page,
                   double seconds) {
  if (context.json) {
    Json all = Json::array();
    for (const Outcome& o : outcomes) all.push_back(json_of(o));
    context.print_json("demo", {{"materials", all}, {"page", page}, {"seconds", seconds}});
    return;
  }
  context.print(coloured_verdicts(to_text(table_of(outcomes))));
  context.print("\n" + page + "\n");
  context.say(fmt::format("{} materials in {:.0f} s", outcomes.size(), seconds));
}

}  // namespace reflectree::cli
