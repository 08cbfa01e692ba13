// SPDX-License-Identifier: Apache-2.0
// What is asked about many paths together is what one would be told alone: rays, skies, lights, materials;
// and the slopes that Beckmann's visible normals come from.
#include <gtest/gtest.h>

#include <cmath>

#include "../../src/render/materials/visible_slope.hpp"
#include "reflectree/render/world.hpp"
#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

constexpr std::size_t many = 1003;  // no multiple of any block

Direction any_direction(Pcg32& u) {
  const float z = 1 - 2 * to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<PathBits> bits_of_many() {
  std::vector<PathBits> bits;
  for (std::size_t i = 0; i < many; ++i) bits.push_back(PathBits({}, 3, i, 0));
  return bits;
}
std::vector<PathBits*> addresses(std::vector<PathBits>& bits) {
  std::vector<PathBits*> all;
  for (PathBits& b : bits) all.push_back(&b);
  return all;
}

TEST(Batches, PacketsOfRaysMeetWhatSingleRaysMeet) {
  for (const Scene& scene : {corner(), gem()}) {
    const EmbreeScene embree(scene);
    std::vector<Ray> rays;
    Pcg32 u(5);
    for (std::size_t i = 0; i < many; ++i) {
      const Point from = Point{0, 0, .8f} + (.5f + 2 * to_unit_float(u())) * any_direction(u);
      rays.push_back({from, any_direction(u), 1e-4f, 3});
    }
    std::vector<std::optional<Hit>> hits(many);
    std::vector<std::uint8_t> dark(many);
    embree.occluded(rays, dark);
    std::size_t met = 0;
    for (const bool coherent : {false, true}) {
      embree.intersect(rays, coherent, hits);
      for (std::size_t i = 0; i < many; ++i) {
        const auto alone = embree.intersect(rays[i]);
        ASSERT_EQ(alone.has_value(), hits[i].has_value()) << i;
        ASSERT_EQ(alone.has_value(), dark[i] != 0) << i;
        ASSERT_EQ(embree.occluded(rays[i]), dark[i] != 0) << i;
        if (!alone) continue;
        ++met;
        ASSERT_EQ(alone->kind, hits[i]->kind) << i;
        ASSERT_EQ(alone->index, hits[i]->index) << i;
        ASSERT_NEAR(alone->distance, hits[i]->distance, 1e-5f) << i;
        ASSERT_EQ(surface_of(scene, *alone),
                  interaction_at(scene, *alone, rays[i].origin, rays[i].direction).surface);
      }
    }
    EXPECT_GT(met, many / 5);
  }
}

// Embree itself ends the program on such rays. The last is sound, and shows that its neighbours do not
// matter.
TEST(Batches, RaysThatAreNoneMeetNothingAndBringNoLight) {
  const Scene scene = corner();
  const EmbreeScene embree(scene);
  const float nan = std::nanf(""), far = 3e25f;
  const std::vector<Ray> rays{{{far, -4, 1}, {-1, 0, 0}},
                              {{0, nan, .8f}, {0, 0, -1}},
                              {{0, 0, .8f}, {nan, nan, nan}},
                              {{0, 0, .8f}, {0, 0, -1}, 0, nan},
                              {{0, 0, .8f}, {0, 0, -1}}};
  std::vector<std::optional<Hit>> hits(rays.size());
  std::vector<std::uint8_t> dark(rays.size());
  embree.occluded(rays, dark);
  for (const bool coherent : {false, true}) {
    embree.intersect(rays, coherent, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool sound = i + 1 == rays.size();
      EXPECT_EQ(hits[i].has_value(), sound) << i;
      EXPECT_EQ(embree.intersect(rays[i]).has_value(), sound) << i;
      EXPECT_NE(dark[i], 0) << i;
      EXPECT_TRUE(embree.occluded(rays[i])) << i;
    }
  }
}

// Between points that touch: nothing is there to be met, and nothing blocks.
TEST(Batches, RaysThatEndBeforeTheyBeginAreFree) {
  const Scene scene = corner();
  const EmbreeScene embree(scene);
  const std::vector<Ray> rays{{{0, 0, .8f}, {0, 0, -1}, 2, 1}, {{0, 0, .8f}, {0, 0, -1}}};
  std::vector<std::optional<Hit>> hits(rays.size());
  std::vector<std::uint8_t> dark(rays.size());
  embree.occluded(rays, dark);
  embree.intersect(rays, false, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i].has_value(), i == 1);
    EXPECT_EQ(embree.intersect(rays[i]).has_value(), i == 1);
    EXPECT_EQ(dark[i] != 0, i == 1);
    EXPECT_EQ(embree.occluded(rays[i]), i == 1);
  }
}

Image sky_picture() {
  Image p = make_image(16, 9, {"R", "G", "B"});
  Pcg32 u(2);
  for (float& v : p.values) v = std::pow(to_unit_float(u()), 4.f);
  return p;
}

