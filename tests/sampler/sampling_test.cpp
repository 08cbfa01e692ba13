// SPDX-License-Identifier: Apache-2.0
// Both modes, their batch forms and densities agree with each other and with cubature.
#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/math/low_discrepancy.hpp"
#include "reflectree/verify/consistency.hpp"
#include "reflectree/verify/faults.hpp"
#include "reflectree/verify/furnace.hpp"

namespace reflectree {
namespace {

struct SampledMaterial {
  const char* text;
  Sampler<AnyBrdf> sampler;
};
const std::vector<SampledMaterial>& subjects() {
  static const std::vector<SampledMaterial> all = [] {
    std::vector<SampledMaterial> list;
    for (const char* text : {"lambert", "ggx:alpha=0.1", "plastic:alpha=0.2", "retro_reflector:alpha=0.1"}) {
      list.push_back({text, make_sampler(material(text))});
    }
    return list;
  }();
  return all;
}

TEST(Sampling, PdfWeightSupportAndIntegralAgree) {
  for (const SampledMaterial& s : subjects()) {
    const TargetFunction f = target_function(s.sampler.exact.brdf());
    for (const double theta : {0., 50., 86., 89.9}) {
      const Direction wo = wo_at(theta, 1);
      for (const auto& sampler :
           {erase(s.sampler.exact, {}, "exact"), erase(s.sampler.one_shot, {}, "one-shot")}) {
        for (const CheckResult& r : check_consistency(sampler, f, wo)) {
          EXPECT_TRUE(r.passed) << s.text << ' ' << sampler.name << ' ' << theta << ' ' << to_line(r);
        }
      }
    }
  }
}

// A spoilt pdf or weight does not pass the same checks.
TEST(SamplingTwin, SpoiltDensitiesAreSeen) {
  const SampledMaterial& s = subjects()[1];
  const TargetFunction f = target_function(s.sampler.exact.brdf());
  const auto passes = [&](const ErasedSampler& sampler) {
    return all_passed(check_consistency(sampler, f, wo_at(50, 1)));
  };
  for (const auto& sampler : {erase(s.sampler.exact), erase(s.sampler.one_shot)}) {
    EXPECT_TRUE(passes(sampler));
    EXPECT_FALSE(passes(scaled_pdf(sampler, 1.01f)));
    EXPECT_FALSE(passes(scaled_weight(sampler, 1.01f)));
    EXPECT_FALSE(passes(dying(sampler, 1000)));
  }
}

TEST(Sampling, PdfOfTheDiskIsPerProjectedSolidAngle) {
  Pcg32 u(1);
  for (const SampledMaterial& s : subjects()) {
    for (int i = 0; i < 200; ++i) {
      const Direction wo = wo_at(85 * to_unit_double(u()), 6 * to_unit_double(u()));
      const Direction wi = wo_at(85 * to_unit_double(u()), 6 * to_unit_double(u()));
      const auto agree = [&](const auto& sampler) {
        EXPECT_NEAR(sampler.pdf(wo, wi), sampler.pdf_disk(wo, wi) * wi.z, 1e-5f * sampler.pdf(wo, wi));
        EXPECT_EQ(sampler.pdf(wo, -wi), 0);
        EXPECT_EQ(sampler.pdf_disk(wo, -wi), 0);
        EXPECT_EQ(sampler.pdf(-wo, wi), 0);
      };
      agree(s.sampler.exact);
      agree(s.sampler.one_shot);
    }
  }
}

// The same mean from one trial, from both modes, and from cubature.
TEST(Sampling, OneTrialAndBothModesHaveTheSameMean) {
  for (const SampledMaterial& s : subjects()) {
    const TargetFunction f = target_function(s.sampler.exact.brdf());
    for (const double theta : {20., 80.}) {
      const Direction wo = wo_at(theta, 2);
      const auto agrees = [&](const char* name, const AlbedoEstimate& estimate) {
        const CheckResult r = check_albedo_estimates(name, estimate, f, wo, 200'000);
        EXPECT_TRUE(r.passed) << s.text << ' ' << theta << ' ' << to_line(r);
      };
      const auto mean_of = [](const auto& sample) { return sample ? double(Target{}(sample->weight)) : 0.; };
      agrees("sample_once",
             [&](Direction w, Pcg32& u) { return mean_of(s.sampler.exact.sample_once(w, u)); });
      agrees("one_shot", [&](Direction w, Pcg32& u) { return mean_of(s.sampler.one_shot.sample(w, u)); });
      // Exact weights are the tabulated albedo itself, up to rounding.
      Pcg32 u(1);
      for (int i = 0; i < 1000; ++i) {
        const double w = mean_of(s.sampler.exact.sample(wo, u));
        EXPECT_NEAR(w / double(s.sampler.exact.albedo(wo)), 1, 1e-5);
      }
      EXPECT_NEAR(double(s.sampler.exact.albedo(wo)) / reference_albedo(f, wo).value, 1, 1.5e-4);
    }
  }
}

// --- N directions at once ----------------------------------------------------------------------------

// E[g] over t cos_i / a, by cubature.
template <class G>
double expectation(const AnyBrdf& brdf, Direction wo, G g) {
  const TargetFunction f = target_function(brdf);
  TargetFunction weighted = f;
  weighted.eval = [f, g](Vec3<double> o, std::span<const Vec3<double>> wi, std::span<double> t) {
    f.eval(o, wi, t);
    for (std::size_t i = 0; i < wi.size(); ++i) t[i] *= g(wi[i]);
  };
  return reference_albedo(weighted, wo).value / reference_albedo(f, wo).value;
}

// A loose sampler, so that many trials are rejected and in some leaves more than in others.
const Sampler<AnyBrdf>& loose() {
  static const Sampler<AnyBrdf> s = [] {
    BuildOptions options;
    options.expected_trials = 3;
    options.one_shot_variance = 0.2f;
    return make_sampler(material("plastic:kd=0.3,alpha=0.3"), options);
  }();
  return s;
}

constexpr int batch = 7, calls = 30'000;
double brightness(Vec3<double> w) { return 1 + w.z + 0.5 * w.x; }
const Direction known = wo_at(55);

double weighted_mean(std::span<const DirectionSample<Spectrum>> out, double albedo) {
  double sum = 0;
  for (const auto& s : out) {
    sum += double(Target{}(s.weight)) / albedo * brightness({double(s.wi.x), double(s.wi.y), double(s.wi.z)});
  }
  return sum / double(out.size());
}

TEST(SampleN, IsUnbiasedInBothModes) {
  const AnyBrdf& f = loose().exact.brdf();
  const double expected = expectation(f, known, brightness),
               albedo = reference_albedo(target_function(f), known).value;
  Pcg32 u(9);
  std::vector<DirectionSample<Spectrum>> out(batch);
  EXPECT_LT(std::abs(z_score(expected, calls,
                             [&] {
                               EXPECT_EQ(loose().exact.sample_n(known, u, std::span(out)), out.size());
                               return weighted_mean(out, albedo);
                             })),
            4.5);
  EXPECT_LT(std::abs(z_score(expected, calls,
                             [&] {
                               EXPECT_EQ(loose().one_shot.sample_n(known, u, std::span(out)), out.size());
                               return weighted_mean(out, albedo);
                             })),
            4.5);
}

// Dividing among the leaves by volume and then retrying inside the leaf until a trial is accepted: what
// sample_n must not do. The same test sees it.
TEST(SampleNTwin, RetryingInsideTheLeafIsSeen) {
  const AnyBrdf& f = loose().exact.brdf();
  const double expected = expectation(f, known, brightness),
               albedo = reference_albedo(target_function(f), known).value;
  const PackedSampler& packed = loose().exact.packed();
  Incidence in;
  ASSERT_TRUE(find_incidence(packed.viewer, known, in));
  const PackedSlab& slab = packed.exact.slab_at(in);
  Pcg32 u(9);
  const double z = z_score(expected, calls, [&] {
    double sum = 0;
    detail::divide(
        slab, packed.exact.leaves.data() + slab.first, batch, u, [&](const detail::ChosenLeaf& chosen) {
          for (;;) {
            bool coin = false;
            const auto at = detail::place({chosen.leaf, detail::bits64(u)}, packed.domain.half(), u, coin);
            const DomainPoint p = lift(packed.domain, in.wo, at.p);
            const float t = packed.target(f(p.geometry));
            if (to_unit_float(u()) * at.height >= t * p.projected_area / in.albedo) continue;
            const Direction w = p.geometry.wi;
            sum += double(in.albedo) / albedo * brightness({double(w.x), double(w.y), double(w.z)});
            return;
          }
        });
    return sum / batch;
  });
  EXPECT_GT(std::abs(z), 6);
}

// The mean over a batch varies less than that of independent samples.
TEST(SampleN, IsStratified) {
  const auto& sampler = subjects()[2].sampler.one_shot;
  Pcg32 u(3);
  std::vector<DirectionSample<Spectrum>> out(512);
  const auto variance = [&](auto&& call) {
    double sum = 0, square = 0;
    for (int i = 0; i < 1000; ++i) {
      call();
      const double x = weighted_mean(out, 1);
      sum += x, square += x * x;
    }
    return square / 1000 - sqr(sum / 1000);
  };
  const double divided = variance([&] { sampler.sample_n(known, u, std::span(out)); });
  const double independent = variance([&] {
    for (auto& s : out) s = *sampler.sample(known, u);
  });
  EXPECT_LT(divided, 0.5 * independent);
}

// --- monotone descent --------------------------------------------------------------------------------

TEST(Monotone, InvertGivesTheUniformsBack) {
  Pcg32 u(4);
  for (const SampledMaterial& s : subjects()) {
    int exceptions = 0;
    const int n = 4000;
    for (int i = 0; i < n; ++i) {
      const Direction wo = wo_at(80 * to_unit_double(u()), 6 * to_unit_double(u()));
      const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
      const auto drawn = s.sampler.one_shot.sample(wo, u1, u2);
      ASSERT_TRUE(drawn);
      const auto back = s.sampler.one_shot.invert(wo, drawn->wi);
      ASSERT_TRUE(back);
      exceptions += std::abs(back->x - u1) > 2e-3 || std::abs(back->y - u2) > 2e-3;
    }
    EXPECT_LE(exceptions, n / 100) << s.text;
    EXPECT_FALSE(s.sampler.one_shot.invert(wo_at(30), {0, 0, -1}));
  }
}

TEST(Monotone, EachCoordinateGrowsWithItsUniform) {
  Pcg32 u(5);
  for (const SampledMaterial& s : subjects()) {
    const Domain domain = s.sampler.one_shot.packed().domain;
    for (int trial = 0; trial < 40; ++trial) {
      const Direction wo = wo_at(80 * to_unit_double(u()));
      const double other = to_unit_double(u());
      float x = -2, y = -2;
      for (int i = 0; i < 200; ++i) {
        const double t = (i + 0.5) / 200;
        const auto place = [&](double u1, double u2) {
          const auto drawn = s.sampler.one_shot.sample(wo, u1, u2);
          Direction w = drawn->wi;
          const float sign = domain.half() && w.y < 0 ? -1.f : 1.f;
          w.y *= sign;
          const Vec2<float> p = lower(domain, wo, w);
          return Vec2<float>{p.x, sign * p.y};
        };
        const float next_x = place(t, other).x, next_y = place(other, t).y;
        EXPECT_GE(next_x, x - 1e-4f) << s.text;
        EXPECT_GE(next_y, y - 1e-4f) << s.text;
        x = next_x, y = next_y;
      }
      EXPECT_GT(x, 0);
      EXPECT_GT(y, 0);
    }
  }
}

TEST(Monotone, LowDiscrepancyPointsBeatRandomOnes) {
  for (const SampledMaterial& s : subjects()) {
    const Direction wo = wo_at(40);
    Pcg32 u(6);
    const auto variance = [&](auto&& point) {
      double sum = 0, square = 0;
      const std::uint32_t repetitions = 100, n = 256;
      for (std::uint32_t r = 0; r < repetitions; ++r) {
        double mean = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
          const Vec2<double> p = point(i, r);
          const auto drawn = s.sampler.one_shot.sample(wo, p.x, p.y);
          mean += double(Target{}(drawn->weight)) *
                  brightness({double(drawn->wi.x), double(drawn->wi.y), double(drawn->wi.z)}) / n;
        }
        sum += mean, square += mean * mean;
      }
      return square / repetitions - sqr(sum / repetitions);
    };
    const double sobol = variance([](std::uint32_t i, std::uint32_t r) {
      return Vec2<double>{scrambled_sobol(i, 0, r), scrambled_sobol(i, 1, r)};
    });
    const double random = variance([&](std::uint32_t, std::uint32_t) {
      return Vec2<double>{to_unit_double(u()), to_unit_double(u())};
    });
    EXPECT_LT(sobol, 0.4 * random) << s.text;
  }
}

}  // namespace
}  // namespace reflectree
