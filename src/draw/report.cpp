// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/report.hpp"

#include "reflectree/draw/svg.hpp"
#include "report_style.hpp"

namespace reflectree::draw {

namespace {

constexpr const char* dash = "–";

std::string shown(const std::optional<double>& value, int digits = 3) {
  return value ? pretty(*value, digits) : dash;
}

// "exact / one-shot unit", or a dash where neither was measured.
std::string pair(const std::optional<double>& exact, const std::optional<double>& one_shot,
                 const char* unit) {
  return exact || one_shot ? shown(exact) + " / " + shown(one_shot) + unit : dash;
}

std::string count(std::size_t n) { return pretty(double(n), 9); }

std::string verdict(const std::optional<ChiSquareVerdict>& chi) {
  if (!chi) return dash;
  return std::string("<span class=\"verdict ") + (chi->passed ? "pass\">holds" : "fail\">rejected") +
         "</span>";
}

std::string verdict_note(const std::optional<ChiSquareVerdict>& chi) {
  if (!chi) return "";
  return std::to_string(chi->tests) + (chi->tests == 1 ? " test" : " tests") + ", smallest p " +
         pretty(chi->smallest_p, 2);
}

std::string small(const std::string& text) { return text.empty() ? "" : element("small", {}, escape(text)); }

std::string anchor(std::size_t i) { return "material-" + std::to_string(i + 1); }

std::string table(const std::vector<ReportMaterial>& materials) {
  std::string rows;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const ReportMaterial& m = materials[i];
    const ReportFigures& f = m.figures;
    const std::string link = element("a", {{"href", "#" + anchor(i)}}, escape(m.name));
    const std::string name = "<div class=\"name\">" + (m.thumbnail ? inline_svg(*m.thumbnail) : "") +
                             "<span>" + link + "</span></div>";
    std::string row = element("th", {{"scope", "row"}}, name);
    const auto cell = [&](const std::string& content) { row += "<td>" + content + "</td>"; };
    row += "<td class=\"word\">" + escape(f.domain) + small(f.bounds.empty() ? "" : f.bounds + " bounds") +
           "</td>";
    cell(count(f.exact_slabs) + small(count(f.one_shot_slabs)));
    cell(count(f.exact_leaves) + small(count(f.one_shot_leaves)));
    cell(shown(f.kib));
    cell(shown(f.build_seconds, 2));
    cell(shown(f.mean_trials));
    row += "<td class=\"word\">" + verdict(f.chi_square) + small(verdict_note(f.chi_square)) + "</td>";
    cell(shown(f.overshoot_mass, 2));
    cell(shown(f.exact_ns) + small(shown(f.one_shot_ns)));
    cell(shown(f.relative_variance, 2));
    rows += "<tr>" + row + "</tr>\n";
  }
  return "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"All "
         "materials\"><table><thead><tr>"
         "<th scope=\"col\">Material</th><th scope=\"col\" class=\"word\">Domain</th>"
         "<th scope=\"col\">Slabs<small>exact<br/>one-shot</small></th>"
         "<th scope=\"col\">Leaves<small>exact<br/>one-shot</small></th>"
         "<th scope=\"col\">KiB</th><th scope=\"col\">Build<small>seconds</small></th>"
         "<th scope=\"col\">Mean trials<small>exact</small></th>"
         "<th scope=\"col\" class=\"word\"><i>χ</i>²</th>"
         "<th scope=\"col\">Overshoot<small>mass</small></th>"
         "<th scope=\"col\">ns per sample<small>exact<br/>one-shot</small></th>"
         "<th scope=\"col\">Relative variance<small>one-shot</small></th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

std::string tiles(const ReportFigures& f) {
  std::string out;
  const auto tile = [&](const std::string& name, const std::string& value) {
    out += "<div><dt>" + name + "</dt><dd>" + value + "</dd></div>";
  };
  tile("domain", f.domain.empty() ? dash : escape(f.domain));
  tile("slabs, exact / one-shot", count(f.exact_slabs) + " / " + count(f.one_shot_slabs));
  tile("leaves, exact / one-shot", count(f.exact_leaves) + " / " + count(f.one_shot_leaves));
  tile("memory", f.kib ? shown(f.kib) + " KiB" : dash);
  tile("build", f.build_seconds ? shown(f.build_seconds, 2) + " s" : dash);
  tile("mean trials", shown(f.mean_trials));
  tile("overshoot mass", shown(f.overshoot_mass, 2));
  tile("per sample, exact / one-shot", pair(f.exact_ns, f.one_shot_ns, " ns"));
  tile("relative variance, one-shot", shown(f.relative_variance, 2));
  return "<dl>" + out + "</dl>\n";
}

std::string pictures(const std::vector<Figure>& figures, const char* css_class) {
  std::string out;
  for (const Figure& f : figures) out += "<figure>" + inline_svg(f) + "</figure>\n";
  return element("div", {{"class", css_class}}, out) + "\n";
}

std::string section(const ReportMaterial& m, std::size_t index) {
  std::string out = "<div class=\"head\"><h2>" + escape(m.name) + "</h2><span>" +
                    (m.figures.chi_square ? verdict(m.figures.chi_square) : "");
  const std::string note = verdict_note(m.figures.chi_square);
  out += (note.empty() ? "" : " " + element("span", {{"class", "origin"}}, "<i>χ</i>²: " + escape(note))) +
         "</span></div>\n";
  if (!m.origin.empty()) out += "<p class=\"origin\">" + escape(m.origin) + "</p>\n";
  out += tiles(m.figures);
  for (const ReportView& v : m.views) {
    out += "<h3>Seen at <i>θ</i><sub>o</sub> = " + number(v.theta_o_deg, 3) + "°</h3>\n" +
           pictures(v.pictures, "pictures");
  }
  if (!m.overview.empty())
    out += "<h3>For every <i>θ</i><sub>o</sub></h3>\n" + pictures(m.overview, "pictures wide");
  return element("section", {{"class", "card"}, {"id", anchor(index)}}, out) + "\n";
}

// Says of chi-square what was measured, and no more.
std::string summary(const std::vector<ReportMaterial>& materials) {
  std::size_t tested = 0, rejected = 0;
  for (const ReportMaterial& m : materials) {
    tested += m.figures.chi_square.has_value();
    rejected += m.figures.chi_square && !m.figures.chi_square->passed;
  }
  const bool one = materials.size() == 1;
  std::string out =
      (one ? "One material, with" : std::to_string(materials.size()) + " materials, each with") +
      std::string(" a sampler built from nothing but its values.");
  if (tested == 0) return out;
  out += " The <i>χ</i>² test ";
  if (rejected == 0)
    return out + "holds for " +
           (tested < materials.size() ? std::to_string(tested)
            : one                     ? "it"
                                      : "all") +
           ".";
  return out + "rejects " + (one ? "it" : std::to_string(rejected)) + ".";
}

constexpr const char* how_to_read =
    R"(<section class="card"><div class="head"><h2>How to read the pictures</h2></div><div class="how">
<p>Each disk holds all directions of light <i>ω</i><sub>i</sub> above the surface, projected straight down: the normal is in the middle, grazing light at the rim. The ring marks the viewer <i>ω</i><sub>o</sub>; the cross is its mirror image, where a shiny surface peaks.</p>
<p><b>Target.</b> The reflectance <i>t</i>(<i>ω</i><sub>o</sub>, <i>ω</i><sub>i</sub>) per steradian, without cosine, on a log scale. On this disk the cosine is already in the area, so samples must be exactly as dense as the colour is bright.</p>
<p><b>Tree.</b> The leaves of the exact mode, in the same colours: each bounds the target from above. A direction is drawn under these bounds and kept with probability target over bound; otherwise the draw starts again. The cells bend because the tree lives on a square that the domain maps to the disk.</p>
<p><b>Samples.</b> Directions that the sampler returned, over the target.</p>
<p><b>Lobe.</b> Directions within 5° of the plane of incidence. The curve is the target's density; the bars count samples. In the polar plot areas are probabilities: the radius is the square root of the density.</p>
<p><b>The figures.</b> <i>Mean trials</i>: draws per direction, the price of exactness. <i>Overshoot mass</i>: the share of the target above its bounds, which biases exact mode by at most that much. <i>Relative variance</i>: of the weights of the one-shot mode, which never rejects.</p>
</div></section>
)";

}  // namespace

