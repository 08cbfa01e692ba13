// SPDX-License-Identifier: Apache-2.0
// What the files of the study's page share.
#pragma once

#include <array>

#include "reflectree/draw/svg.hpp"
#include "reflectree/study/report.hpp"

namespace reflectree::study {

// The classes of a sampler's curve, the same on every figure.
std::string curve_class(const std::string& sampler);
// Of a file the member or the stem: "nbrdf_merl.csv#nickel" is "nickel".
std::string short_name(const std::string& material);
// Of the place in the page's list, from 0.
std::string anchor_of(std::size_t material);

// Filled cells, coloured by what they cost over the best: the best pale, a thousandfold dark.
class HeatCells {
 public:
  // The ratio stands in the middle.
  void add(double x, double y, double width, double height, double cost_ratio);
  std::string markup() const;

 private:
  static constexpr int steps = 40;
  std::array<draw::PathData, steps + 1> cells_;
  std::string numbers_;
};

// A label whose letters mean nothing else: names of files and materials.
std::string plain_label(double x, double y, const std::string& text, draw::Anchor anchor, const char* css);
// A figure across the page, no larger than its letters like.
std::string whole(const draw::Figure& figure);
// Every material by every sampler; each row links to its section.
draw::Figure glance_figure(std::span<const MaterialResult> materials, const Verdict& verdict);
std::string material_section(const MaterialResult& material, std::size_t place, std::size_t of,
                             const Verdict& verdict, std::span<const Illumination> lights,
                             const StudyOptions& options);

}  // namespace reflectree::study
