// SPDX-License-Identifier: Apache-2.0
// The oracle: of low_smooth with c = 1 and f0 = 1, seen on the projected disk, everything is known in closed form:
// t = sqrt(3) / (1 + b d^2), d the distance of wi to the mirror image of wo.
#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/brdf/models/low_smooth.hpp"
#include "reflectree/math/cubature.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/certify.hpp"
#include "reflectree/sampler/prove_albedo.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree {
namespace {

constexpr double b = 25, peak = 1.7320508075688772;

AnyBrdf oracle() { return material("low_smooth:b=25,c=1,f0=1"); }
double true_albedo(double cosine) { return peak * low_smooth_albedo(1, b, cosine); }

const SamplerData& built() {
  static const SamplerData data = [] {
    BuildOptions options;
    options.albedo_error = 1e-6f;
    options.domain = Domain{DomainKind::projected_disk};
    return build(oracle(), options);
  }();
  return data;
}
const SamplerData& certified() {
  static const SamplerData data = [] {
    SamplerData proved = built();
    certify(proved, oracle());
    return proved;
  }();
  return data;
}

// One leaf, its ring and wedge on the disk.
struct Sector {
  double r0, r1, phi0, phi1;
};
Sector sector_of(const detail::LeafCell<float>& cell) {
  const auto azimuth = [](double x) { return 0.5 * pi_v<double> * (1 - x); };
  const double x = double(cell.x), y = double(cell.y);
  return {std::sqrt(y), std::sqrt(y + double(cell.length)), azimuth(x + double(cell.width)), azimuth(x)};
}
double target_at(double sine, double r, double phi) {
  return peak / (1 + b * (sine * sine + r * r + 2 * sine * r * std::cos(phi)));
}
// Where the sector comes closest to the mirror image, which lies at azimuth pi.
double largest_target(const Sector& s, double sine) {
  const double along = -std::cos(s.phi1), r = std::clamp(sine * along, s.r0, s.r1);
  return target_at(sine, r, s.phi1);
}

// visit(slab's range of cosines, leaf) for every leaf.
template <class Visit>
void for_each_leaf(const PackedSampler& packed, const Visit& visit) {
  const std::vector<float>& borders = packed.exact.lookup.borders();
  for (std::size_t s = 0; s < packed.exact.slabs.size(); ++s) {
    const PackedSlab& slab = packed.exact.slabs[s];
    for (std::uint32_t k = 0; k < slab.count; ++k)
      visit(double(borders[s]), double(min(borders[s + 1], 1.f)), packed.exact.leaves[slab.first + k]);
  }
}

// The largest T / (albedo q) of a leaf over the viewers of its slab, by a grid and a climb in doubles.
double true_bound(const PackedSampler& packed, double c0, double c1, const PackedLeaf& leaf) {
  const detail::LeafCell<float> cell = detail::unpack(leaf, packed.domain.half());
  const Sector s = sector_of(cell);
  const auto value = [&](const std::array<double, 3>& at) {
    const double c = c0 + (c1 - c0) * at[0], sine = std::sqrt((1 - c) * (1 + c));
    const double phi = s.phi1 + (s.phi0 - s.phi1) * at[1];
    const double r = std::sqrt(s.r0 * s.r0 + (s.r1 * s.r1 - s.r0 * s.r0) * at[2]);
    const double q =
        (1 + double(cell.slope_x) * (2 * at[1] - 1)) * (1 + double(cell.slope_y) * (2 * at[2] - 1));
    return pi_v<double> * target_at(sine, r, phi) / (double(packed.viewer.albedo.at(float(c))) * q);
  };
  constexpr int n = 16;
  std::array<double, 3> best{};
  double largest = 0;
  for (int i = 0; i < n * n * n; ++i) {
    const std::array<double, 3> at{double(i % n) / (n - 1), double(i / n % n) / (n - 1),
                                   double(i / n / n) / (n - 1)};
    if (const double v = value(at); v > largest) largest = v, best = at;
  }
  for (double step = 0.05; step > 1e-6; step *= 0.7) {
    for (int k = 0; k < 27; ++k) {
      std::array<double, 3> next = best;
      const std::array<int, 3> move{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
      for (std::size_t i = 0; i < 3; ++i) next[i] = std::clamp(next[i] + step * move[i], 0., 1.);
      if (const double v = value(next); v > largest) largest = v, best = next;
    }
  }
  return largest;
}

TEST(Oracle, AlbedoIsTheClosedForm) {
  const AlbedoTable& table = built().albedo;
  double worst = 0;
  for (std::size_t i = 0; i + 1 < table.cos_theta_o.size(); ++i) {
    const float low = table.cos_theta_o[i], high = table.cos_theta_o[i + 1];
    for (const float c : {low, 0.5f * (low + high)}) {
      if (c < 1.8e-3f) continue;
      worst = std::max(worst, std::abs(double(albedo_at(table, c)) / true_albedo(double(c)) - 1));
    }
  }
  EXPECT_LE(worst, 1e-6);
  EXPECT_GT(std::abs(double(albedo_at(table, 0.5f)) / true_albedo(0.501) - 1), 1e-5) << "the twin";
}

// The leaves cover the disk once, and each has its share of the albedo.
TEST(Oracle, LeavesIntegrateToTheAlbedo) {
  const PackedSampler packed = pack(built());
  for (const double c : {0.999, 0.7, 0.2, 0.03}) {
    const double sine = std::sqrt((1 - c) * (1 + c));
    const PackedSlab& slab = packed.exact.slab_at(float(c));
    double sum = 0, twin = 0;
    for (std::uint32_t k = 0; k < slab.count; ++k) {
      const PackedLeaf& leaf = packed.exact.leaves[slab.first + k];
      const Sector s = sector_of(detail::unpack(leaf, true));
      const Integrand f = [&](std::span<const Vec2<double>> points, std::span<double> out) {
        for (std::size_t i = 0; i < points.size(); ++i)
          out[i] = 2 * points[i].x * target_at(sine, points[i].x, points[i].y);
      };
      const double part = cubature(f, {s.r0, s.r1, s.phi0, s.phi1}, {1e-9, 0, 400'000, 4, 4}).value;
      sum += part;
      if (k > 0) twin += part;
    }
    EXPECT_NEAR(sum / true_albedo(c), 1, 1e-6) << c;
    EXPECT_LT(twin / true_albedo(c), 1 - 1e-6) << "a leaf is missing";
  }
}

TEST(Oracle, DensitiesAreTheClosedForm) {
  const Sampler<AnyBrdf> sampler = make_sampler(oracle(), built());
  Pcg32 u(5);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const float c = 0.01f + 0.99f * to_unit_float(u());
    const Direction wo{sqrt((1 - c) * (1 + c)), 0, c};
    const auto drawn = sampler.exact.sample(wo, u);
    if (!drawn) continue;
    const Direction wi = drawn->wi;
    const double d2 = sqr(double(wo.x) + double(wi.x)) + sqr(double(wi.y));
    const double pdf = peak / (1 + b * d2) * double(wi.z) / true_albedo(double(c));
    worst = std::max(worst, std::abs(double(sampler.exact.pdf(wo, wi)) / pdf - 1));
  }
  EXPECT_LE(worst, 1e-6);
  EXPECT_GT(worst, 0);
}

// What floats find in a box is what the closed form says.
TEST(Oracle, BoxMaximaAreTheClosedForm) {
  const AnyBrdf f = oracle();
  const PackedSampler packed = pack(built());
  double worst = 0;
  for_each_leaf(packed, [&](double c0, double c1, const PackedLeaf& leaf) {
    const auto c = float(0.5 * (c0 + c1));
    const Direction wo{sqrt((1 - c) * (1 + c)), 0, c};
    const double expected = largest_target(sector_of(detail::unpack(leaf, true)), double(wo.x));
    double largest = 0, x = 0.5, y = 0.5;
    for (double step = 0.5; step > 1e-5; step *= 0.75) {
      for (int i = 0; i < 25; ++i) {
        const double tx = std::clamp(x + step * (i % 5 - 2), 0., 1.),
                     ty = std::clamp(y + step * (i / 5 - 2), 0., 1.);
        const detail::PointInLeaf at = detail::point_at(leaf, true, float(tx), float(ty));
        const double t = double(packed.target(f(lift(packed.domain, wo, at.p).geometry)));
        if (t > largest) largest = t, x = tx, y = ty;
      }
    }
    worst = std::max(worst, std::abs(largest / expected - 1));
  });
  EXPECT_LE(worst, 1e-6);
}

// Of certified bounds over what they must be; least: over the truth alone. A bound that the build had set higher is
// not lowered, and leaves near the floor are not asked.
double largest_excess(const PackedSampler& packed, double& least) {
  const PackedSampler before = pack(built());
  double most = 0;
  std::size_t k = 0;
  for_each_leaf(packed, [&](double c0, double c1, const PackedLeaf& leaf) {
    const double truth = true_bound(packed, c0, c1, leaf), estimate = double(before.exact.leaves[k++].height);
    least = std::min(least, double(leaf.height) / truth);
    if (truth > 0.02) most = std::max(most, double(leaf.height) / std::max(truth, estimate / 1.01));
  });
  return most;
}
// One percent, and a step of 0.2 % by which a proof may settle.
TEST(Oracle, CertifiedBoundsAreWithinOnePercent) {
  for (const MajorantTree& tree : certified().exact) ASSERT_EQ(tree.status, BoundStatus::certified);
  PackedSampler packed = pack(certified());
  double least = 2;
  EXPECT_LE(largest_excess(packed, least), 1.0125);
  EXPECT_GE(least, 1);
  // The twins.
  for (PackedLeaf& leaf : packed.exact.leaves) leaf.height *= 1.005f;
  EXPECT_GT(largest_excess(packed, least), 1.0125);
  for (PackedLeaf& leaf : packed.exact.leaves) leaf.height *= 0.98f;
  largest_excess(packed, least);
  EXPECT_LT(least, 1);
}

// The enclosure of the albedo holds the closed form, as near as was asked; a table that is off is not proved.
TEST(Oracle, TheAlbedoIsProved) {
  SamplerData data = built();
  const AlbedoProof proof = prove_albedo(data, oracle(), {.relative_error = 0.06});
  EXPECT_LE(proof.relative_error, 0.06);
  EXPECT_GE(data.albedo.proved_error, float(proof.relative_error));
  SamplerData wrong = built();
  for (float& a : wrong.albedo.albedo) a *= 1.08f;
  EXPECT_GE(prove_albedo(wrong, oracle(), {.relative_error = 0.06}).relative_error, 0.079 / 1.08);
  EXPECT_THROW(prove_albedo(wrong, oracle(), {.relative_error = 0}), Error);
  const AnyBrdf black_box = [](Direction, Direction) { return 0.3f; };
  EXPECT_THROW(prove_albedo(wrong, black_box), Error);
}

TEST(Oracle, TheProofOfTheAlbedoDoesNotDependOnThreads) {
  SamplerData one = built(), two = built();
  const AlbedoProof a = prove_albedo(one, oracle(), {.relative_error = 0.2});
  const AlbedoProof c = prove_albedo(two, oracle(), {.relative_error = 0.2}, uneven_threads(2));
  EXPECT_EQ(a.boxes, c.boxes);
  EXPECT_EQ(one, two);
}

}  // namespace
}  // namespace reflectree
