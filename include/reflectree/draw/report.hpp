// SPDX-License-Identifier: Apache-2.0
// One offline page about samplers of materials: a table of figures, then each material's pictures.
// Everything is inline; nothing is fetched and no script runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "reflectree/draw/figure.hpp"

namespace reflectree::draw {

// What chi-square said of a material's samples.
struct ChiSquareVerdict {
  bool passed = false;
  int tests = 0;
  double smallest_p = 1;
};

// What was not measured stays empty and is shown as a dash.
struct ReportFigures {
  std::string domain, bounds;  // name_of(domain.kind); "estimated" or "certified"
  std::size_t exact_slabs = 0, one_shot_slabs = 0, exact_leaves = 0, one_shot_leaves = 0;
  std::optional<double> kib, build_seconds, mean_trials, overshoot_mass;
  std::optional<double> exact_ns, one_shot_ns, relative_variance;
  std::optional<ChiSquareVerdict> chi_square;
};

// The pictures at one theta_o.
struct ReportView {
  double theta_o_deg = 0;
  std::vector<Figure> pictures;
};

struct ReportMaterial {
  std::string name;    // as a person wrote it
  std::string origin;  // a model, a measured file: a few words
  ReportFigures figures;
  std::optional<Figure> thumbnail;
  std::vector<ReportView> views;
  std::vector<Figure> overview;  // figures that hold for every theta_o: slabs, the square
};

struct ReportMeta {
  std::string title = "Reflectree";
  std::string command;  // that made the page
  std::string version;
  std::string made;  // date and machine, as the caller likes it; may be empty
};

// The frame of every page; the title plain text, the rest markup.
std::string page_html(const std::string& title, const std::string& lead, const std::string& body,
                      const std::string& made);

std::string report_html(const std::vector<ReportMaterial>& materials, const ReportMeta& meta);

}  // namespace reflectree::draw
