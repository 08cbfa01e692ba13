// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/material_figures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/math/random.hpp"
#include "toy_sampler.hpp"
#include "xml_check.hpp"

namespace reflectree::draw {
namespace {

constexpr float degree = pi / 180;

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t i = text.find(part); i != text.npos; i = text.find(part, i + 1)) ++n;
  return n;
}

// Numbers that no drawing can show, outside the pixels.
bool has_broken_number(std::string svg) {
  for (std::size_t i = svg.find("base64,"); i != svg.npos; i = svg.find("base64,", i)) {
    svg.erase(i, svg.find('"', i) - i);
  }
  return svg.find("nan") != svg.npos || svg.find("\"inf") != svg.npos || svg.find("-inf") != svg.npos;
}

std::vector<Direction> cosine_directions(std::size_t n) {
  std::vector<Direction> out;
  Pcg32 random(11);
  for (std::size_t i = 0; i < n; ++i) {
    const float r = std::sqrt(to_unit_float(random())), a = 2 * pi * to_unit_float(random());
    out.push_back({r * std::cos(a), r * std::sin(a), std::sqrt(1 - r * r)});
  }
  return out;
}

TEST(PlaneHistogram, CountsByTheAngleInThePlane) {
  std::vector<Direction> samples;
  for (int i = 0; i < 3; ++i) samples.push_back(viewer_at(31.2f * degree));   // bin 242: 31 to 31.5
  for (int i = 0; i < 2; ++i) samples.push_back(viewer_at(-89.7f * degree));  // bin 0
  samples.push_back(direction_from_angles(40 * degree, 90 * degree));         // far from the plane
  samples.push_back({std::sin(31 * degree), 0, -std::cos(31 * degree)});      // below the surface
  const PlaneHistogram h = plane_histogram(samples);
  EXPECT_EQ(h.count[242], 3);
  EXPECT_EQ(h.count[0], 2);
  double sum = 0;
  for (const double n : h.count) sum += n;
  EXPECT_EQ(sum, 5);
  // One of 7 over 2 sin 5° times 0.5°.
  const double solid_angle = 2 * std::sin(5 * pi_v<double> / 180) * 0.5 * pi_v<double> / 180;
  EXPECT_NEAR(h.density_per_count(), 1 / (7 * solid_angle), 1e-9);
}

TEST(PlaneLobe, LambertIsTheCosine) {
  const PlaneLobe lobe = plane_lobe(Lambert{{1, 1, 1}}, {}, viewer_at(0.3f), std::sqrt(3.0));
  for (std::size_t i = 0; i < lobe.angle.size(); ++i) {
    // Mean of cos(latitude)^2 over the band's solid angle, latitude to 5°.
    const double b = 5 * pi_v<double> / 180, band = (b + std::sin(2 * b) / 2) / (2 * std::sin(b));
    EXPECT_NEAR(lobe.density[i], band * std::cos(lobe.angle[i] * pi_v<double> / 180) / pi_v<double>, 1e-4);
  }
}

TEST(PlaneBars, AreNarrowWhereMuchIsExpectedAndKeepEveryCount) {
  PlaneHistogram h;
  PlaneLobe lobe;
  h.samples = 1000;
  for (int i = 0; i < PlaneHistogram::bins; ++i) {
    h.count[std::size_t(i)] = i % 7;
    lobe.angle.push_back((i + 0.5) / 2 - 90);
    lobe.density.push_back((i < 100 ? 50 : i < 200 ? 10.01 : 0) * h.density_per_count());  // directions
  }
  const std::vector<PlaneBar> bars = plane_bars(h, lobe, 40);
  // 100 bins alone, 100 in fours, 160 in twenties (10 degrees).
  ASSERT_EQ(bars.size(), 100U + 25 + 8);
  EXPECT_EQ(bars[100].to_deg - bars[100].from_deg, 2);
  EXPECT_EQ(bars.back().to_deg - bars.back().from_deg, 10);
  EXPECT_EQ(bars.front().from_deg, -90);
  EXPECT_EQ(bars.back().to_deg, 90);
  double counted = 0, known = 0;
  for (const PlaneBar& b : bars) counted += b.count;
  for (const double n : h.count) known += n;
  EXPECT_EQ(counted, known);
  EXPECT_NEAR(bars[100].density_per_count, h.density_per_count() / 4, 1e-12);
}

// The largest deviation of the bars from the curve in standard deviations.
double worst_deviation(const PlaneHistogram& h, const PlaneLobe& lobe) {
  double worst = 0;
  for (const PlaneBar& b : plane_bars(h, lobe, 40)) {
    if (b.expected >= 40) worst = std::max(worst, std::abs(b.count - b.expected) / std::sqrt(b.expected));
  }
  return worst;
}

