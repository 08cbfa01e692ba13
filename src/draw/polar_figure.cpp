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

// In-plane angle (from the normal, positive towards +x) and latitude about the x-z plane.
Direction in_plane(double angle, double latitude) {
  const double c = std::cos(latitude);
  return {float(c * std::sin(angle)), float(std::sin(latitude)), float(c * std::cos(angle))};
}

}  // namespace

double PlaneHistogram::density_per_count() const {
  // Solid angle of a bin: the integral of cos(latitude) over the band times the angle.
  const double solid_angle = 2 * std::sin(half_width_deg * deg) * bin_deg * deg;
  return samples > 0 ? 1 / (samples * solid_angle) : 0;
}
double PlaneHistogram::density(int bin) const { return count[std::size_t(bin)] * density_per_count(); }

PlaneHistogram plane_histogram(std::span<const Direction> samples) {
  PlaneHistogram h;
  h.samples = double(samples.size());
  const double limit = std::sin(PlaneHistogram::half_width_deg * deg);
  for (const Direction& wi : samples) {
    if (std::abs(double(wi.y)) > limit || wi.z < 0) continue;
    const double angle = std::atan2(double(wi.x), double(wi.z)) / deg;
    const int bin = std::clamp(int((angle + 90) / PlaneHistogram::bin_deg), 0, PlaneHistogram::bins - 1);
    h.count[std::size_t(bin)] += 1;
  }
  return h;
}

PlaneLobe plane_lobe(const AnyBrdf& f, const Target& target, Direction wo, double albedo) {
  constexpr int across = 24, fine = 2, steps = 5 * PlaneHistogram::bins;  // points: 0.25 degrees apart
  const int channels = f.channels();
  std::vector<Direction> same, wi;
  std::vector<double> weight;
  for (int i = 0; i < steps * fine; ++i) {
    for (int k = 0; k < across; ++k) {
      const double latitude = PlaneHistogram::half_width_deg * deg * ((k + 0.5) * 2 / across - 1);
      wi.push_back(in_plane(((i + 0.5) / (steps * fine) - 0.5) * pi_v<double>, latitude));
      weight.push_back(std::cos(latitude));
    }
  }
  same.assign(wi.size(), wo);
  std::vector<float> values(wi.size() * std::size_t(channels));
  f.eval(same, wi, values);
  PlaneLobe lobe;
  for (int i = 0; i < steps; ++i) {
    double sum = 0, weights = 0;
    for (int k = 0; k < fine * across; ++k) {
      const auto j = std::size_t(i * fine * across + k);
      sum +=
          weight[j] * double(target(values.data() + j * std::size_t(channels), channels)) * double(wi[j].z);
      weights += weight[j];
    }
    lobe.angle.push_back(((i + 0.5) / steps - 0.5) * 180);
    lobe.density.push_back(albedo > 0 ? sum / weights / albedo : 0);
  }
  return lobe;
}

