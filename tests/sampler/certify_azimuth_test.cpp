// SPDX-License-Identifier: Apache-2.0
// Proofs where the azimuth of the viewer matters, and of families. A proof holds every value that it takes at a
// point against the enclosure over the box (check_value): domains in the frame of the surface, folded viewers, axes,
// albedo and parameters, as samplers run them.
#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/certify.hpp"

namespace reflectree {
namespace {

BuildOptions few_slabs() {
  BuildOptions options;
  options.expected_trials = 2.5f, options.one_shot_variance = 1;
  return options;
}
constexpr CertifyOptions short_proof{.tolerance = 0.1, .loosest = 0.5, .boxes_per_leaf = 1000, .trials = 16};

class ProofWithAzimuth : public testing::TestWithParam<const char*> {};
TEST_P(ProofWithAzimuth, BoxesHoldWhatTheSamplerComputes) {
  const AnyBrdf f = material(GetParam());
  SamplerData data = build(f, few_slabs());
  const Certification c = certify(data, f, short_proof);
  EXPECT_GT(c.boxes, 20 * c.leaves);
  EXPECT_GT(c.proved_leaves, 0U) << "of " << c.leaves;
}
INSTANTIATE_TEST_SUITE_P(Materials, ProofWithAzimuth,
                         testing::Values("ggx:alpha_x=0.3,alpha_y=0.6", "ggx:alpha_x=0.3,alpha_y=0.6,phi_deg=20",
                                         "ward:alpha_x=0.3,alpha_y=0.6", "ashikhmin_shirley:n_x=5,n_y=20",
                                         "0.8*lambert + 0.2*ggx:alpha_x=0.7,alpha_y=1"));

// The twin: what is evaluated is turned from what is enclosed.
struct Turned {
  AnyBrdf f = material("ggx:alpha_x=0.3,alpha_y=0.6,phi_deg=22"), told = material("ggx:alpha_x=0.3,alpha_y=0.6,phi_deg=20");
  Spectrum operator()(const ShadingGeometry<float>& g) const { return f(g); }
  BrdfTraits traits() const {
    BrdfTraits traits = f.traits();
    traits.enclosure = told.traits().enclosure;
    return traits;
  }
};
TEST(ProofWithAzimuthTwin, AnEnclosureThatIsTurnedIsFound) {
  const AnyBrdf f = Turned();
  SamplerData data = build(f, few_slabs());
  EXPECT_THROW(certify(data, f, short_proof), Error);
}

class ProofOfFamily : public testing::TestWithParam<const char*> {};
TEST_P(ProofOfFamily, BoxesHoldWhatTheSamplerComputes) {
  const AnyFamily f = make_family(parse_material(GetParam()));
  SamplerData data = build(f, few_slabs());
  const Certification c = certify(data, f, short_proof);
  EXPECT_GT(c.boxes, 20 * c.leaves);
  EXPECT_GT(c.proved_leaves, 0U) << "of " << c.leaves;
}
INSTANTIATE_TEST_SUITE_P(Materials, ProofOfFamily,
                         testing::Values("ggx:alpha=0.4..0.8", "oren_nayar:sigma=0.2..0.6",
                                         "0.5*lambert + 0.5*ggx:alpha_x=0.3,alpha_y=0.5..0.8"));

}  // namespace
}  // namespace reflectree
