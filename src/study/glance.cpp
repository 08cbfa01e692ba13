// SPDX-License-Identifier: Apache-2.0
// Every material at a glance.
#include <algorithm>

#include "page_parts.hpp"
#include "reflectree/draw/colour_map.hpp"

namespace reflectree::study {

using namespace draw;

namespace {

std::string hex(Rgb8 c) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text = "#";
  for (const unsigned v : {unsigned(c.r), unsigned(c.g), unsigned(c.b)})
    text += {digits[v >> 4U], digits[v & 15U]};
  return text;
}

}  // namespace

void HeatCells::add(double x, double y, double width, double height, double cost_ratio) {
  constexpr double darkest = 1000;
  const double t = std::clamp(1 - std::log(cost_ratio) / std::log(darkest), 0., 1.);
  PathData& cells = cells_[std::size_t(t * steps + 0.5)];
  cells.move_to(x, y), cells.line_to(x + width, y), cells.line_to(x + width, y + height);
  cells.line_to(x, y + height), cells.close();
  numbers_ += label(x + width / 2, y + height / 2 + 4, pretty(cost_ratio, 2), Anchor::middle,
                    t > 0.6 ? "on-pale" : "on-dark");
}

std::string HeatCells::markup() const {
  std::string out;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].empty()) continue;
    const std::string fill = "fill:" + hex(colour(double(i) / steps));
    out += element("path", {{"style", fill}, {"d", cells_[i].text()}}) + "\n";
  }
  return out + numbers_;
}

std::string plain_label(double x, double y, const std::string& text, Anchor anchor, const char* css) {
  const char* where = anchor == Anchor::start ? "" : anchor == Anchor::middle ? "middle" : "end";
  return element("text", {{"class", css}, {"x", number(x, 1)}, {"y", number(y, 1)}, {"text-anchor", where}},
                 escape(text)) +
         "\n";
}

std::string whole(const Figure& figure) {
  const std::string most = "max-width:" + number(figure.width * 1.15, 0) + "px";
  const std::string least = "min-width:" + number(std::min(figure.width, 760.), 0) + "px";
  return element("figure", {{"class", "whole"}, {"style", most}},
                 element("div", {{"style", least}}, inline_svg(figure))) +
         "\n";
}

std::string anchor_of(std::size_t material) { return "material-" + std::to_string(material + 1); }

std::string short_name(const std::string& material) {
  const std::size_t member = material.find('#');
  const auto is_file = [&](const char* ending) {
    return material.find(ending) != std::string::npos && material.find(':') == std::string::npos;
  };
  if (member != std::string::npos && is_file(".csv#")) return material.substr(member + 1);
  if (!is_file(".bsdf") && !is_file(".binary")) return material;
  const std::size_t slash = material.find_last_of('/');
  std::string name = material.substr(slash == std::string::npos ? 0 : slash + 1);
  for (const char* ending : {".bsdf", ".binary", "_rgb"}) {
    if (name.ends_with(ending)) name.resize(name.size() - std::string_view(ending).size());
  }
  return name;
}

Figure glance_figure(std::span<const MaterialResult> materials, const Verdict& v) {
  std::vector<std::string> columns;
  for (const Score& s : v.scores) {
    if (s.materials > 0) columns.push_back(s.sampler);
  }
  constexpr double left = 190, top = 118, wide = 62, high = 19;
  Figure f{left + wide * double(columns.size()) + 70,
           top + high * double(materials.size()) + 8,
           "Every material at a glance",
           "What each sampler costs for the same error, over the best of the row.",
           {}};
  HeatCells cells;
  std::string text;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::string place =
        "translate(" + number(left + wide * (double(k) + 0.5) - 4) + " " + number(top - 8) + ") rotate(-40)";
    text += element("g", {{"transform", place}}, label(0, 0, columns[k], Anchor::start, "label"));
  }
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const double y = top + high * double(i);
    text += element("a", {{"href", "#" + anchor_of(i)}},
                    plain_label(left - 10, y + 13, short_name(materials[i].material), Anchor::end, "label"));
    std::vector<double> cost(columns.size(), 0);
    double best = 1e300;
    for (const SamplerResult& s : materials[i].samplers) {
      const double e = efficiency(s);
      const auto column = std::find(columns.begin(), columns.end(), s.sampler);
      if (!(e > 0) || column == columns.end()) continue;
      cost[std::size_t(column - columns.begin())] = 1 / e;
      best = std::min(best, 1 / e);
    }
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (!(cost[k] > 0)) continue;
      cells.add(left + wide * double(k), y, wide - 1, high - 1, cost[k] / best);
    }
  }
  f.body = cells.markup() + text;
  return f;
}

}  // namespace reflectree::study
