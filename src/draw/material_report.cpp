// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/material_report.hpp"

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::draw {

ReportFigures figures_of(const SamplerData& data) {
  ReportFigures figures;
  figures.domain = name_of(data.domain.kind);
  figures.exact_slabs = data.exact.size();
  figures.one_shot_slabs = data.one_shot.size();
  bool certified = !data.exact.empty();
  for (const MajorantTree& tree : data.exact) {
    figures.exact_leaves += tree.mass.size();
    certified = certified && tree.status == BoundStatus::certified;
  }
  for (const DensityTree& tree : data.one_shot) figures.one_shot_leaves += tree.mass.size();
  figures.bounds = certified ? "certified" : "estimated";
  figures.mean_trials = double(data.report.expected_trials);
  figures.overshoot_mass = double(data.report.overshoot_mass);
  figures.relative_variance = double(data.report.one_shot_variance);
  return figures;
}

ReportView view_of(const AnyBrdf& f, const SamplerData& data, float theta_o,
                   std::span<const Direction> samples) {
  const Direction wo = viewer_at(theta_o);
  const DiskImage target = target_image(f, data.target, wo);
  return {double(theta_o) * 180 / pi_v<double>,
          {target_figure(target, wo), tree_figure(data, wo, log_range(target)),
           samples_figure(target, wo, samples),
           polar_figure(f, data.target, wo, double(albedo_at(data.albedo, wo.z)), samples)}};
}

ReportMaterial material_report(const AnyBrdf& f, const SamplerData& data, std::span<const float> theta_o,
                               const DrawSamples& draw_samples) {
  const Direction middle = viewer_at(pi / 4);
  ReportMaterial material;
  material.name = data.material;
  material.figures = figures_of(data);
  material.thumbnail = thumbnail_figure(f, data.target, middle);
  for (const float theta : theta_o) {
    const std::vector<Direction> samples = draw_samples(viewer_at(theta));
    material.views.push_back(view_of(f, data, theta, samples));
  }
  material.overview = {slabs_figure(data), square_figure(data, middle)};
  return material;
}

}  // namespace reflectree::draw
