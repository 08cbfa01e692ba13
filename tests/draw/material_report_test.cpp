// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/material_report.hpp"

#include <gtest/gtest.h>

#include <array>

#include "reflectree/brdf/models/lambert.hpp"
#include "toy_sampler.hpp"
#include "xml_check.hpp"

namespace reflectree::draw {
namespace {

TEST(MaterialReport, TakesItsFiguresFromTheData) {
  const AnyBrdf f = Lambert{};
  SamplerData data = toy_sampler(f, {DomainKind::equal_area, Symmetry::mirror, 0}, 5);
  data.report.expected_trials = 1.25f;
  const ReportFigures figures = figures_of(data);
  EXPECT_EQ(figures.domain, "equal_area");
  EXPECT_EQ(figures.bounds, "estimated");
  EXPECT_EQ(figures.exact_slabs, 2U);
  EXPECT_EQ(figures.exact_leaves, 64U);
  EXPECT_EQ(figures.mean_trials, 1.25);
  EXPECT_FALSE(figures.kib.has_value());
  for (MajorantTree& tree : data.exact) tree.status = BoundStatus::certified;
  EXPECT_EQ(figures_of(data).bounds, "certified");
  data.exact.back().status = BoundStatus::estimated;  // one estimated slab spoils the claim
  EXPECT_EQ(figures_of(data).bounds, "estimated");
}

TEST(MaterialReport, DrawsEveryView) {
  const AnyBrdf f = Lambert{};
  const SamplerData data = toy_sampler(f, {DomainKind::projected_disk, Symmetry::mirror, 0}, 4);
  std::vector<Direction> asked;
  const std::array<float, 2> views{0.f, 1.f};
  const ReportMaterial material = material_report(f, data, views, [&](Direction wo) {
    asked.push_back(wo);
    return std::vector<Direction>(10, viewer_at(0.2f));
  });
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[1], viewer_at(1.f));
  ASSERT_EQ(material.views.size(), 2U);
  EXPECT_EQ(material.views[1].pictures.size(), 4U);
  EXPECT_EQ(material.name, f.traits().name);
  EXPECT_EQ(xml_fault(report_html({material}, {})), "");
}

}  // namespace
}  // namespace reflectree::draw
