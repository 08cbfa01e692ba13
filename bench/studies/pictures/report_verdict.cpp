// SPDX-License-Identifier: Apache-2.0
// The verdict, computed from the cells: nothing here is written by hand.
#include <cmath>

#include "reflectree/study/report.hpp"
#include "report.hpp"

namespace reflectree::pictures {

namespace {

std::string words_of(Half half) {
  switch (half) {
    case Half::reached:
      return "reached";
    case Half::out_of_reach:
      return "out of anyone's reach";
    case Half::missed:
      break;
  }
  return "missed";
}

std::string holds(bool yes) { return yes ? "holds" : "does not hold"; }

Table halves(const Verdict& v) {
  Table t{{"scene", "method", "rival", v.ours + " = 1, equal time (*)", "exact = 1, equal time (*)",
           "exact = 1, equal samples", "half of the rival's"},
          {}};
  for (const Against& a : v.against) {
    if (is_demanded(a))
      t.rows.push_back(
          {a.scene, a.method, a.rival, shown(a.one_shot), shown(a.exact), shown(a.ideal), words_of(a.half)});
  }
  return t;
}

Table means(const Verdict& v) {
  Table t{{"method", "general sampler", "scenes", v.ours + " = 1 (*)", "exact = 1 (*)"}, {}};
  for (const Mean& m : v.means)
    t.rows.push_back({m.method, m.rival, std::to_string(m.scenes), shown(m.one_shot), shown(m.exact)});
  return t;
}

// Where the rival gains: in the variance of its samples or in their price.
std::string cause_of(const Against& a) {
  const double price = a.one_shot.value / a.samples.value;
  if (a.samples.value > .99) return "quicker samples";
  return price > .99 ? "less variance" : "quicker samples and less variance";
}

Table losses(const Verdict& v) {
  Table t{{"scene", "method", "rival", v.ours + " = 1, equal time (*)", "equal samples", "the rival has",
           "beyond noise"},
          {}};
  for (const Against& a : v.against) {
    if (!(a.one_shot.value < 1)) continue;
    t.rows.push_back({a.scene, a.method, a.rival + (a.general ? "" : " (special)"), shown(a.one_shot),
                      shown(a.samples), cause_of(a),
                      std::isnan(a.one_shot.error) ? "one seed"
                      : is_loss(a.one_shot)        ? "yes"
                                                   : "no"});
  }
  return t;
}

}  // namespace

void add_verdict(Page& page, const Verdict& v) {
  page.section("Verdict");
  if (v.against.empty()) {
    page.words("Nothing to compare yet.");
    return;
  }
  std::size_t reached = 0, beyond = 0, demanded = 0;
  for (const Against& a : v.against) {
    if (!is_demanded(a)) continue;
    ++demanded, reached += a.half == Half::reached, beyond += a.half == Half::out_of_reach;
  }
  page.words(
      "Demand: at equal time at most half of the cosine lobe's relMSE, and of the fitted proxy's, in every "
      "scene: " +
      holds(v.half_everywhere) + " (" + std::to_string(reached) + " of " + std::to_string(demanded) + "; " +
      std::to_string(beyond) + " are out of reach). relMSE of the rival over ours, so that 2 is half:");
  page.table(halves(v));
  page.words(
      "Out of anyone's reach: exact mode draws in proportion to f cos, and no sampler of that factor does "
      "better. Where even its error at equal samples is more than half of the rival's, by two standard "
      "errors, a sampler that costs no more than the rival cannot halve it: the noise that is left comes "
      "from the light.");
  page.words(
      "Demand of decision 0022: half where it is within anyone's reach, elsewhere no loss beyond noise: " +
      holds(v.half_within_reach) + ".");
  page.words(
      "Demand: in geometric mean over scenes no worse than any general sampler, within two standard "
      "errors: " +
      holds(v.best_in_mean) + ".");
  page.table(means(v));
  std::vector<study::Bar> bars;
  for (const Mean& m : v.means) {
    if (m.method == "path") bars.push_back({m.rival, m.one_shot.value, false});
  }
  page.figure(study::bar_figure("relMSE at equal time, geometric mean, path tracing", v.ours + " = 1", bars));
  const Table lost = losses(v);
  page.words(lost.rows.empty() ? "No sampler is better anywhere."
                               : "Every rival that is better somewhere, by its ratio:");
  if (!lost.rows.empty()) page.table(lost);
}

}  // namespace reflectree::pictures
