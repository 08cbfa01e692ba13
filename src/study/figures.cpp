// SPDX-License-Identifier: Apache-2.0
// The figures of the study's page.
#include <algorithm>
#include <array>

#include "page_parts.hpp"
#include "reflectree/draw/plot.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

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

// By the place in the registry: ours heavy and blue, the others in six hues with three dashes.
std::string curve_class(const std::string& name) {
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
    const StudyCell& cell = s.cells[at];
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
  constexpr double apart = 13, lowest = 344;
  std::vector<double> label_y;
  for (const Line& line : lines)
    label_y.push_back(std::max(label_y.empty() ? 26 : label_y.back() + apart, axes.y.at(line.y.back()) + 4));
  for (std::size_t i = lines.size(); i-- > 0;)
    label_y[i] = std::min(label_y[i], i + 1 < lines.size() ? label_y[i + 1] - apart : lowest);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    const double y = label_y[i];
    f.body += curve(axes, line.x, line.y, curve_class(line.name));
    f.body += label(430, y, line.name, Anchor::start, "tick");
    f.body += draw::line(axes.x.at(line.x.back()), axes.y.at(line.y.back()), 398, y - 4, "grid") +
              draw::line(400, y - 4, 424, y - 4, curve_class(line.name));
  }
  return f;
}

Figure bar_figure(const std::string& title, const std::string& unit, std::span<const Bar> bars,
                  bool largest_first) {
  std::vector<Bar> shown;
  for (const Bar& b : bars) {
    if (b.value > 0) shown.push_back(b);
  }
  std::sort(shown.begin(), shown.end(), [&](const Bar& a, const Bar& b) {
    return largest_first ? a.value > b.value : a.value < b.value;
  });
  Figure f{520, 62 + 20. * double(shown.size()), title, "Bars on a log scale, the best first.", {}};
  if (shown.empty()) return f;
  const auto [least, most] = std::minmax(shown.front().value, shown.back().value);
  const double lo = std::pow(10, std::floor(std::log10(least)) - 0.2), hi = most * 1.3;
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

Figure heat_figure(const MaterialResult& m, std::span<const Illumination> lights, const StudyOptions& o) {
  std::vector<const SamplerResult*> rows;
  for (const SamplerResult& s : m.samplers) {
    if (s.cells.size() == o.theta_o_deg.size()) rows.push_back(&s);
  }
  constexpr double left = 132, wide = 66, high = 20, top = 46, gap = 14;
  const std::size_t angles = o.theta_o_deg.size();
  Figure f{left + wide * double(angles + lights.size()) + gap + 6,
           top + high * double(rows.size()) + 8,
           "Cost against the best",
           "RMSE squared times time of each sampler, by angle and by light.",
           {}};
  const auto cost = [](const StudyCell& c, std::size_t e) {
    return std::log(c.error[e] * c.sample_ns / c.floor_ns);
  };
  HeatCells cells;
  std::string text =
      label(left, 14, "by *θ*_o, mean over lights", Anchor::start, "note") +
      label(left + wide * double(angles) + gap, 14, "by light, mean over *θ*_o", Anchor::start, "note");
  for (std::size_t k = 0; k < rows.size(); ++k)
    text += label(left - 6, top + high * double(k) + 14, rows[k]->sampler, Anchor::end, "tick");
  for (std::size_t column = 0; column < angles + lights.size(); ++column) {
    const bool by_angle = column < angles;
    const double x = left + wide * double(column) + (by_angle ? 0 : gap);
    text += plain_label(
        x + wide / 2, top - 8,
        by_angle ? number(o.theta_o_deg[column]) + "°" : lights[column - angles].name.substr(0, 11),
        Anchor::middle, "tick");
    std::vector<double> mean(rows.size(), 0);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::size_t n = by_angle ? lights.size() : angles;
      for (std::size_t j = 0; j < n; ++j)
        mean[k] += by_angle ? cost(rows[k]->cells[column], j) / double(n)
                            : cost(rows[k]->cells[j], column - angles) / double(n);
    }
    const double best = mean.empty() ? 0 : *std::min_element(mean.begin(), mean.end());
    for (std::size_t k = 0; k < rows.size(); ++k)
      cells.add(x, top + high * double(k), wide - 1, high - 1, std::exp(mean[k] - best));
  }
  f.body = cells.markup() + text;
  return f;
}

}  // namespace reflectree::study
