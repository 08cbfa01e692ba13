// SPDX-License-Identifier: Apache-2.0
#include "reflectree/study/report.hpp"

#include <algorithm>

#include "reflectree/draw/plot.hpp"
#include "reflectree/draw/report.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

// By the place in the registry, so that a sampler looks the same on every figure: ours heavy and blue, the
// others in six hues with three dashes.
std::string css(const std::string& name) {
  std::size_t ours = 0, others = 0;
  for (const SamplerInfo& info : samplers()) {
    std::size_t& count = is_ours(info) ? ours : others;
    if (info.name == name) {
      return is_ours(info) ? "ours dash-" + std::to_string(ours % 3)
                           : "hue-" + std::to_string(others % 6) + " dash-" + std::to_string(others / 6 % 3);
    }
    ++count;
  }
  return "curve-2";  // of stratified points
}
std::string hex(Rgb8 c) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text = "#";
  for (const unsigned v : {unsigned(c.r), unsigned(c.g), unsigned(c.b)})
    text += {digits[v >> 4U], digits[v & 15U]};
  return text;
}
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
      out += "<figure>" + inline_svg(error_figure(m, e, lights[e].name, over_time)) + "</figure>";
    }
    out += "<figure>" + inline_svg(heat_figure(m, e, lights[e].name, o)) + "</figure>";
  }
  return out + "</div><details><summary>Every figure</summary>" + material_table(m, o) +
         "</details></section>\n";
}

}  // namespace

Figure error_figure(const MaterialResult& m, std::size_t light, const std::string& light_name,
                    bool over_time) {
  struct Line {
    std::string name;
    std::vector<double> x, y;
  };
  std::vector<Line> lines;
  double x0 = 1e300, x1 = 0, y0 = 1e300, y1 = 0;
  for (const SamplerResult& s : m.samplers) {
    if (light >= s.curves.size() || s.cells.empty()) continue;
    const ErrorCurve& c = s.curves[light];
    const double us = over_time ? s.cells[s.cells.size() / 2].sample_ns * 1e-3 : 1;
    for (const bool stratified : {false, true}) {
      if (stratified && s.sampler != "one-shot-monotone") continue;
      Line line{s.sampler + (stratified ? " Sobol'" : ""), {}, {}};
      for (std::size_t i = 0; i < c.n.size(); ++i) {
        const double y = std::sqrt((stratified ? c.stratified : c.random)[i]), x = c.n[i] * us;
        line.x.push_back(x), line.y.push_back(y);
        if (!(y > 0)) continue;
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
      }
      lines.push_back(std::move(line));
    }
  }
  Figure f{570,
           360,
           std::string("Error over ") + (over_time ? "time" : "samples") + ", " + light_name,
           "Relative RMSE of reflected radiance, logarithmic axes.",
           {}};
  if (!(x1 > x0) || !(y1 > y0)) return f;
  draw::Frame axes;
  axes.x = {x0, x1, 52, 380, true}, axes.y = {y0 / 1.2, y1 * 1.2, 310, 34, true};
  axes.x_ticks = ticks(axes.x), axes.y_ticks = ticks(axes.y);
  axes.x_title = over_time ? "microseconds" : "samples";
  axes.y_title = "relative RMSE, " + light_name;
  f.body = frame(axes);
  // Labels at the curves' ends, pushed apart.
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.y.back() > b.y.back(); });
  double label_y = 26;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    f.body += curve(axes, line.x, line.y, css(line.name));
    label_y = std::max(label_y + 13, axes.y.at(line.y.back()) + 4);
    f.body += label(430, label_y, line.name, Anchor::start, "tick");
    f.body += draw::line(axes.x.at(line.x.back()), axes.y.at(line.y.back()), 398, label_y - 4, "grid") +
              draw::line(400, label_y - 4, 424, label_y - 4, css(line.name));
  }
  f.height = std::max(360., label_y + 14);
  return f;
}

Figure bar_figure(const std::string& title, const std::string& unit, std::span<const Bar> bars) {
  std::vector<Bar> shown;
  for (const Bar& b : bars) {
    if (b.value > 0) shown.push_back(b);
  }
  std::sort(shown.begin(), shown.end(), [](const Bar& a, const Bar& b) { return a.value < b.value; });
  Figure f{520, 62 + 20. * double(shown.size()), title, "Bars on a log scale, smallest first.", {}};
  if (shown.empty()) return f;
  const double lo = std::pow(10, std::floor(std::log10(shown.front().value)) - 0.2),
               hi = shown.back().value * 1.3;
  const double bottom = f.height - 40;
  draw::Frame axes;
  axes.x = {lo, hi, 140, 450, true}, axes.y = {0, 1, bottom, 18};
  axes.x_ticks = ticks(axes.x);
  axes.x_title = title + ", " + unit;
  f.body = frame(axes);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double y = 22 + 20 * double(i), x = axes.x.at(shown[i].value);
    f.body += rectangle(140, y, x - 140, 14, shown[i].ours ? "fill-strong" : "bar");
    f.body += label(134, y + 11, shown[i].name, Anchor::end, "tick") +
              label(x + 5, y + 11, pretty(shown[i].value), Anchor::start, "tick");
  }
  return f;
}

Figure heat_figure(const MaterialResult& m, std::size_t light, const std::string& light_name,
                   const StudyOptions& o) {
  std::vector<const SamplerResult*> rows;
  for (const SamplerResult& s : m.samplers) {
    if (!s.cells.empty()) rows.push_back(&s);
  }
  Figure f{540,
           60 + 20. * double(rows.size()),
           "Cost against the best, " + light_name,
           "RMSE squared times time of each sampler and angle, over the best sampler at that angle.",
           {}};
  constexpr double left = 140, darkest = 1000;
  const double width = 360 / double(std::max<std::size_t>(o.theta_o_deg.size(), 1));
  for (std::size_t i = 0; i < o.theta_o_deg.size(); ++i) {
    const double x = left + width * double(i);
    f.body += label(x + width / 2, 16, number(o.theta_o_deg[i]) + "°", Anchor::middle, "tick");
    double best = 1e300;
    const auto cost = [&](const SamplerResult* s) {
      return s->cells[i].error[light] * s->cells[i].sample_ns / s->cells[i].floor_ns;
    };
    for (const SamplerResult* s : rows) best = std::min(best, cost(s));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double ratio = cost(rows[k]) / best, y = 24 + 20 * double(k);
      const double t = std::clamp(1 - std::log(ratio) / std::log(darkest), 0., 1.);
      f.body += element("rect", {{"x", number(x)},
                                 {"y", number(y)},
                                 {"width", number(width - 2)},
                                 {"height", "18"},
                                 {"fill", hex(colour(t))}}) +
                "\n";
      f.body += label(x + width / 2, y + 13, "× " + pretty(ratio, 2), Anchor::middle, "over");
      if (i == 0) f.body += label(left - 6, y + 13, rows[k]->sampler, Anchor::end, "tick");
    }
  }
  return f;
}

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