std::string page_html(const std::string& title, const std::string& lead, const std::string& body,
                      const std::string& made) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  out += element("title", {}, escape(title)) + "\n";
  out += element("style", {}, report_style + figure_style() + "\n.rt{--paper:transparent}") +
         "\n</head>\n<body>\n";
  out += "<header class=\"top\"><h1>" + escape(title) + "</h1>\n<p class=\"lead\">" + lead +
         "</p></header>\n<main>\n";
  return out + body + "<footer>" + made + "</footer>\n</main>\n</body>\n</html>\n";
}

std::string report_html(const std::vector<ReportMaterial>& materials, const ReportMeta& meta) {
  std::string body =
      element("section", {{"class", "card"}, {"aria-label", "All materials"}}, table(materials));
  body += how_to_read;
  for (std::size_t i = 0; i < materials.size(); ++i) body += section(materials[i], i);
  std::string made = meta.version.empty() ? "" : "reflectree " + escape(meta.version);
  if (!meta.made.empty()) made += (made.empty() ? "" : " · ") + escape(meta.made);
  if (!meta.command.empty())
    made += (made.empty() ? "" : " · ") + std::string("made by ") + element("code", {}, escape(meta.command));
  return page_html(meta.title, summary(materials), body, made);
}

}  // namespace reflectree::draw
