// SPDX-License-Identifier: Apache-2.0
// A material's section of the page.
#include <algorithm>

#include "page_parts.hpp"
#include "reflectree/draw/report.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

std::string cell(const std::string& text) { return element("td", {}, text); }

std::string table(const MaterialResult& m, const StudyOptions& o) {
  std::string out =
      "<div class=\"scroll\"><table><thead><tr><th>sampler</th><th><i>θ</i><sub>o</sub></th><th>variance"
      "<small>target</small></th><th>variance<small>sum</small></th><th>variance<small>worst channel"
      "</small></th><th>dead</th><th>bias<small>± 95 %</small></th><th>ns<small>sample</small></th>"
      "<th>× floor</th><th>ns<small>pdf</small></th><th>KiB</th><th>build s</th></tr></thead><tbody>";
  for (const SamplerResult& s : m.samplers) {
    if (!s.fault.empty()) {
      out += "<tr>" + element("th", {}, escape(s.sampler)) +
             element("td", {{"class", "word"}, {"colspan", "11"}}, escape(s.fault)) + "</tr>\n";
    }
    for (std::size_t i = 0; i < s.cells.size(); ++i) {
      const StudyCell& c = s.cells[i];
      out += "<tr>" + element("th", {}, i ? "" : escape(s.sampler)) + cell(number(o.theta_o_deg[i]) + "°") +
             cell(pretty(c.target_variance, 2)) + cell(pretty(c.sum_variance, 2)) +
             cell(pretty(c.worst_variance, 2)) + cell(pretty(c.dead * 100, 2) + " %") +
             cell(pretty(c.bias, 2) + " ± " + pretty(c.bias_interval, 1) + (c.biased ? " biased" : "")) +
             cell(pretty(c.sample_ns)) + cell(pretty(c.sample_ns / c.floor_ns, 2)) +
             cell(c.pdf_ns > 0 ? pretty(c.pdf_ns) : "–") + cell(i ? "" : pretty(double(s.bytes) / 1024)) +
             cell(i ? "" : pretty(s.build_seconds, 2)) + "</tr>\n";
    }
  }
  return out + "</tbody></table></div>";
}

// Who is best here, and by how much.
std::string words(const MaterialResult& m, const Verdict& v) {
  for (const Loss& l : v.losses) {
    if (l.material == m.material)
      return "<span class=\"verdict fail\">lost</span> to " + escape(l.winner) + ", ours is worth " +
             pretty(l.ratio) + " of it: " + escape(cause_of(l)) + ".";
  }
  double ours = 0, other = 0;
  std::string mode, rival;
  for (const SamplerResult& s : m.samplers) {
    const auto score = std::find_if(v.scores.begin(), v.scores.end(),
                                    [&](const Score& x) { return x.sampler == s.sampler; });
    if (score == v.scores.end() || !score->general) continue;
    const double e = efficiency(s);
    if (score->ours && e > ours) ours = e, mode = s.sampler;
    if (!score->ours && e > other) other = e, rival = s.sampler;
  }
  if (!(ours > 0) || !(other > 0)) return "";
  return "<span class=\"verdict pass\">won</span> by " + escape(mode) + ", " + pretty(ours / other) +
         " times as efficient as the best other general method, " + escape(rival) + ".";
}

}  // namespace

std::string material_section(const MaterialResult& m, std::size_t place, std::size_t of, const Verdict& v,
                             std::span<const Illumination> lights, const StudyOptions& o) {
  std::string out =
      "<div class=\"head\"><h2>" + escape(short_name(m.material)) + "</h2><span class=\"origin\">";
  if (of > 1) {
    const auto step = [&](std::size_t to, const char* text) {
      return element("a", {{"href", "#" + anchor_of(to % of)}}, text);
    };
    out += step(place + of - 1, "← previous") + " · <a href=\"#materials\">all materials</a> · " +
           step(place + 1, "next →");
  }
  out += "</span></div>\n<p class=\"origin\">" + escape(m.material) + "</p>\n<p>" + words(m, v) + "</p>\n";
  out +=
      "<h3>Slices in the plane of incidence, sr⁻¹; the viewer at positive angles</h3>\n" +
      whole(slice_figure(m, o)) +
      "<p class=\"origin\">Densities stored in polar coordinates rise to a spike at the pole of their chart, "
      "which holds next to no directions.</p>\n";
  out +=
      "<h3>Error of reflected radiance, at the elevation nearest to 45°</h3>\n<div class=\"pictures two\">";
  for (std::size_t e = 0; e < std::min<std::size_t>(lights.size(), 2); ++e) {
    for (const bool over_time : {false, true})
      out += "<figure>" + inline_svg(error_figure(m, e, lights[e].name, o, over_time)) + "</figure>\n";
  }
  out += "</div>\n<h3>Cost for the same error, over the best of the column</h3>\n" +
         whole(heat_figure(m, lights, o));
  out += "<details><summary>Every figure</summary>" + table(m, o) + "</details>\n";
  const std::string css = of > 3 ? place == 0 ? "card one-of-many first" : "card one-of-many" : "card";
  return element("section", {{"class", css}, {"id", anchor_of(place)}}, out) + "\n";
}

}  // namespace reflectree::study
