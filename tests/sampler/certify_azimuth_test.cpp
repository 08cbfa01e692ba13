// SPDX-License-Identifier: Apache-2.0
// Proofs where the azimuth of the viewer matters, and of families. A proof holds every value that it takes at a
// point against the enclosure over the box (check_value): domains in the frame of the surface, folded viewers, axes,
// albedo and parameters, as samplers run them.
#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/certify.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree {
namespace {

BuildOptions few_slabs() {
  BuildOptions options;
  options.expected_trials = 2.5f, options.one_shot_variance = 1;
  return options;
}
constexpr CertifyOptions short_proof{.tolerance = 0.1, .loosest = 0.5, .boxes_per_leaf = 200, .trials = 16};

class ProofWithAzimuth : public testing::TestWithParam<const char*> {};
TEST_P(ProofWithAzimuth, BoxesHoldWhatTheSamplerComputes) {
  const AnyBrdf f = material(GetParam());
  SamplerData data = build(f, few_slabs());
  const Certification c = certify(data, f, short_proof);
  EXPECT_GT(c.boxes, 100 * c.leaves);
}
INSTANTIATE_TEST_SUITE_P(Materials, ProofWithAzimuth,
                         testing::Values("ggx:alpha_x=0.3,alpha_y=0.6", "ward:alpha_x=0.3,alpha_y=0.6",
                                         "0.8*lambert + 0.2*ggx:alpha_x=0.7,alpha_y=1,phi_deg=20"));

// The twin: what is evaluated is turned from what is enclosed.
struct Turned {
  AnyBrdf f = material("ggx:alpha_x=0.3,alpha_y=0.6,phi_deg=22");
  AnyBrdf told = material("ggx:alpha_x=0.3,alpha_y=0.6,phi_deg=20");
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

TEST(ProofOfFamily, BoxesHoldWhatTheSamplerComputes) {
  const AnyFamily f = make_family(parse_material("ggx:alpha=0.4..0.8"));
  SamplerData data = build(f, few_slabs());
  const Certification c = certify(data, f, short_proof);
  EXPECT_GT(c.boxes, 100 * c.leaves);
}

// The largest T / (albedo M q) at random viewers, members and points.
double largest_share(const SamplerData& data, const AnyFamily& f, int points) {
  const PackedSampler packed = pack(data);
  Pcg32 u(3);
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const double theta = 1.5707 * std::pow(to_unit_double(u()), i % 2 ? 1 : 0.1);
    const Direction wo{float(std::sin(theta)), 0, max(float(std::cos(theta)), min_cos_theta_o)};
    Parameters at{};
    for (std::size_t k = 0; k < data.parameters.size(); ++k)
      at[k] = linear_mix(to_unit_float(u()), data.parameters[k].range.lo, data.parameters[k].range.hi);
    Incidence in;
    if (!find_incidence(packed, wo, at, in)) continue;
    const PackedSlab& slab = slab_at(packed, packed.exact, in);
    const PackedLeaf& leaf = packed.exact.leaves[slab.first + u() % slab.count];
    const bool half = packed.domain.half();
    const auto across = [&u] { return clamp(1.1f * to_unit_float(u()) - 0.05f, 0.f, 1.f); };
    const detail::PointInLeaf p = detail::point_at(leaf, half, across(), across());
    const DomainPoint point =
        lift(domain_at(packed.viewer, packed.domain, in), in.wo, p.p, half && (u() & 1U));
    const double target =
        double(packed.target(f(known_geometry(in, point.geometry, true), at)) * point.projected_area);
    largest = std::max(largest, target / double(in.albedo * p.height));
  }
  return largest;
}

TEST(ProofOfFamily, EverySlabAndNothingExceedsIt) {
  const AnyFamily f = make_family(parse_material("oren_nayar:sigma=0.2..0.6"));
  SamplerData data = build(f);
  const SamplerData bad = with_halved_bounds(data);
  const Certification c = certify(data, f);
  EXPECT_EQ(c.certified_slabs, c.slabs);
  EXPECT_EQ(c.proved_leaves, c.leaves);
  for (const MajorantTree& tree : data.exact) EXPECT_EQ(tree.status, BoundStatus::certified);
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_LE(largest_share(data, f, 200000), 1);
  // The twin: bounds that are too low are raised to where they must be.
  ASSERT_GT(largest_share(bad, f, 200000), 1.2) << "the planted fault must be one";
  SamplerData raised = bad;
  EXPECT_GT(certify(raised, f).raised_leaves, 0U);
  EXPECT_LE(largest_share(raised, f, 200000), 1);
}

}  // namespace
}  // namespace reflectree