TEST(Batches, SkiesAndLights) {
  Scene scene = corner();
  const LocalFrame<float> turned = frame_from_normal(Direction{.6f, 0, .8f});
  for (const Environment& sky : {Environment({1, 2, 3}), Environment(sky_picture(), turned, 2, "sky")}) {
    scene.environment = sky;
    const Lights lights(scene);
    std::vector<PathBits> bits = bits_of_many(), alone = bits;
    std::vector<Direction> directions;
    std::vector<Point> points;
    Pcg32 u(9);
    for (std::size_t i = 0; i < many; ++i)
      directions.push_back(any_direction(u)), points.push_back(2.f * any_direction(u));
    std::vector<Environment::Light> found(many);
    lights.environment(directions, found);
    std::vector<std::optional<LightSample>> drawn(many);
    lights.sample(points, addresses(bits), drawn);
    std::size_t from_sky = 0;
    for (std::size_t i = 0; i < many; ++i) {
      const auto light = lights.environment(directions[i]);
      ASSERT_EQ(light.radiance, found[i].radiance) << i;
      ASSERT_EQ(light.pdf, found[i].pdf) << i;
      const auto own = lights.sample(points[i], alone[i]);
      ASSERT_EQ(own.has_value(), drawn[i].has_value()) << i;
      ASSERT_EQ(alone[i](), bits[i]()) << i;
      if (!own) continue;
      from_sky += std::isinf(own->distance);
      ASSERT_EQ(own->direction, drawn[i]->direction) << i;
      ASSERT_EQ(own->pdf, drawn[i]->pdf) << i;
      ASSERT_EQ(own->radiance, drawn[i]->radiance) << i;
      ASSERT_EQ(own->distance, drawn[i]->distance) << i;
    }
    EXPECT_GT(from_sky, many / 10);
  }
}

ScatteringPtr with_sampler(const std::string& name) {
  const Material material = parse_material("ggx:alpha=0.2");
  const AnyBrdf f = make_brdf(material);
  return sampled(f, *find_sampler(name)->make({f, material, {}, nullptr}, {}));
}

TEST(Batches, Materials) {
  const Texture grey{{.5f, .4f, .3f}, nullptr};
  const Rgb eta{.2f, .9f, 1.1f}, k{3.9f, 2.4f, 2.2f};
  const auto metal = rough_conductor({Roughness::Kind::beckmann, .2f, true}, eta, k, grey);
  for (const ScatteringPtr& material :
       {diffuse(grey), metal, rough_plastic({}, {}), dielectric(1.5f, grey, grey), with_sampler("one-shot"),
        with_sampler("exact"), with_sampler("cosine"), two_sided(diffuse(grey), with_sampler("one-shot")),
        blend({{.3f, .3f, .3f}, nullptr}, diffuse(grey), metal)}) {
    std::vector<PathBits> bits = bits_of_many(), alone = bits;
    std::vector<Scattering::View> views;
    std::vector<Direction> wi;
    Pcg32 u(4);
    for (std::size_t i = 0; i < many; ++i)
      views.push_back({any_direction(u), {}}), wi.push_back(any_direction(u));
    std::vector<Scattering::Value> values(many);
    material->values(views, wi, values);
    std::vector<std::optional<Scattered>> drawn(many);
    material->samples(views, addresses(bits), drawn);
    for (std::size_t i = 0; i < many; ++i) {
      const auto value = material->value(views[i].wo, wi[i], {});
      ASSERT_EQ(value.f_cos, values[i].f_cos) << i;
      ASSERT_TRUE(value.f_cos == Rgb{} || value.pdf == values[i].pdf) << i;
      const auto own = material->sample(views[i].wo, {}, alone[i]);
      ASSERT_EQ(own.has_value(), drawn[i].has_value()) << i;
      ASSERT_EQ(alone[i](), bits[i]()) << i;
      if (!own) continue;
      ASSERT_EQ(own->wi, drawn[i]->wi) << i;
      ASSERT_EQ(own->pdf, drawn[i]->pdf) << i;
      ASSERT_EQ(own->weight, drawn[i]->weight) << i;
      ASSERT_EQ(own->delta, drawn[i]->delta) << i;
    }
  }
}

// The share of a slope's density below x, by the closed form in double precision; `farthest` stands for minus
// infinity.
double share_below(double cosine, double sine, double x) {
  const auto integral = [&](double t) {
    return .5 * std::erfc(-t) * cosine + .5 / std::sqrt(M_PI) * std::exp(-t * t) * sine;
  };
  return integral(x) / integral(cosine / sine);
}

double worst_slope(float bent) {
  double worst = 0;
  for (const float theta : {.001f, .1f, .5f, 1.f, 1.3f, 1.5f, 1.57f}) {
    for (int i = 0; i < 4096; ++i) {
      const float u = (float(i) + .5f) / 4096, c = std::cos(theta), s = std::sin(theta);
      const double x = double(visible_slope(c, s, u) + bent);
      worst = std::max(worst,
                       std::abs(share_below(double(c), double(s), std::min(x, double(c / s))) - double(u)));
    }
  }
  return worst;
}

TEST(Batches, VisibleSlopesInvertTheirShare) {
  EXPECT_LT(worst_slope(0), 1e-6);
  EXPECT_GT(worst_slope(1e-4f), 2e-5);  // and a bend is seen
  Pcg32 u(1);
  for (int i = 0; i < 4096; ++i) {
    const float x = 4 * to_unit_float(u());
    ASSERT_NEAR(scaled_erfc(x) * std::exp(-x * x), std::erfc(x), 5e-7f);
  }
}

}  // namespace
}  // namespace reflectree::render
