// SPDX-License-Identifier: Apache-2.0
// Point sets: what they stratify, that pictures by them have the same mean and less error, and that threads
// and interruptions do not matter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "../scratch.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::render {
namespace {

using Kind = PointSet::Kind;

constexpr const char* lit_wall = R"(
  <scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective"><float name="fov" value="20"/>
    <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
    <sampler type="$points"/>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="8"/>
      <rfilter type="tent"/></film></sensor>
  <shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>
  <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="110"/><translate x="-2" z="1"/></transform>
    <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape></scene>)";

Scene scene_with(const std::string& points) {
  std::string xml = lit_wall;
  xml.replace(xml.find("$points"), 7, points);
  return parse_scene(xml, "wall.xml");
}

// How many of the 4 x 4 cells the first 16 samples of a pixel visit at a decision, in its first two words.
std::size_t cells_visited(PointSet set, int vertex, Decision decision) {
  std::set<std::uint32_t> cells;
  for (std::uint32_t s = 0; s < 16; ++s) {
    PathBits u(set, 3, 17, s);
    u.begin(vertex, decision);
    const std::uint32_t x = u() >> 30U, y = u() >> 30U;
    cells.insert(4 * x + y);
  }
  return cells.size();
}

TEST(Points, EveryDecisionsFirstTwoWordsVisitEachCellOnce) {
  for (const int vertex : {1, 2, 7}) {
    for (const Decision d : {Decision::light, Decision::surface}) {
      EXPECT_EQ(cells_visited({Kind::stratified}, vertex, d), 16U);
      EXPECT_EQ(cells_visited({Kind::sobol}, vertex, d), 16U);
      EXPECT_LT(cells_visited({Kind::independent}, vertex, d), 16U) << "the twin";
    }
  }
}

TEST(Points, BranchesOfAllSamplesAreOnePointSet) {
  std::set<std::uint32_t> cells;
  for (std::uint32_t s = 0; s < 4; ++s) {
    PathBits u({Kind::sobol}, 3, 17, s);
    for (std::uint32_t k = 0; k < 4; ++k) {
      PathBits b = u.branch(k, 4);
      b.begin(2, Decision::surface);
      const std::uint32_t x = b() >> 30U, y = b() >> 30U;
      cells.insert(4 * x + y);
    }
  }
  EXPECT_EQ(cells.size(), 16U);
}

// The mean of every word is 1/2 also where a round of strata is not complete.
TEST(Points, IncompleteRoundsAreUniform) {
  for (const PointSet set : {PointSet{Kind::stratified, 3, 5}, PointSet{Kind::sobol}}) {
    constexpr int n = 200000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      PathBits u(set, std::uint64_t(i), 5, 3);
      u.begin(1, Decision::surface);
      u();
      sum += to_unit_double(u()) / n;
    }
    const double error = std::sqrt(1 / 12. / n);
    EXPECT_NEAR(sum, .5, 4 * error);
    EXPECT_GT(std::abs(sum * 1.01 - .5), 4 * error) << "a planted bias of 1 %";
  }
}

double mean(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.values.size(); i += 6) sum += double(image.values[i]);
  return sum / double(image.values.size() / 6);
}

struct Errors {
  double mse = 0;   // of pixels
  double mean = 0;  // of the whole picture, over seeds
  double mean_error = 0;
};

Errors errors_of(const std::string& points, const Image& truth, std::uint64_t first = 1) {
  const Scene scene = scene_with(points);
  Errors e;
  double square = 0;
  constexpr int seeds = 12;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const Image image = render(scene, {.samples = 64, .seed = seed});
    for (std::size_t i = 0; i < image.values.size(); i += 6)
      e.mse += std::pow(double(image.values[i] - truth.values[i]), 2);
    const double m = mean(image);
    e.mean += m / seeds, square += m * m / seeds;
  }
  e.mean_error = std::sqrt(std::max(0., square - e.mean * e.mean) / (seeds - 1));
  return e;
}

TEST(Points, StratifiedAndSobolHaveTheSameMeanAndLessError) {
  const Image truth = render(scene_with("sobol"), {.samples = 4096, .seed = 99});
  const Errors plain = errors_of("independent", truth), again = errors_of("independent", truth, 101);
  EXPECT_GT(again.mse / plain.mse, .8) << "the twin: no gain without points";
  for (const char* points : {"stratified", "ldsampler"}) {
    const Errors e = errors_of(points, truth);
    std::printf("%s: squared error %.3f of independent points'\n", points, e.mse / plain.mse);
    EXPECT_LT(e.mse / plain.mse, .5) << points;
    const double error = std::hypot(e.mean_error, plain.mean_error);
    EXPECT_LT(std::abs(e.mean - plain.mean), 4 * error) << points;
    EXPECT_GT(std::abs(e.mean * 1.02 - plain.mean), 4 * error) << points << ": a planted bias of 2 %";
  }
}

TEST(Points, ThreadsAndInterruptionsDoNotMatter) {
  Host host;
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < n; ++i) threads.emplace_back([&body, i] { body(i, i + 1); });
    for (std::thread& t : threads) t.join();
  };
  for (const char* points : {"stratified", "sobol"}) {
    const Scene scene = scene_with(points);
    const Image whole = render(scene, {.samples = 20, .seed = 5});
    EXPECT_EQ(whole.values, render(scene, {.samples = 20, .seed = 5}, host).values) << points;
    Film film;
    Host stops;
    int polls = 0;
    stops.cancelled = [&] { return ++polls > 12; };
    ASSERT_FALSE(render_into(film, scene, {.samples = 20, .seed = 5}, stops));
    ASSERT_EQ(film.samples, 8);
    const std::string file = scratch("points.sums");
    save_film(file, film);
    film = load_film(file);
    ASSERT_TRUE(render_into(film, scene, {.samples = 20, .seed = 5}));
    EXPECT_EQ(to_image(film).values, whole.values) << points;
    EXPECT_THROW(render_into(film, scene_with("independent"), {.samples = 30, .seed = 5}), Error);
  }
}

}  // namespace
}  // namespace reflectree::render
