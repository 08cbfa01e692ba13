// SPDX-License-Identifier: Apache-2.0
#include "reflectree/study/report.hpp"

#include <algorithm>

#include "reflectree/draw/plot.hpp"
#include "reflectree/draw/report.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

std::string cell(const std::string& text) { return element("td", {}, escape(text)); }

std::string verdict_section(const Verdict& v) {
  std::string rows;
  for (const Score& s : v.scores) {
    if (s.materials + s.faults == 0) continue;
    rows += "<tr>" + element("th", {{"scope", "row"}}, escape(s.sampler)) +
            cell(s.ours      ? "ours"
                 : s.general ? "general"
                             : "special") +
            cell(std::to_string(s.materials)) + cell(pretty(s.relative_efficiency)) +
            cell(std::to_string(s.biased_cells)) + cell(std::to_string(s.faults)) + "</tr>\n";
  }
  std::string out =
      "<section class=\"card\"><h2>Efficiency for reflected radiance</h2><p>1 / (RMSE² · time), "
      "averaged over rotations of every light; geometric means, the better of our two modes = 1. RMSE² is "
      "the "
      "variance of one sample, and what a mean of 1024 makes of a bias: 1024 (|bias| − its interval)².</p>"
      "<div class=\"scroll\"><table><thead><tr><th>sampler</th><th>kind</th><th>materials</th>"
      "<th>relative efficiency</th><th>biased cells</th><th>faults</th></tr></thead><tbody>" +
      rows + "</tbody></table></div>\n<p>";
  const auto word = [](bool holds) {
    return std::string("<span class=\"verdict ") + (holds ? "pass\">holds" : "fail\">fails") + "</span>";
  };
  out += "Best of all general methods in geometric mean: " + word(v.best_in_mean) +
         " On nine materials in ten: " + word(v.nine_in_ten) + " (" + std::to_string(v.won) + " of " +
         std::to_string(v.materials) + ")</p>";
  if (v.losses.empty()) return out + "</section>\n";
  out +=
      "<h3>Every loss</h3><div class=\"scroll\"><table><thead><tr><th>material</th><th>winner</th>"
      "<th>ours / winner</th><th>most at</th><th>RMSE² winner / ours</th><th>time winner / "
      "ours</th></tr></thead><tbody>";
  for (const Loss& l : v.losses) {
    out += "<tr>" + element("th", {{"scope", "row"}}, escape(l.material)) + cell(l.winner) +
           cell(pretty(l.ratio)) + cell(number(l.theta_o_deg) + "°, " + l.light) +
           cell(pretty(l.error_ratio)) + cell(pretty(l.time_ratio)) + "</tr>\n";
  }
  return out + "</tbody></table></div></section>\n";
}

// Medians over materials.
std::string memory_section(std::span<const MaterialResult> materials, const Verdict& v) {
  std::vector<Bar> bytes, seconds, time;
  for (const Score& s : v.scores) {
    std::vector<double> b, t, ns;
    for (const MaterialResult& m : materials) {
      for (const SamplerResult& r : m.samplers) {
        if (r.sampler != s.sampler || !r.fault.empty()) continue;
        b.push_back(double(r.bytes) / 1024), t.push_back(r.build_seconds);
        for (const Cell& c : r.cells) ns.push_back(c.sample_ns / c.floor_ns);
      }
    }
    const auto median = [](std::vector<double>& x) {
      if (x.empty()) return 0.;
      std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
      return x[x.size() / 2];
    };
    bytes.push_back({s.sampler, median(b), s.ours});
    seconds.push_back({s.sampler, median(t), s.ours});
    time.push_back({s.sampler, median(ns), s.ours});
  }
  return "<section class=\"card\"><h2>Cost</h2><p>Medians over the materials.</p><div class=\"pictures "
         "wide\">"
         "<figure>" +
         inline_svg(bar_figure("Memory", "KiB", bytes)) + "</figure><figure>" +
         inline_svg(bar_figure("Precomputation", "s", seconds)) + "</figure><figure>" +
         inline_svg(bar_figure("One sample", "cosine samples", time)) + "</figure></div></section>\n";
}

std::string material_table(const MaterialResult& m, const StudyOptions& o) {
  std::string out =
      "<div class=\"scroll\"><table><thead><tr><th>sampler</th><th>θ<sub>o</sub></th><th>variance"
      "<small>target</small></th><th>variance<small>sum</small></th><th>variance<small>worst channel"
      "</small></th><th>dead</th><th>bias<small>± 95 %</small></th><th>ns<small>sample</small></th>"
      "<th>× floor</th><th>ns<small>pdf</small></th></tr></thead><tbody>";
  for (const SamplerResult& s : m.samplers) {
    if (!s.fault.empty()) {
      out += "<tr>" + element("th", {}, escape(s.sampler)) +
             element("td", {{"class", "word"}, {"colspan", "9"}}, escape(s.fault)) + "</tr>\n";
    }
    for (std::size_t i = 0; i < s.cells.size(); ++i) {
      const Cell& c = s.cells[i];
      out += "<tr>" + element("th", {}, i ? "" : escape(s.sampler)) + cell(number(o.theta_o_deg[i]) + "°") +
             cell(pretty(c.target_variance)) + cell(pretty(c.sum_variance)) + cell(pretty(c.worst_variance)) +
             cell(pretty(c.dead * 100, 2) + " %") +
             cell(pretty(c.bias, 2) + " ± " + pretty(c.bias_interval, 1) + (c.biased ? " biased" : "")) +
             cell(pretty(c.sample_ns)) + cell(pretty(c.sample_ns / c.floor_ns, 2)) +
             cell(c.pdf_ns > 0 ? pretty(c.pdf_ns) : "–") + "</tr>\n";
    }
  }
  return out + "</tbody></table></div>";
}

std::string material_section(const MaterialResult& m, std::span<const Environment> lights,
                             const StudyOptions& o) {
  std::string out =
      "<section class=\"card\"><h2>" + escape(m.material) + "</h2><div class=\"pictures wide\">";
  for (std::size_t e = 0; e < lights.size(); ++e) {
    for (const bool over_time : {false, true}) {
      out += "<figure>" + inline_svg(error_figure(m, e, lights[e].name, o, over_time)) + "</figure>";
    }
    out += "<figure>" + inline_svg(heat_figure(m, e, lights[e].name, o)) + "</figure>";
  }
  return out + "</div><details><summary>Every figure</summary>" + material_table(m, o) +
         "</details></section>\n";
}

}  // namespace

std::string study_html(std::span<const MaterialResult> materials, const Verdict& verdict,
                       std::span<const Environment> lights, const StudyOptions& o, const StudyMeta& meta) {
  std::string body = verdict_section(verdict) + memory_section(materials, verdict);
  for (const MaterialResult& m : materials) body += material_section(m, lights, o);
  const std::string made = "reflectree " + escape(meta.version) + " · " + escape(meta.machine) +
                           " · commit " + escape(meta.commit) + " · seed " + std::to_string(o.seed) +
                           " · made by " + element("code", {}, escape(meta.command));
  return page_html("Reflectree compared",
                   std::to_string(materials.size()) + " materials under " + std::to_string(lights.size()) +
                       " lights, every sampler of the registry.",
                   body, made);
}

}  // namespace reflectree::study
