// SPDX-License-Identifier: Apache-2.0
// One image: path tracing, recursive ray tracing and photon mapping show the same scenes alike, pixel by
// pixel; a planted bias is seen.
#include <gtest/gtest.h>

#include <thread>

#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

using Method = Transport::Method;

Scene by(Scene scene, Method method, float radius = 0, bool gather = true) {
  scene.transport.method = method;
  scene.transport.photons = {3000, radius, 2 / 3.f, gather};
  return scene;
}

Scene scene_named(const std::string& name) {
  if (name == "corner") return corner();
  if (name == "sky") return under_the_sky();
  if (name == "gem") return gem();
  return one_way(sampled(AnyBrdf(OneWay{}), one_shot_of(AnyBrdf(OneWay{}))));
}

class OneImage : public testing::TestWithParam<const char*> {};

TEST_P(OneImage, OfEveryIntegrator) {
  const Scene scene = scene_named(GetParam());
  const Sight reference = look(scene, 8, 512, 1);
  const auto judge = [&](const char* name, const Sight& s, double slack) {
    const Agreement same = agreement(s, reference, 1, slack), biased = agreement(s, reference, 1.05, slack);
    std::printf(
        "%s, %s: mean %.4f +- %.4f of path tracing's, rms of z %.3f (biased by 5 %%: z %.1f, rms %.3f)\n",
        GetParam(), name, s.mean / reference.mean,
        std::hypot(s.error / s.mean, reference.error / reference.mean), same.rms, biased.mean, biased.rms);
    EXPECT_TRUE(same(1.2)) << GetParam() << ", " << name << ": z of the mean " << same.mean;
    EXPECT_FALSE(biased(1.2)) << GetParam() << ", " << name << ": a planted bias of 5 %";
  };
  judge("recursive", look(by(scene, Method::recursive), 8, 16, 11), 0);
  judge("photons", look(by(scene, Method::photons, .15f), 8, 48, 21), .005);
  judge("photons without gathering", look(by(scene, Method::photons, .1f, false), 8, 96, 31), .01);
}

INSTANTIATE_TEST_SUITE_P(Scenes, OneImage, testing::Values("corner", "sky", "one-way", "gem"));

Host many_threads() {
  Host host;
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < n; ++i) threads.emplace_back([&body, i] { body(i, i + 1); });
    for (std::thread& t : threads) t.join();
  };
  return host;
}

TEST(Integrators, ThreadsAndInterruptionsDoNotMatter) {
  for (const Method method : {Method::recursive, Method::photons}) {
    for (const auto points :
         {PointSet::Kind::independent, PointSet::Kind::stratified, PointSet::Kind::sobol}) {
      Scene scene = by(under_the_sky(), method);
      scene.points.kind = points;
      const Image whole = render(scene, {.samples = 12, .seed = 5});
      EXPECT_EQ(whole.values, render(scene, {.samples = 12, .seed = 5}, many_threads()).values);
      EXPECT_NE(whole.values, render(scene, {.samples = 12, .seed = 6}).values) << "the twin";
      int polls = 0;
      Host counts;
      counts.cancelled = [&] { return ++polls < 0; };
      render(scene, {.samples = 12, .seed = 5}, counts);
      ASSERT_GT(polls, 8);
      Film film;
      Host stops;
      stops.cancelled = [&, left = polls * 3 / 4]() mutable { return --left < 0; };
      ASSERT_FALSE(render_into(film, scene, {.samples = 12, .seed = 5}, stops));
      ASSERT_GT(film.samples, 0);
      ASSERT_LT(film.samples, 12);
      ASSERT_TRUE(render_into(film, scene, {.samples = 12, .seed = 5}));
      EXPECT_EQ(to_image(film).values, whole.values);
    }
  }
}

// Photons stop while they are traced, too.
TEST(Integrators, PhotonsCanBeCancelled) {
  Scene scene = by(under_the_sky(), Method::photons);
  Host stops;
  stops.cancelled = [] { return true; };
  Film film;
  EXPECT_FALSE(render_into(film, scene, {.samples = 1, .seed = 1}, stops));
  EXPECT_EQ(film.samples, 0);
}

// Points reach through every integrator: fewer samples for the same error.
TEST(Integrators, SobolPointsLessenTheError) {
  const Image truth = render(by(corner(), Method::path), {.samples = 8192, .seed = 9});
  for (const Method method : {Method::path, Method::recursive}) {
    Scene scene = by(corner(), method);
    const auto error = [&](PointSet::Kind kind, std::uint64_t first = 1) {
      scene.points.kind = kind;
      double sum = 0;
      for (std::uint64_t seed = first; seed < first + 2; ++seed) {
        const Image image = render(scene, {.samples = 64, .seed = seed});
        for (std::size_t i = 0; i < image.values.size(); i += 6)
          sum += std::pow(double(image.values[i] - truth.values[i]), 2);
      }
      return sum;
    };
    const double plain = error(PointSet::Kind::independent), gain = error(PointSet::Kind::sobol) / plain;
    std::printf("squared error by Sobol' points, method %d: %.3f of independent ones\n", int(method), gain);
    EXPECT_LT(gain, .7);
    EXPECT_GT(error(PointSet::Kind::independent, 11) / plain, .7) << "the twin: no gain without points";
  }
}

TEST(Integrators, AndPointsAreReadFromScenes) {
  const auto read = [](const std::string& integrator, const std::string& sampler) {
    return parse_scene("<scene><integrator " + integrator +
                           "</integrator><sensor type=\"perspective\"><sampler type=\"" + sampler +
                           "\"/><film type=\"hdrfilm\"/></sensor></scene>",
                       "read.xml");
  };
  const Scene photons = read(R"(type="photons"><integer name="photon_count" value="77"/>
    <float name="radius" value="0.5"/><float name="alpha" value="0.7"/><integer name="split" value="3"/>
    <boolean name="final_gather" value="false"/><integer name="max_depth" value="4"/>)",
                             "ldsampler");
  EXPECT_EQ(photons.transport.method, Method::photons);
  EXPECT_EQ(photons.transport.photons.count, 77);
  EXPECT_EQ(photons.transport.photons.radius, .5f);
  EXPECT_EQ(photons.transport.photons.shrink, .7f);
  EXPECT_EQ(photons.transport.split, 3);
  EXPECT_FALSE(photons.transport.photons.gather);
  EXPECT_EQ(photons.max_depth, 4);
  EXPECT_EQ(photons.points.kind, PointSet::Kind::sobol);
  const Scene recursive = read(R"(type="recursive"><integer name="split" value="9"/>)", "stratified");
  EXPECT_EQ(recursive.transport.method, Method::recursive);
  EXPECT_EQ(recursive.transport.split, 9);
  EXPECT_EQ(recursive.points.kind, PointSet::Kind::stratified);
  EXPECT_EQ(read(R"(type="direct">)", "independent").transport.method, Method::direct);
  EXPECT_THROW(read(R"(type="path">)", "halton"), Error);
}

TEST(Integrators, RefuseWhatTheyCannotDo) {
  Scene scene = by(corner(), Method::recursive);
  scene.transport.split = 1000;
  EXPECT_THROW(render(scene, {.samples = 1}), Error);
  scene = by(corner(), Method::photons, -1);
  EXPECT_THROW(render(scene, {.samples = 1}), Error);
  scene = by(corner(), Method::photons);
  scene.transport.photons.shrink = 0;
  EXPECT_THROW(render(scene, {.samples = 1}), Error);
  EXPECT_THROW(render(corner(), {.samples = 1, .technique = Technique::resampled}), Error);
}

}  // namespace
}  // namespace reflectree::render