Figure polar_figure(const AnyBrdf& f, const Target& target, Direction wo, double albedo,
                    std::span<const Direction> samples) {
  const PlaneLobe lobe = plane_lobe(f, target, wo, albedo);
  const PlaneHistogram histogram = plane_histogram(samples);
  double highest = 0;
  for (const double d : lobe.density) highest = std::max(highest, d);
  for (int b = 0; b < PlaneHistogram::bins; ++b) highest = std::max(highest, histogram.density(b));
  if (highest <= 0) highest = 1;

  Figure figure{disk_figure_width, disk_figure_height, "Lobe in the plane of incidence", {}, {}};
  figure.description =
      "The density of light directions within 5 degrees of the plane of incidence: the curve is the target, "
      "the bars are sampled; the highest density is " +
      pretty(highest) + " per steradian.";
  figure.body = disk_heading(figure.title, wo);

  // The polar plot.
  const double cx = 180, cy = 196, radius = 142;
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
      figure.body += label(cx + r * std::sin(a * deg), cy - r * std::cos(a * deg) + 3,
                           (a < 0 ? "−" : "") + std::to_string(std::abs(a)) + "°", anchor, "tick");
    }
  }
  figure.body += path(rings, "grid") + path(spokes, "grid") + line(cx - radius, cy, cx + radius, cy, "axis");
  figure.body += ring_labels + label(cx - radius, cy + 14, "density / sr⁻¹", Anchor::start, "tick");
  PathData bars;
  bars.move_to(cx, cy);
  for (int b = 0; b < PlaneHistogram::bins; ++b) {
    const double r = reach(histogram.density(b));
    for (int k = 0; k <= 2; ++k) {
      const double a = (-90 + (b + 0.5 * k) * PlaneHistogram::bin_deg) * deg;
      bars.line_to(cx + r * std::sin(a), cy - r * std::cos(a));
    }
  }
  bars.close();
  figure.body += path(bars, "bar");
  PathData outline;
  for (std::size_t i = 0; i < lobe.angle.size(); ++i) {
    const double r = reach(lobe.density[i]), a = lobe.angle[i] * deg;
    if (i == 0) outline.move_to(cx, cy);
    outline.line_to(cx + r * std::sin(a), cy - r * std::cos(a));
  }
  outline.line_to(cx, cy);
  figure.body += path(outline, "curve");
  PathData viewer;
  viewer.move_to(cx, cy);
  const double s = double(wo.x), c = double(wo.z), tip = radius + 4;
  viewer.line_to(cx + tip * s, cy - tip * c);
  viewer.move_to(cx + tip * s - 8 * s - 3.5 * c, cy - tip * c + 8 * c - 3.5 * s);
  viewer.line_to(cx + tip * s, cy - tip * c);
  viewer.line_to(cx + tip * s - 8 * s + 3.5 * c, cy - tip * c + 8 * c + 3.5 * s);
  figure.body += path(viewer, "arrow");
  figure.body +=
      label(cx + 0.78 * tip * s + 9 * c, cy - 0.78 * tip * c + 11 * s, "*ω*_o", Anchor::start, "label");

  // The strip.
  Frame strip;
  strip.x = {-90, 90, 46, 344};
  double lowest = highest;
  for (const double d : lobe.density) lowest = d > 0 ? std::min(lowest, d) : lowest;
  lowest = std::max({lowest, histogram.density_per_count() * 0.5, highest * 1e-6});
  lowest = std::pow(10.0, std::floor(std::log10(std::min(lowest, highest / 10))));
  strip.y = {lowest, highest * 1.6, 360, 250, true};
  strip.x_ticks = ticks_every(strip.x, 30, "°");
  strip.y_ticks = ticks(strip.y, 4);
  strip.x_title = "angle of *ω*_i in the plane; the viewer's side is positive";
  figure.body += frame(strip);
  figure.body += label(46, 244, "the same, log scale", Anchor::start, "note");
  PathData steps, whiskers;
  steps.move_to(strip.x.from, strip.y.from);
  const double one = histogram.density_per_count();
  for (int b = 0; b < PlaneHistogram::bins; ++b) {
    const double n = histogram.count[std::size_t(b)];
    const double left = strip.x.at(-90 + b * PlaneHistogram::bin_deg);
    const double right = strip.x.at(-90 + (b + 1) * PlaneHistogram::bin_deg);
    steps.line_to(left, strip.y.at(n * one));
    steps.line_to(right, strip.y.at(n * one));
    if (n == 0) continue;
    // Two standard deviations of a Poisson count either way.
    const double x = (left + right) / 2, wide = 2 * std::sqrt(n);
    whiskers.move_to(x, strip.y.at((n + wide) * one));
    whiskers.line_to(x, strip.y.at(std::max(n - wide, 0.0) * one));
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

Figure slabs_figure(const SamplerData& data) {
  const double width = 560;
  Figure figure{width, 300, "Slabs of *θ*_o and their leaves", {}, {}};
  std::size_t most = 1;
  for (const MajorantTree& t : data.exact) most = std::max(most, t.mass.size());
  for (const DensityTree& t : data.one_shot) most = std::max(most, t.mass.size());
  Frame f;
  f.x = {0, 90, 54, width - 16};
  f.y = {1, std::max(10.0, 1.5 * double(most)), 232, 52, true};
  f.x_ticks = ticks_every(f.x, 15, "°");
  f.y_ticks = ticks(f.y, 4);
  f.x_title = "*θ*_o of the viewer";
  figure.body = label(16, 24, figure.title, Anchor::start, "head");
  figure.title = "Slabs of theta_o and their leaves";
  figure.body += frame(f);
  const auto steps = [&](const Partition& partition, const auto& trees, const char* fill,
                         const char* stroke) {
    const std::vector<SlabBox> boxes = slab_boxes(partition);
    PathData outline;
    for (std::size_t i = 0; i < trees.size(); ++i) {
      const double x0 = f.x.at(double(boxes[i].lo[0]) / deg), x1 = f.x.at(double(boxes[i].hi[0]) / deg);
      const double y = f.y.at(double(trees[i].mass.size()));
      figure.body += rectangle(x0, y, x1 - x0, f.y.from - y, fill);
      outline.move_to(x0, f.y.from);
      outline.line_to(x0, y);
      outline.line_to(x1, y);
      outline.line_to(x1, f.y.from);
    }
    figure.body += path(outline, stroke);
  };
  steps(data.exact_partition, data.exact, "fill-1", "curve-thin");
  steps(data.one_shot_partition, data.one_shot, "fill-2", "bar-line");
  figure.body +=
      rectangle(54, 276, 14, 9, "fill-1") +
      label(73, 285, "exact: " + std::to_string(data.exact.size()) + " slabs", Anchor::start, "note") +
      rectangle(194, 276, 14, 9, "fill-2") +
      label(213, 285, "one-shot: " + std::to_string(data.one_shot.size()) + " slabs", Anchor::start, "note") +
      label(54, 44, "leaves of the slab's tree", Anchor::start, "note");
  figure.description =
      std::to_string(data.exact.size()) + " exact and " + std::to_string(data.one_shot.size()) +
      " one-shot slabs over the viewer's elevation; bars give the leaves of each slab's tree.";
  return figure;
}

}  // namespace reflectree::draw
