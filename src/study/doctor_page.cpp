// SPDX-License-Identifier: Apache-2.0
#include "reflectree/study/doctor_page.hpp"

#include <cmath>

#include "reflectree/draw/disk_image.hpp"
#include "reflectree/draw/report.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

std::string cell(const std::string& text) { return element("td", {}, text); }
std::string word(const std::string& text) { return element("td", {{"class", "word"}}, text); }

std::string badge(bool good, const std::string& text) {
  return element("span", {{"class", good ? "verdict pass" : "verdict fail"}}, escape(text));
}

std::string pair_text(const Evidence& e) {
  const auto vector = [](Direction w) {
    return "(" + number(double(w.x), 6) + ", " + number(double(w.y), 6) + ", " + number(double(w.z), 6) + ")";
  };
  if (e.wo.x == 0 && e.wo.y == 0 && e.wo.z == 0) return "";
  std::string text = "wo " + vector(e.wo) + (e.wi == Direction{} ? "" : ", wi " + vector(e.wi));
  if (!e.quantity.empty())
    text += ": " + e.quantity + " is " + pretty(e.found, 6) + ", expected " + pretty(e.expected, 6);
  return text;
}

std::string findings_section(const Diagnosis& d) {
  std::string out = "<section class=\"card\"><h2>Findings</h2>";
  if (d.findings.empty()) out += "<p>None.</p>";
  for (const Finding& f : d.findings) {
    std::string figures;
    for (const VerifyFigure& x : f.figures) {
      figures += (figures.empty() ? "" : "; ") + x.name + " " + pretty(x.value, 5) +
                 (x.where.empty() ? "" : " at " + x.where);
    }
    out += "<h3>" + badge(!f.fault, f.fault ? "fault" : "remark") + " " + escape(f.words) +
           "</h3><p class=\"origin\">check " + escape(f.check) + ", cause " +
           element("code", {}, escape(f.cause)) + (figures.empty() ? "" : "; " + escape(figures)) + "</p>";
    const std::string pair = pair_text(f.evidence);
    if (!pair.empty()) out += "<p>" + element("code", {}, escape(pair)) + "</p>";
  }
  return out + "</section>\n";
}

// How many directions fell into each bin over how many pdf promises there, or f where there is no pdf.
Figure ratio_figure(const DoctorView& view) {
  constexpr double side = 300, centre = 160;
  const bool has_pdf = !view.pdf_mass.empty();
  double f_total = 0;
  for (const double m : view.f_mass) f_total += m;
  const auto ratio = [&](std::size_t b) {
    const double expected = view.draws * (has_pdf       ? view.pdf_mass[b]
                                          : f_total > 0 ? view.f_mass[b] / f_total
                                                        : 0);
    if (!(expected > 0)) return view.count[b] > 0 ? 4. : 1.;
    return std::max(view.count[b] / expected, 1e-3);
  };
  const DiskImage image = disk_image(
      [&](std::span<const Direction> wi, std::span<float> out) {
        for (std::size_t i = 0; i < wi.size(); ++i) out[i] = float(ratio(view.bins.find(wi[i])));
      },
      240);
  const Axis range{0.5, 2, 0, 1, true};
  const double theta = double(theta_of(view.wo)) * 180 / pi_v<double>;
  Figure figure{320,
                380,
                "Directions at " + number(theta, 3) + "°",
                "How often directions fell into each bin over how often pdf promises, for a view at " +
                    number(theta, 3) + " degrees.",
                {}};
  figure.body = label(10, 20, figure.title, Anchor::start, "title");
  figure.body += disk_raster(image, range, centre, centre + 30, side, {}, diverging_palette());
  figure.body += circle(centre, centre + 30, side / 2, "rim");
  figure.body +=
      circle(centre + side / 2 * double(view.wo.x), centre + 30 - side / 2 * double(view.wo.y), 4, "mark");
  figure.body += colour_bar(
      {{0.5, 2, 40, 280, true}, centre + 30 + side / 2 + 8, 8, "drawn over promised", &diverging_palette()});
  return figure;
}

std::string views_section(const Diagnosis& d) {
  std::string out =
      "<section class=\"card\"><h2>Where directions fall</h2><p class=\"origin\">Disks hold all directions "
      "of light, "
      "projected straight down; the dot is the viewer. Each bin shows how many directions fell there over "
      "how many "
      "the pdf promises (or f, where there is no pdf); pale is right.</p><div class=\"pictures\">";
  for (const DoctorView& v : d.views) {
    if (!v.count.empty()) out += "<figure>" + inline_svg(ratio_figure(v)) + "</figure>\n";
  }
  return out + "</div></section>\n";
}

std::string tables(const Diagnosis& d) {
  std::string out =
      "<section class=\"card\"><h2>Quality</h2><div class=\"scroll\"><table><thead><tr><th>figure</th><th "
      "class=\"word\">at</th><th>value</th></tr></thead><tbody>";
  for (const VerifyFigure& f : d.figures)
    out += "<tr>" + element("th", {}, escape(f.name)) + word(escape(f.where)) + cell(pretty(f.value, 4)) +
           "</tr>\n";
  out +=
      "</tbody></table></div></section>\n<section class=\"card\"><h2>Checks</h2><div "
      "class=\"scroll\"><table><thead><tr><th>check</th>"
      "<th class=\"word\">at</th><th class=\"word\">verdict</th><th>statistic</th><th>limit</th><th "
      "class=\"word\">what</th></tr></thead><tbody>";
  for (const CheckResult& c : d.checks) {
    out += "<tr>" + element("th", {}, escape(c.name)) + word(escape(c.where)) +
           word(badge(c.passed, c.passed ? "holds" : "fails")) + cell(pretty(c.statistic, 4)) +
           cell(pretty(c.threshold, 4)) + word(escape(c.detail)) + "</tr>\n";
  }
  return out + "</tbody></table></div></section>\n";
}

}  // namespace

std::string doctor_html(const Diagnosis& d, const StudyMeta& meta) {
  std::string conventions;
  for (const std::string& c : d.conventions) conventions += (conventions.empty() ? "" : "; ") + c;
  const std::string lead =
      badge(d.healthy(), d.healthy() ? "healthy" : "not healthy") + " " + escape(conventions) + ".";
  const std::string made =
      "reflectree " + escape(meta.version) + " · made by " + element("code", {}, escape(meta.command));
  return page_html("Diagnosis of " + d.subject, lead, findings_section(d) + views_section(d) + tables(d),
                   made);
}

}  // namespace reflectree::study
