// SPDX-License-Identifier: Apache-2.0
// The lobe in the plane of incidence: as a polar plot whose areas are probabilities (the radius is the root
// of the density), and below it on a log scale, where the tails can be read.
#include <algorithm>
#include <cmath>

#include "disk_frame.hpp"
#include "reflectree/draw/material_figures.hpp"

namespace reflectree::draw {

namespace {

constexpr double deg = pi_v<double> / 180;

}  // namespace

std::string polar_plot(const PlaneLobe& lobe, std::span<const PlaneBar> plane, Direction wo, double highest,
                       double cx, double cy, double radius) {
  std::string out;
  const auto reach = [&](double density) {
    return radius * std::sqrt(std::clamp(density / highest, 0.0, 1.0));
  };
  const Axis densities{0, highest, 0, 1};
  PathData rings, spokes;
  for (const double r : {radius}) {
    rings.move_to(cx - r, cy);
    for (int a = -90; a <= 90; a += 3) rings.line_to(cx + r * std::sin(a * deg), cy - r * std::cos(a * deg));
  }
  std::string ring_labels;
  double last_label = cx;
  for (const Tick& t : ticks(densities, 3)) {
    const double r = reach(t.value);
    if (t.value <= 0) continue;
    rings.move_to(cx - r, cy);
    for (int a = -90; a <= 90; a += 3) rings.line_to(cx + r * std::sin(a * deg), cy - r * std::cos(a * deg));
    if (cx + r - last_label < 24) continue;
    ring_labels += label(cx + r, cy + 14, t.text, Anchor::middle, "tick");
    last_label = cx + r;
  }
  for (int a = -90; a <= 90; a += 30) {
    spokes.move_to(cx, cy);
    spokes.line_to(cx + radius * std::sin(a * deg), cy - radius * std::cos(a * deg));
    const double r = radius + 9;
    const Anchor anchor = a < 0 ? Anchor::end : a > 0 ? Anchor::start : Anchor::middle;
    if (std::abs(a) < 90) {
      out += label(cx + r * std::sin(a * deg), cy - r * std::cos(a * deg) + 3,
                   (a < 0 ? "−" : "") + std::to_string(std::abs(a)) + "°", anchor, "tick");
    }
  }
  out += path(rings, "grid") + path(spokes, "grid") + line(cx - radius, cy, cx + radius, cy, "axis");
  out += ring_labels + label(cx - radius, cy + 14, "density / sr⁻¹", Anchor::start, "tick");
  PathData bars;
  bars.move_to(cx, cy);
  for (const PlaneBar& b : plane) {
    const double r = reach(b.count * b.density_per_count);
    for (int k = 0; k <= 4; ++k) {
      const double a = (b.from_deg + (b.to_deg - b.from_deg) * k / 4) * deg;
      bars.line_to(cx + r * std::sin(a), cy - r * std::cos(a));
    }
  }
  bars.close();
  out += path(bars, "bar");
  PathData outline;
  for (std::size_t i = 0; i < lobe.angle.size(); ++i) {
    const double r = reach(lobe.density[i]), a = lobe.angle[i] * deg;
    if (i == 0) outline.move_to(cx, cy);
    outline.line_to(cx + r * std::sin(a), cy - r * std::cos(a));
  }
  outline.line_to(cx, cy);
  out += path(outline, "curve");
  PathData viewer;
  viewer.move_to(cx, cy);
  const double s = double(wo.x), c = double(wo.z), tip = radius + 4;
  viewer.line_to(cx + tip * s, cy - tip * c);
  viewer.move_to(cx + tip * s - 8 * s - 3.5 * c, cy - tip * c + 8 * c - 3.5 * s);
  viewer.line_to(cx + tip * s, cy - tip * c);
  viewer.line_to(cx + tip * s - 8 * s + 3.5 * c, cy - tip * c + 8 * c + 3.5 * s);
  out += path(viewer, "arrow");
  // Its name stands where there is room: right of a steep arrow, above a flat one.
  const double side = s < 0.8 ? 1 : -1;
  out += label(cx + 0.78 * tip * s + side * 9 * c, cy - 0.78 * tip * c + side * 9 * s, "*ω*_o",
               side > 0 ? Anchor::start : Anchor::end, "label");

  return out;
}

Figure polar_figure(const AnyBrdf& f, const Target& target, Direction wo, double albedo,
                    std::span<const Direction> samples) {
  const PlaneLobe lobe = plane_lobe(f, target, wo, albedo);
  const PlaneHistogram histogram = plane_histogram(samples);
  double highest = 0;
  for (const double d : lobe.density) highest = std::max(highest, d);
  // At most 128 bars of equal probability, each of at least 40 directions.
  double expected = 0;
  for (const double d : lobe.density) {
    if (histogram.samples > 0) expected += d / histogram.density_per_count();
  }
  const std::vector<PlaneBar> plane = plane_bars(histogram, lobe, std::max(40.0, expected / 128));
  for (const PlaneBar& b : plane) highest = std::max(highest, b.count * b.density_per_count);
  if (highest <= 0) highest = 1;

  Figure figure{disk_figure_width, disk_figure_height, "Lobe in the plane of incidence", {}, {}};
  figure.description =
      "The density of light directions within 5 degrees of the plane of incidence: the curve is the target, "
      "the bars are sampled; the highest density is " +
      pretty(highest) + " per steradian.";
  figure.body = disk_heading(figure.title, wo);

  figure.body += polar_plot(lobe, plane, wo, highest, 180, 196, 142);

  // The strip.
  Frame strip;
  strip.x = {-90, 90, 46, 344};
  double lowest = highest;
  for (const double d : lobe.density) lowest = d > 0 ? std::min(lowest, d) : lowest;
  lowest = std::max({lowest, histogram.density_per_count() * 0.05, highest * 1e-6});
  lowest = std::pow(10.0, std::floor(std::log10(std::min(lowest, highest / 10))));
  strip.y = {lowest, highest * 1.6, 360, 250, true};
  strip.x_ticks = ticks_every(strip.x, 30, "°");
  strip.y_ticks = ticks(strip.y, 4);
  strip.x_title = "angle of *ω*_i in the plane; the viewer's side is positive";
  figure.body += frame(strip);
  figure.body += label(46, 244, "the same, log scale", Anchor::start, "note");
  PathData steps, whiskers;
  steps.move_to(strip.x.from, strip.y.from);
  for (const PlaneBar& b : plane) {
    const double left = strip.x.at(b.from_deg), right = strip.x.at(b.to_deg), one = b.density_per_count;
    steps.line_to(left, strip.y.at(b.count * one));
    steps.line_to(right, strip.y.at(b.count * one));
    if (b.count == 0) continue;
    // Two standard deviations of a Poisson count either way.
    const double x = (left + right) / 2, wide = 2 * std::sqrt(b.count);
    whiskers.move_to(x, strip.y.at((b.count + wide) * one));
    whiskers.line_to(x, strip.y.at(std::max(b.count - wide, 0.0) * one));
  }
  steps.line_to(strip.x.to, strip.y.from);
  steps.close();
  figure.body += path(steps, "bar");
  figure.body += path(whiskers, "whisker") + curve(strip, lobe.angle, lobe.density, "curve");
  // The key.
  figure.body += line(206, 240.5, 222, 240.5, "curve") + label(226, 244, "target", Anchor::start, "note");
  figure.body += rectangle(268, 235, 14, 9, "bar") + label(286, 244, "samples ±2*σ*", Anchor::start, "note");
  return figure;
}

}  // namespace reflectree::draw
