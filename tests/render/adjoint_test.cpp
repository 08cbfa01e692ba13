// SPDX-License-Identifier: Apache-2.0
// Light's side: sample_adjoint draws wo with weight f(wo, wi) |cos_theta_o| / pdf, for functions that are not
// reciprocal too; photons' energy on such walls is what path tracing finds, and is not where it is forgotten.
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

const Texture white{{1, 1, 1}, nullptr}, red{{.6f, .1f, .1f}, nullptr};

struct Moments {
  double plain = 0, steep = 0;  // of f(wo, wi) cos_theta_o, and that times cos_theta_o^2
};

Moments integrate(const Scattering& s, Direction wi) {
  Moments m;
  constexpr int n = 500;
  for (int i = 0; i < 2 * n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double theta = M_PI / 2 * (i + .5) / n, phi = M_PI * (j + .5) / n;
      const Direction wo = direction_from_angles(float(theta), float(phi));
      const double cell = std::sin(theta) * M_PI / 2 / n * M_PI / n * std::abs(double(wo.z / wi.z));
      const double v = cell * double(s.f_cos(wo, wi, {}).r);
      m.plain += v, m.steep += v * double(wo.z) * double(wo.z);
    }
  }
  return m;
}

struct Drawn {
  Moments mean, error;
};

template <class Draw>
Drawn draw_many(const Draw& draw) {
  Moments sum, squares;
  PathBits u(Pcg32(7));
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const auto s = draw(u);
    if (!s) continue;
    const auto w = double(s->weight.r), z2 = double(s->wi.z) * double(s->wi.z);
    sum.plain += w / n, squares.plain += w * w / n, sum.steep += w * z2 / n,
        squares.steep += w * w * z2 * z2 / n;
  }
  const auto error = [](double mean, double square) {
    return std::sqrt(std::max(0., square - mean * mean) / n);
  };
  return {sum, {error(sum.plain, squares.plain), error(sum.steep, squares.steep)}};
}

bool agree(const Drawn& d, const Moments& exact, double bias = 1) {
  return std::abs(bias * d.mean.plain - exact.plain) < 4.5 * d.error.plain + 1e-3 * exact.plain &&
         std::abs(bias * d.mean.steep - exact.steep) < 4.5 * d.error.steep + 1e-3 * exact.steep;
}

TEST(Adjoint, SamplesOfEveryMaterialHaveItsIntegral) {
  const AnyBrdf one_way_brdf(OneWay{});
  const AnySampler<Spectrum> ordinary = one_shot_of(one_way_brdf);
  const Rgb eta{.2f, .9f, 1.1f}, k{3.9f, 2.4f, 2.2f};
  const auto rough = rough_conductor({Roughness::Kind::ggx, .3f, true}, eta, k, white);
  const std::pair<const char*, ScatteringPtr> all[] = {
      {"diffuse", diffuse(red)},
      {"rough metal", rough},
      {"rough plastic", rough_plastic({.diffuse = red}, {Roughness::Kind::ggx, .2f, true})},
      {"two-sided", two_sided(diffuse(white), diffuse(red))},
      {"blend", blend({{.35f, .35f, .35f}, nullptr}, diffuse(red), rough)},
      {"one-way", sampled(one_way_brdf, ordinary)},
      {"one-way, own sampler", sampled(one_way_brdf, ordinary, one_shot_of(adjoint_of(one_way_brdf)))},
      {"one-way, two-sided and blended",
       blend({{.5f, .5f, .5f}, nullptr}, two_sided(sampled(one_way_brdf, ordinary), diffuse(red)),
             diffuse(white))},
  };
  for (const auto& [name, material] : all) {
    for (const float theta : {.2f, 1.f, 1.4f}) {
      const Direction wi = direction_from_angles(theta, .7f);
      const Moments exact = integrate(*material, wi);
      const Drawn drawn = draw_many([&, m = material](PathBits& u) { return m->sample_adjoint(wi, {}, u); });
      EXPECT_TRUE(agree(drawn, exact))
          << name << " at " << theta << ": " << drawn.mean.plain << " for " << exact.plain;
      EXPECT_FALSE(agree(drawn, exact, 1.04)) << name << " at " << theta << ": a planted bias of 4 %";
    }
  }
  const auto forgetful = sampled(one_way_brdf, ordinary);
  const Direction wi = direction_from_angles(1.f, .7f);
  const Drawn drawn = draw_many([&](PathBits& u) { return forgetful->sample(wi, {}, u); });
  EXPECT_FALSE(agree(drawn, integrate(*forgetful, wi))) << "f in place of its adjoint";
}

