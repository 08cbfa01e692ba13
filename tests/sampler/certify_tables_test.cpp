// SPDX-License-Identifier: Apache-2.0
// Proofs of measured tables where the azimuth of the viewer matters: values that samplers compute are held against the
// enclosures of boxes of folded viewers.
#include <gtest/gtest.h>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"
#include "reflectree/brdf/tables/specular_table.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/certify.hpp"

namespace reflectree {
namespace {

constexpr CertifyOptions short_proof{.tolerance = 0.1, .loosest = 0.5, .boxes_per_leaf = 200, .trials = 16};

// What is evaluated is not what is enclosed.
struct Turned {
  AnyBrdf f, told;
  Spectrum operator()(const ShadingGeometry<float>& g) const { return f(g); }
  BrdfTraits traits() const {
    BrdfTraits traits = f.traits();
    traits.enclosure = told.traits().enclosure;
    return traits;
  }
};

// Measured tables, matt and smooth: RGL of every reduction and of two numbers of channels, and angles about the mirror
// direction.
AnyBrdf smooth_rgl(int reduction, int channels, float turn = 0) {
  RglWideFields f;
  f.reduction = reduction, f.channels = channels, f.theta_o = {0.f, 0.8f, 1.5707964f};
  f.phi_o.clear();
  const int azimuths = 8 / reduction + 1;
  for (int i = 0; i < azimuths; ++i) f.phi_o.push_back(-pi + 0.25f * pi * float(i));
  f.sigma = {2, 2, {1.f, 0.6f, 1.f, 0.6f}}, f.ndf = {2, 2, {1.f, 0.7f, 1.f, 0.7f}};
  f.warp_width = 5, f.warp_height = 9, f.colour_width = 3, f.colour_height = 9;
  const auto wave = [](float around, int periods) { return std::cos(2 * pi * around * float(periods)); };
  for (int p = 0; p < azimuths; ++p) {
    const float of_wo = wave(float(p) / 8 + turn, reduction == 1 ? 1 : 2);
    for (int t = 0; t < 3; ++t) {
      for (int v = 0; v < 9; ++v) {
        for (int u = 0; u < 5; ++u)
          f.vndf.push_back(1 + 0.3f * float(u) * (1 + 0.2f * wave(float(v) / 8, reduction == 1 ? 1 : 2)));
      }
      for (int i = 0; i < channels * 3 * 9; ++i)
        f.colours.push_back(0.5f + 0.1f * of_wo + 0.02f * float(i % 3) + 0.01f * float(t));
    }
  }
  return RglWideTable(f);
}
AnyBrdf smooth_specular() {
  SpecularTable<float> t;
  t.axes.rotation = {0, 0.5f * pi, pi, 1.5f * pi, 2 * pi}, t.axes.theta_o = {0, 0.8f, 1.5f};
  t.axes.azimuth = {0, 0.5f * pi, pi, 1.5f * pi, 2 * pi}, t.axes.radial = {0, 0.7f, 1.5f, 3};
  for (std::size_t i = 0; i < t.axes.size(); ++i) {
    const std::size_t radial = i % 4, azimuth = i / 4 % 5, rotation = i / 60;
    t.values.push_back(0.4f - 0.05f * float(radial) + (rotation % 4 == 1 ? 0.08f : 0.f) +
                       (radial > 0 && azimuth == 2 ? 0.05f : 0.f));
  }
  return t;
}
BuildOptions coarse() {
  BuildOptions options;
  options.expected_trials = 8, options.one_shot_variance = 10;
  return options;
}
TEST(ProofOfTables, BoxesHoldWhatTheSamplerComputes) {
  for (const AnyBrdf& f : {smooth_rgl(1, 3), smooth_rgl(4, 5), smooth_specular()}) {
    SamplerData data = build(f, coarse());
    ASSERT_FALSE(data.frame.isotropic());
    const Certification c = certify(data, f, short_proof);
    EXPECT_GT(c.boxes, 20 * c.leaves);
  }
}
// The twin: the table told of is a little turned.
TEST(ProofOfTablesTwin, AnEnclosureThatIsTurnedIsFound) {
  const AnyBrdf f = Turned{smooth_rgl(4, 3), smooth_rgl(4, 3, 0.02f)};
  SamplerData data = build(f, coarse());
  EXPECT_THROW(certify(data, f, short_proof), Error);
}

}  // namespace
}  // namespace reflectree
