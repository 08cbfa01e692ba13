// SPDX-License-Identifier: Apache-2.0
// The study as one offline page: verdict, bars, and every material's curves and heat maps.
#pragma once

#include "reflectree/draw/figure.hpp"
#include "reflectree/study/verdict.hpp"

namespace reflectree::study {

struct StudyMeta {
  std::string command, version, machine, commit;
};

std::string study_html(std::span<const MaterialResult> materials, const Verdict& verdict,
                       std::span<const Illumination> lights, const StudyOptions& options,
                       const StudyMeta& meta);

// RMSE over samples, or over time (microseconds), both logarithmic, at the theta_o nearest to 45 degrees:
// one curve per sampler, labelled at its end. Random points follow the law var / n + bias^2 of the cell,
// stratified ones what was measured.
draw::Figure error_figure(const MaterialResult& material, std::size_t light, const std::string& light_name,
                          const StudyOptions& options, bool over_time);
// One number per sampler on a log scale; those not above 0 are left out.
struct Bar {
  std::string name;
  double value = 0;
  bool ours = false;
};
draw::Figure bar_figure(const std::string& title, const std::string& unit, std::span<const Bar> bars,
                        bool largest_first = false);
// Samplers down; across, theta_o averaged over lights, then lights averaged over theta_o, by geometric means;
// the relative RMSE^2 times time, over the best of its column.
draw::Figure heat_figure(const MaterialResult& material, std::span<const Illumination> lights,
                         const StudyOptions& options);
// In the plane of incidence, one panel per theta_o.
draw::Figure slice_figure(const MaterialResult& material, const StudyOptions& options);

}  // namespace reflectree::study