TEST(Adjoint, GlassPassesPowerUnsqueezed) {
  const auto glass = dielectric(1.5f, white, white);
  PathBits u(Pcg32(3));
  int refracted = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto s = glass->sample_adjoint(direction_from_angles(.8f, .1f), {}, u);
    ASSERT_TRUE(s && s->delta);
    EXPECT_EQ(s->weight, (Rgb{1, 1, 1}));
    refracted += s->wi.z < 0;
  }
  EXPECT_GT(refracted, 900);
}

// Scatters light as if it went the other way.
struct Forgetful final : Scattering {
  ScatteringPtr own;
  explicit Forgetful(ScatteringPtr s) : own(std::move(s)) {}
  Rgb f_cos(Direction wo, Direction wi, Place place) const override { return own->f_cos(wo, wi, place); }
  float pdf(Direction wo, Direction wi, Place place) const override { return own->pdf(wo, wi, place); }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    return own->sample(wo, place, u);
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    return own->sample(wi, place, u);
  }
};

TEST(Adjoint, PhotonsOnNonReciprocalWallsBringWhatPathTracingFinds) {
  const AnyBrdf f(OneWay{});
  const auto plain = sampled(f, one_shot_of(f)), own = sampled(f, one_shot_of(f), one_shot_of(adjoint_of(f)));
  const Sight reference = look(lit_from_below(plain), 8, 256, 1);
  const auto photons = [&](const char* name, const ScatteringPtr& floor, bool gather, std::uint64_t seed) {
    Scene scene = lit_from_below(floor);
    scene.transport.method = Transport::Method::photons;
    scene.transport.photons = {3000, .15f, 2 / 3.f, gather};
    const Sight s = look(scene, 8, 48, seed);
    const Agreement a = agreement(s, reference, 1, .01);
    std::printf("%s: %.4f of path tracing's mean, z %.2f, rms %.3f\n", name, s.mean / reference.mean, a.mean,
                a.rms);
    return a(1.2);
  };
  EXPECT_TRUE(photons("ordinary sampler, gathered", plain, true, 31));
  EXPECT_TRUE(photons("ordinary sampler", plain, false, 41));
  EXPECT_TRUE(photons("the adjoint's own sampler", own, false, 51));
  EXPECT_FALSE(photons("f in place of its adjoint", std::make_shared<Forgetful>(plain), false, 61))
      << "the twin";
}

// A floor that is flat but shaded as if it leaned to the wall by 40 degrees: the light that photons take from
// it to the wall is right only with Veach's factor for shading normals.
TEST(Adjoint, ShadingNormalsBringPhotonsWhatPathTracingFinds) {
  const auto leaning = [](Scene scene) {
    add_triangles(scene, scene.rectangles.front(), direction_from_angles(.7f, pi / 2));
    scene.rectangles.erase(scene.rectangles.begin());
    return scene;
  };
  const Scene flat = lit_from_below(diffuse({{.9f, .9f, .9f}, nullptr}));
  Scene scene = leaning(flat);
  const Sight reference = look(scene, 8, 256, 1), upright = look(flat, 8, 256, 1);
  scene.transport.method = Transport::Method::photons;
  scene.transport.photons = {12000, .06f, 2 / 3.f, false};
  const Sight photons = look(scene, 8, 64, 71);
  const Agreement same = agreement(photons, reference, 1, .01), twin = agreement(photons, upright, 1, .01);
  std::printf("leaning floor: %.4f of path tracing's mean, z %.2f, rms %.3f; an upright one: rms %.3f\n",
              photons.mean / reference.mean, same.mean, same.rms, twin.rms);
  EXPECT_TRUE(same(1.2));
  EXPECT_FALSE(twin(1.2)) << "the twin: other shading normals";
}

}  // namespace
}  // namespace reflectree::render
