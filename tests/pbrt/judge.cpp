// SPDX-License-Identifier: Apache-2.0
// Samplers of ours inside pbrt-v4, judged by pbrt's own chi-square test: its code and its settings, from the
// checkout that it is compiled against. REFLECTREE_PBRT_FAULT plants a fault that it must reject.
#include <reflectree.h>

#ifdef REFLECTREE_PBRT_FAULT
// A density that is 5 % too high on one side of the lobe and too low on the other: its integral stays about 1.
static reflectree_status faulty_pdf(const reflectree_sampler* s, int mode, size_t n, const float* wo,
                                    const float* wi, float* pdf) {
  const reflectree_status status = reflectree_pdf(s, mode, n, wo, wi, pdf);
  for (size_t i = 0; i < n; ++i) pdf[i] *= wi[3 * i + 1] > 0 ? 1.05f : 0.95f;
  return status;
}
#define reflectree_pdf faulty_pdf
#endif

#include PBRT_JUDGE  // bsdfs_test.cpp

namespace {

reflectree_sampler* built(const char* material) {
  reflectree_function* f;
  reflectree_sampler* s;
  if (reflectree_function_open(material, nullptr, &f) || reflectree_build(f, nullptr, &s))
    ErrorExit("%s: %s", material, reflectree_last_error());
  reflectree_function_free(f);
  return s;
}

const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.3f);

const ReflectreeMode modes[] = {ReflectreeMode::Monotone, ReflectreeMode::Alias, ReflectreeMode::Exact};

constexpr const char* materials[] = {
    "ggx:alpha=0.3",
#ifndef REFLECTREE_PBRT_FAULT
    "ggx:alpha_x=0.3,alpha_y=0.15",
    "plastic:alpha=0.3",
    "oren_nayar",
    "0.5*lambert:rho=0.5 + 0.5*ashikhmin_shirley",
#endif
};

// check(sampler) of every material. The loop is here and not in gtest: pbrt brings one of its own, an old one.
template <class Check>
void for_each_material(const Check& check) {
  for (const char* material : materials) {
    SCOPED_TRACE(material);
    std::cout << material << std::endl;
    reflectree_sampler* sampler = built(material);
    check(static_cast<const reflectree_sampler*>(sampler));
    reflectree_sampler_free(sampler);
  }
}

// pbrt's TestBSDF for all of them at once: its tables, its integrals, its verdict with its level of significance, which
// it shares out among as many tests as there are.
TEST(Reflectree, ChiSquare) {
  constexpr int cells = CHI2_THETA_RES * CHI2_PHI_RES;
  std::vector<Float> drawn(cells), expected(cells);
  RNG rng;
  for_each_material([&](const reflectree_sampler* sampler) {
    for (const ReflectreeMode mode : modes) {
      ReflectreeBxDF ours(sampler, mode, lambda);
      const BSDF bsdf(Normal3f(0, 0, 1), Vector3f(1, 0, 0), &ours);
      for (int run = 0; run < CHI2_RUNS; ++run) {
        Vector3f wo = SampleCosineHemisphere({rng.Uniform<Float>(), rng.Uniform<Float>()});
        if (run == 0) wo.z = -wo.z;  // from behind
        FrequencyTable(&bsdf, wo, rng, CHI2_SAMPLECOUNT, CHI2_THETA_RES, CHI2_PHI_RES, drawn.data());
        IntegrateFrequencyTable(&bsdf, wo, CHI2_SAMPLECOUNT, CHI2_THETA_RES, CHI2_PHI_RES, expected.data());
        const auto verdict =
            Chi2Test(drawn.data(), expected.data(), CHI2_THETA_RES, CHI2_PHI_RES, CHI2_SAMPLECOUNT,
                     CHI2_MINFREQ, CHI2_SLEVEL, CHI2_RUNS * std::size(modes) * std::size(materials));
        EXPECT_TRUE(verdict.first) << verdict.second << ", mode " << int(mode) << ", wo " << wo.ToString();
      }
    }
  });
}

