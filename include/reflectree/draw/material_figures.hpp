// SPDX-License-Identifier: Apache-2.0
// The pictures of a material for one wo = viewer_at(theta_o): its target over the disk, the exact-mode
// tree over it, samples over it, and the lobe in the plane of incidence under a histogram of samples.
#pragma once

#include <span>

#include "reflectree/draw/disk_image.hpp"
#include "reflectree/draw/figure.hpp"

namespace reflectree::draw {

// t(wo, wi) in sr^-1, log colour.
Figure target_figure(const DiskImage& target, Direction wo);

// The bound of every leaf in the target's units and colours, leaf borders mapped to the disk.
// `range`: of the target's picture, so that colours agree.
Figure tree_figure(const SamplerData& data, Direction wo, const Axis& range);

// At most `shown` of the samples as dots over the pale target.
Figure samples_figure(const DiskImage& target, Direction wo, std::span<const Direction> samples,
                      std::size_t shown = 2500);

// Sampled directions near the plane of incidence (the x-z plane), counted by their angle in it.
struct PlaneHistogram {
  static constexpr int bins = 360;  // over -90..90 degrees
  static constexpr double bin_deg = 180.0 / bins;
  static constexpr double half_width_deg = 5;  // |latitude about the plane|
  std::vector<double> count = std::vector<double>(bins, 0.0);
  double samples = 0;  // all of them, inside the band or not
  // Density per solid angle, sr^-1, of one direction in one bin.
  double density_per_count() const;
};
PlaneHistogram plane_histogram(std::span<const Direction> samples);

// t cos_i / albedo, averaged over a bin of the band; `angle` in degrees, positive on the viewer's side.
struct PlaneLobe {
  std::vector<double> angle, density;  // of each bin: its middle and its mean
};
PlaneLobe plane_lobe(const AnyBrdf& f, const Target& target, Direction wo, double albedo);

// Neighbouring bins together until the lobe expects enough directions in them: narrow at a peak, wide (to
// 10 degrees) in the tails. The counts have no part in the choice, which would bend them.
struct PlaneBar {
  double from_deg, to_deg;
  double count, expected;  // directions
  double density_per_count;
};
std::vector<PlaneBar> plane_bars(const PlaneHistogram& histogram, const PlaneLobe& lobe,
                                 double least_expected);

// Both about (cx, cy) as areas, which are probabilities: the radius is the root of the density, `radius` at
// the density `highest`.
std::string polar_plot(const PlaneLobe& lobe, std::span<const PlaneBar> bars, Direction wo, double highest,
                       double cx, double cy, double radius);

// `albedo` = albedo_at(data.albedo, wo.z).
Figure polar_figure(const AnyBrdf& f, const Target& target, Direction wo, double albedo,
                    std::span<const Direction> samples);

// The target's disk alone, 64 units wide: for tables.
Figure thumbnail_figure(const AnyBrdf& f, const Target& target, Direction wo);

// The square of the domain with the slab's leaves, in colours of the bound on the normalised target.
Figure square_figure(const SamplerData& data, Direction wo);

// Leaves of every slab of theta_o, exact and one-shot.
Figure slabs_figure(const SamplerData& data);

// The borders between leaves as curves on the disk of radius `radius` about (x, y); `background` chooses
// light or dark strokes.
std::string cell_borders(const std::vector<TreeSplit>& nodes, const Domain& domain, Direction wo, double x,
                         double y, double radius, const DiskImage& background, const Axis& range);

}  // namespace reflectree::draw