TEST(PlaneHistogram, CosineSamplesFollowTheLambertLobe) {
  const PlaneHistogram h = plane_histogram(cosine_directions(400000));
  EXPECT_LT(worst_deviation(h, plane_lobe(Lambert{{1, 1, 1}}, {}, viewer_at(0.3f), std::sqrt(3.0))), 4.8);
}

TEST(PlaneHistogram, CosineSamplesDoNotFollowAnotherLobe) {
  const auto bent = [](Direction, Direction wi) { return (wi.x > 0 ? 1.2f : 0.8f) / pi; };
  const PlaneHistogram h = plane_histogram(cosine_directions(400000));
  EXPECT_GT(worst_deviation(h, plane_lobe(AnyBrdf(bent), {}, viewer_at(0.3f), 1.0)), 4.8);
}

TEST(Figures, AreWellFormedAndTheSameEveryTime) {
  const AnyBrdf f = Ggx{0.2f, {1.f, 0.8f, 0.3f}};
  for (const DomainKind kind :
       {DomainKind::projected_disk, DomainKind::equal_area, DomainKind::half_vector}) {
    const SamplerData data =
        toy_sampler(f, {kind, kind != DomainKind::equal_area ? Symmetry::mirror : Symmetry::none, 0});
    const std::vector<Direction> samples = cosine_directions(500);
    const auto all = [&](float theta_o) {
      const Direction wo = viewer_at(theta_o);
      const DiskImage target = target_image(f, data.target, wo, 80);
      return std::vector<Figure>{
          target_figure(target, wo),
          tree_figure(data, wo, log_range(target)),
          samples_figure(target, wo, samples),
          polar_figure(f, data.target, wo, double(albedo_at(data.albedo, wo.z)), samples),
          square_figure(data, wo),
          slabs_figure(data),
          thumbnail_figure(f, data.target, wo)};
    };
    for (const float theta_o : {0.f, 1.f, 89.9f * degree}) {
      const std::vector<Figure> once = all(theta_o), again = all(theta_o);
      for (std::size_t i = 0; i < once.size(); ++i) {
        const std::string svg = to_svg(once[i]);
        EXPECT_EQ(xml_fault(svg), "") << once[i].title;
        EXPECT_EQ(svg, to_svg(again[i]));
        EXPECT_FALSE(has_broken_number(svg)) << once[i].title;
        EXPECT_FALSE(once[i].title.empty() || once[i].description.empty());
      }
    }
  }
}

TEST(Figures, AnEmptyMaterialAndNoSamplesAreDrawn) {
  const AnyBrdf black = Lambert{{0, 0, 0}};
  const Direction wo = viewer_at(0.5f);
  const DiskImage target = target_image(black, {}, wo, 40);
  for (const Figure& f :
       {target_figure(target, wo), samples_figure(target, wo, {}), polar_figure(black, {}, wo, 0, {})}) {
    EXPECT_EQ(xml_fault(to_svg(f)), "");
    EXPECT_FALSE(has_broken_number(f.body)) << f.title;
  }
}

TEST(SamplesFigure, OneDotASample) {
  const Direction wo = viewer_at(0.5f);
  const DiskImage target = target_image(Lambert{}, {}, wo, 40);
  const std::vector<Direction> samples = cosine_directions(700);
  const auto dots = [&](std::size_t shown) {
    return occurrences(samples_figure(target, wo, samples, shown).body, "h0");
  };
  EXPECT_EQ(dots(2500), 700U);
  EXPECT_EQ(dots(300), 300U);
}

TEST(TreeFigure, CountsLeavesAndNamesTheSlab) {
  const AnyBrdf f = Lambert{};
  const SamplerData data = toy_sampler(f, {DomainKind::projected_disk, Symmetry::mirror, 0}, 6);
  const Direction wo = viewer_at(70 * degree);
  const Figure figure = tree_figure(data, wo, log_range(target_image(f, {}, wo, 40)));
  EXPECT_NE(figure.title.find("64 leaves"), figure.title.npos);
  EXPECT_NE(figure.body.find("45° to 90°"), figure.body.npos);
}

TEST(SlabsFigure, CountsAndDrawsEverySlab) {
  const SamplerData data = toy_sampler(Lambert{}, {DomainKind::projected_disk, Symmetry::mirror, 0}, 6);
  const Figure figure = slabs_figure(data);
  EXPECT_NE(figure.description.find("exact: 2 slabs, 128 leaves; one-shot: 2 slabs, 128 leaves"),
            std::string::npos)
      << figure.description;
  EXPECT_EQ(occurrences(figure.body, "class=\"fill-1\""), 2U);
  EXPECT_EQ(occurrences(figure.body, "class=\"fill-2\""), 2U);
}

}  // namespace
}  // namespace reflectree::draw
