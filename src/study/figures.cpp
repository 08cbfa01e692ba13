// SPDX-License-Identifier: Apache-2.0
// The figures of the study's page.
#include <algorithm>
#include <array>

#include "reflectree/draw/plot.hpp"
#include "reflectree/study/report.hpp"

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
// The cell whose theta_o is nearest to that of the curves.
std::size_t nearest_to_the_curves(const StudyOptions& o) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < o.theta_o_deg.size(); ++i) {
    if (std::abs(o.theta_o_deg[i] - curve_theta_o_deg) < std::abs(o.theta_o_deg[best] - curve_theta_o_deg))
      best = i;
  }
  return best;
}

}  // namespace

Figure error_figure(const MaterialResult& m, std::size_t light, const std::string& light_name,
                    const StudyOptions& o, bool over_time) {
  struct Line {
    std::string name;
    std::vector<double> x, y;
  };
  std::vector<Line> lines;
  const std::size_t at = nearest_to_the_curves(o);
  double x0 = 1e300, x1 = 0, y0 = 1e300, y1 = 0;
  const auto add = [&](const std::string& name, const SamplerResult& s, std::span<const std::uint32_t> n,
                       const auto& square) {
    const double us = over_time ? s.cells[at].sample_ns * 1e-3 : 1;
    Line line{name, {}, {}};
    for (std::size_t i = 0; i < n.size(); ++i) {
      const double y = std::sqrt(square(i)), x = n[i] * us;
      if (!(y > 0)) continue;
      line.x.push_back(x), line.y.push_back(y);
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    if (!line.x.empty()) lines.push_back(std::move(line));
  };
  constexpr std::array<std::uint32_t, 8> steps{1, 4, 16, 64, 256, 1024, 4096, 16384};
  for (const SamplerResult& s : m.samplers) {
    if (at >= s.cells.size() || light >= s.cells[at].error.size()) continue;
    const Cell& cell = s.cells[at];
    const double bias = sqr(cell.sure_bias()), one = cell.error[light] - o.mean_of * bias;
    add(s.sampler, s, steps, [&](std::size_t i) { return one / steps[i] + bias; });
    if (s.sampler != "one-shot-monotone" || light >= s.curves.size()) continue;
    // Of stratified points there is but what was measured, and nothing where the rotations seldom hit the
    // light: there random points miss their own variance, too.
    const ErrorCurve& c = s.curves[light];
    if (c.n.empty() || !(std::abs(std::log(c.random[0] / one)) < std::log(2.))) continue;
    add(s.sampler + " Sobol'", s, c.n, [&](std::size_t i) { return c.stratified[i]; });
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
           30 + 20. * double(rows.size()),
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

}  // namespace reflectree::study