#ifndef REFLECTREE_PBRT_FAULT
// What is drawn has the value and the density that f and PDF give, on both sides, and the reflected share is that of
// uniform directions.
void expect_agreement(const reflectree_sampler* sampler) {
  RNG rng(7);
  const auto point = [&] { return Point2f(rng.Uniform<Float>(), rng.Uniform<Float>()); };
  for (const ReflectreeMode mode : modes) {
    const ReflectreeBxDF ours(sampler, mode, lambda);
    const BxDF bxdf = &ours;
    for (const int side : {1, -1}) {
      const Vector3f wo(0.48f, -0.36f, side * 0.8f);
      double drawn = 0, drawn_squares = 0, uniform = 0, uniform_squares = 0;
      const int n = 200000;
      for (int i = 0; i < n; ++i) {
        const auto sample = bxdf.Sample_f(wo, rng.Uniform<Float>(), point());
        ASSERT_TRUE(bool(sample));
        ASSERT_GT(sample->wi.z * float(side), 0);
        ASSERT_NEAR(sample->pdf, bxdf.PDF(wo, sample->wi, TransportMode::Radiance), 2e-3 * sample->pdf);
        const SampledSpectrum f = bxdf.f(wo, sample->wi, TransportMode::Radiance);
        for (int c = 0; c < NSpectrumSamples; ++c) ASSERT_NEAR(sample->f[c], f[c], 2e-3 * f[c] + 1e-6);
        const double share = sample->f[0] * AbsCosTheta(sample->wi) / sample->pdf;
        drawn += share, drawn_squares += share * share;
        Vector3f wi = SampleUniformHemisphere(point());
        wi.z *= side;
        const double other =
            bxdf.f(wo, wi, TransportMode::Radiance)[0] * AbsCosTheta(wi) / UniformHemispherePDF();
        uniform += other, uniform_squares += other * other;
      }
      const auto variance = [&](double sum, double squares) { return (squares / n - Sqr(sum / n)) / n; };
      const double error = std::sqrt(variance(drawn, drawn_squares) + variance(uniform, uniform_squares));
      EXPECT_NEAR(drawn / n, uniform / n, 5 * error + 1e-4);
    }
  }
}

TEST(Reflectree, Agrees) { for_each_material(expect_agreement); }

void expect_the_rules_of_a_bxdf(const reflectree_sampler* sampler) {
  const ReflectreeBxDF ours(sampler, ReflectreeMode::Monotone, lambda);
  BxDF bxdf = &ours;
  const Vector3f up(0.6f, 0, 0.8f), over(0, 0.6f, 0.8f), under(0, 0.6f, -0.8f);
  EXPECT_EQ(bxdf.Flags(), BxDFFlags::GlossyReflection);
  EXPECT_FALSE(
      bool(bxdf.Sample_f(up, 0.3f, {0.2f, 0.7f}, TransportMode::Radiance, BxDFReflTransFlags::Transmission)));
  EXPECT_EQ(bxdf.PDF(up, over, TransportMode::Radiance, BxDFReflTransFlags::Transmission), 0);
  EXPECT_EQ(bxdf.PDF(up, under, TransportMode::Radiance), 0);
  EXPECT_FALSE(bool(bxdf.f(up, under, TransportMode::Radiance)));
  // For importance the directions change places.
  const SampledSpectrum radiance = bxdf.f(up, over, TransportMode::Radiance);
  const SampledSpectrum importance = bxdf.f(over, up, TransportMode::Importance);
  for (int c = 0; c < NSpectrumSamples; ++c) EXPECT_EQ(radiance[c], importance[c]);
  const SampledSpectrum before = radiance;
  bxdf.Regularize();
  EXPECT_EQ(bxdf.f(up, over, TransportMode::Radiance)[0], before[0]);
}
TEST(Reflectree, KeepsTheRulesOfABxDF) { for_each_material(expect_the_rules_of_a_bxdf); }
#endif

}  // namespace

int main(int count, char** words) {
  PBRTOptions options;
  options.quiet = true;
  InitPBRT(options);
  testing::InitGoogleTest(&count, words);
  testing::GTEST_FLAG(filter) = "*Reflectree*";
  const int failed = RUN_ALL_TESTS();
  CleanupPBRT();
  return failed;
}
