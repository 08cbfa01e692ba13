// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "page_parts.hpp"
#include "reflectree/draw/report.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

std::string cell(const std::string& text) { return element("td", {}, escape(text)); }

std::string word(bool holds) {
  return std::string("<span class=\"verdict ") + (holds ? "pass\">holds" : "fail\">fails") + "</span>";
}

std::string losses_table(std::span<const MaterialResult> materials, const Verdict& v) {
  std::string out =
      "<h3>Every loss, and its cause</h3><div class=\"scroll\"><table><thead><tr><th>material</th>"
      "<th class=\"word\">winner</th><th>ours / winner</th><th class=\"word\">the winner has</th><th>most "
      "at</th><th>RMSE²<small>winner / ours</small></th><th>time<small>winner / ours</small></th></tr>"
      "</thead><tbody>";
  for (const Loss& l : v.losses) {
    std::size_t place = 0;
    while (place + 1 < materials.size() && materials[place].material != l.material) ++place;
    const std::string link = element("a", {{"href", "#" + anchor_of(place)}}, escape(short_name(l.material)));
    out += "<tr>" + element("th", {{"scope", "row"}}, link) +
           element("td", {{"class", "word"}}, escape(l.winner)) + cell(pretty(l.ratio)) +
           element("td", {{"class", "word"}}, escape(cause_of(l))) +
           cell(number(l.theta_o_deg) + "°, " + l.light) + cell(pretty(l.error_ratio)) +
           cell(pretty(l.time_ratio)) + "</tr>\n";
  }
  return out + "</tbody></table></div>";
}

std::string verdict_section(std::span<const MaterialResult> materials, const Verdict& v) {
  std::string rows, tiles;
  std::vector<Bar> bars;
  const Score* rival = nullptr;
  for (const Score& s : v.scores) {
    if (s.materials + s.faults == 0) continue;
    bars.push_back({s.sampler, s.relative_efficiency, s.ours});
    if (s.general && !s.ours && (!rival || s.relative_efficiency > rival->relative_efficiency)) rival = &s;
    rows += "<tr>" + element("th", {{"scope", "row"}}, escape(s.sampler)) +
            cell(s.ours      ? "ours"
                 : s.general ? "general"
                             : "special") +
            cell(std::to_string(s.materials)) + cell(pretty(s.relative_efficiency)) +
            cell(std::to_string(s.biased_cells)) + cell(std::to_string(s.faults)) + "</tr>\n";
  }
  const auto tile = [&](const std::string& name, const std::string& value) {
    tiles += "<div><dt>" + name + "</dt><dd>" + value + "</dd></div>";
  };
  tile("best of all general methods, in geometric mean", word(v.best_in_mean));
  tile("best on nine materials in ten", word(v.nine_in_ten));
  tile("materials won", std::to_string(v.won) + " of " + std::to_string(v.materials));
  if (rival && rival->relative_efficiency > 0) {
    tile("next best general method", escape(rival->sampler));
    tile("ours over it, geometric mean", "× " + pretty(1 / rival->relative_efficiency));
  }
  std::string out =
      "<section class=\"card\"><h2>Verdict</h2><p class=\"origin\">Efficiency for reflected radiance: 1 / "
      "(RMSE² · time), averaged over rotations of every light. RMSE² is the variance of one sample, and what "
      "a mean of 1024 makes of a bias: 1024 (|bias| − its interval)². Geometric means over elevations, "
      "lights and materials; the better of our two modes = 1.</p><dl>" +
      tiles + "</dl>\n<div class=\"pictures wide\"><figure>" +
      inline_svg(bar_figure("Efficiency", "the better of our modes = 1", bars, true)) +
      "</figure><div class=\"scroll\"><table><thead><tr><th>sampler</th><th>kind</th><th>materials</th>"
      "<th>efficiency</th><th>biased</th><th>faults</th></tr></thead><tbody>" +
      rows + "</tbody></table></div></div>\n";
  if (!v.losses.empty()) out += losses_table(materials, v);
  return out + "</section>\n";
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
        for (const StudyCell& c : r.cells) ns.push_back(c.sample_ns / c.floor_ns);
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

std::string glance_section(std::span<const MaterialResult> materials, const Verdict& v) {
  return "<section class=\"card\" id=\"materials\"><h2>Every material at a glance</h2><p class=\"origin\">"
         "What each sampler costs for the same error, over the best of the row: pale is best, dark a "
         "thousand "
         "times as dear. A material's name leads to its slices, curves and figures.</p>" +
         whole(glance_figure(materials, v)) + "</section>\n";
}

}  // namespace

std::string study_html(std::span<const MaterialResult> materials, const Verdict& verdict,
                       std::span<const Illumination> lights, const StudyOptions& o, const StudyMeta& meta) {
  std::string body = verdict_section(materials, verdict) + glance_section(materials, verdict) +
                     memory_section(materials, verdict);
  for (std::size_t i = 0; i < materials.size(); ++i)
    body += material_section(materials[i], i, materials.size(), verdict, lights, o);
  const std::string made = "reflectree " + escape(meta.version) + " · " + escape(meta.machine) +
                           " · commit " + escape(meta.commit) + " · seed " + std::to_string(o.seed) +
                           " · made by " + element("code", {}, escape(meta.command));
  return page_html("Reflectree compared",
                   std::to_string(materials.size()) + " materials under " + std::to_string(lights.size()) +
                       " lights, every sampler of the registry.",
                   body, made);
}

}  // namespace reflectree::study
