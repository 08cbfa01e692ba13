// SPDX-License-Identifier: Apache-2.0
// Certified bounds of an anisotropic function and of a family, small ones: nothing exceeds them, and bounds that are
// too low are raised.
#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/brdf/material/material.hpp"
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
constexpr CertifyOptions loose{.tolerance = 0.1, .loosest = 0.5, .boxes_per_leaf = 40000, .trials = 16};

// The largest T / (albedo M q) at random viewers, members and points.
template <class Value>
double largest_share(const SamplerData& data, bool turned, const Value& value, int points) {
  const PackedSampler packed = pack(data);
  Pcg32 u(3);
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const double theta = 1.5707 * std::pow(to_unit_double(u()), i % 2 ? 1 : 0.1),
                 phi = 6.2831 * to_unit_double(u());
    const Direction wo{float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                       max(float(std::cos(theta)), min_cos_theta_o)};
    Parameters at{};
    for (std::size_t k = 0; k < data.parameters.size(); ++k)
      at[k] = linear_mix(to_unit_float(u()), data.parameters[k].range.lo, data.parameters[k].range.hi);
    Incidence in;
    if (!find_incidence(packed, wo, at, in)) continue;
    const PackedSlab& slab = slab_at(packed, packed.exact, in);
    const PackedLeaf& leaf = packed.exact.leaves[slab.first + u() % slab.count];
    const bool half = packed.domain.half();
    const detail::PointInLeaf p = detail::point_at(leaf, half, to_unit_float(u()), to_unit_float(u()));
    const DomainPoint point =
        lift(domain_at(packed.viewer, packed.domain, in), in.wo, p.p, half && (u() & 1U));
    const double target =
        double(packed.target(value(known_geometry(in, point.geometry, turned), at)) * point.projected_area);
    largest = std::max(largest, target / double(in.albedo * p.height));
  }
  return largest;
}

SamplerData cut(SamplerData data) {
  for (MajorantTree& tree : data.exact) tree.volume *= 0.98f;
  return data;
}

template <class F, class Value>
void is_certified(const F& f, bool turned, const Value& value) {
  const SamplerData estimated = build(f, few_slabs());
  SamplerData data = estimated;
  const Certification c = certify(data, f, loose);
  EXPECT_EQ(c.certified_slabs, c.slabs) << c.proved_leaves << " of " << c.leaves << ", boxes " << c.boxes;
  EXPECT_LE(largest_share(data, turned, value, 100000), 1);
  // The twin: bounds that are 2 % too low.
  SamplerData low = cut(estimated);
  EXPECT_GT(largest_share(low, turned, value, 100000), 1) << "the planted fault must be one";
  const Certification raised = certify(low, f, loose);
  EXPECT_GT(raised.raised_leaves, 0U);
  EXPECT_LE(largest_share(low, turned, value, 100000), 1);
}

TEST(CertifyAzimuth, AnAnisotropicModel) {
  const AnyBrdf f = material("0.8*lambert + 0.2*ggx:alpha_x=0.7,alpha_y=1");
  is_certified(f, false, [&](const ShadingGeometry<float>& g, const Parameters&) { return f(g); });
}
TEST(CertifyAzimuth, AFamily) {
  const AnyFamily f = make_family(parse_material("oren_nayar:sigma=0.2..0.6"));
  is_certified(f, true, [&](const ShadingGeometry<float>& g, const Parameters& at) { return f(g, at); });
}

}  // namespace
}  // namespace reflectree
