// SPDX-License-Identifier: Apache-2.0
// Functions of wi over the projected disk, as pixels: (x, y) = (wi.x, wi.y), x towards the viewer's side.
// On this disk equal areas are equal projected solid angles: an exact sampler's dots are as dense as its
// target's colour is bright.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/draw/plot.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::draw {

// Row 0 is at the top, y = 1. NaN outside the disk.
struct DiskImage {
  int size = 0;
  std::vector<float> value;
  float at(double x, double y) const;  // of the pixel that holds a point of the disk
};

// The mean over 2x2 points per pixel of g(wi), for the directions of a row at once.
using DiskFunction = std::function<void(std::span<const Direction> wi, std::span<float> out)>;
DiskImage disk_image(const DiskFunction& g, int size = 340);

// wo = (sin theta_o, 0, cos theta_o); radians.
Direction viewer_at(float theta_o);

// t(wo, wi), sr^-1, without cosine.
DiskImage target_image(const AnyBrdf& f, const Target& target, Direction wo, int size = 340);
// The bound on t that exact mode draws under: albedo * majorant / projected_area, sr^-1.
DiskImage bound_image(const SamplerData& data, Direction wo, int size = 340);
// pdf_disk of one-shot mode, per projected solid angle, times the albedo: comparable with t.
DiskImage one_shot_image(const SamplerData& data, Direction wo, int size = 340);

// A logarithmic range for an image's positive values: at most `decades` below the largest, at least one
// decade around a constant.
Axis log_range(const DiskImage& image, double decades = 5);

// The image in colours as an <image> element of side `side` whose centre is (x, y).
std::string disk_raster(const DiskImage& image, const Axis& range, double x, double y, double side,
                        std::string_view css_class = {}, const Palette& colours = palette());

// The slab of a partition that holds theta_o, at azimuth 0.
std::size_t slab_of(const Partition& partition, Direction wo);

}  // namespace reflectree::draw
