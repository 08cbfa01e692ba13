// SPDX-License-Identifier: Apache-2.0
// A coarse ball of triangles whose corners lie on the unit sphere with its normals, beside the sphere itself:
// what its interpolated normals lose and darken, and that they let nothing through. As they are parallel to
// positions, what they lose is known: of a cosine-weighted hemisphere about them, (1 - cos delta) / 2 lies
// below a triangle that leans by delta, and goes inside, where the ball is black; and it is black where the
// eye is below them.
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

// An octahedron's triangles, each split into four, `levels` times.
void add_ball(Scene& scene, Direction a, Direction b, Direction c, int levels, std::uint32_t surface) {
  if (levels > 0) {
    const Direction ab = normalize(a + b), bc = normalize(b + c), ca = normalize(c + a);
    add_ball(scene, a, ab, ca, levels - 1, surface), add_ball(scene, ab, b, bc, levels - 1, surface);
    add_ball(scene, ca, bc, c, levels - 1, surface), add_ball(scene, ab, bc, ca, levels - 1, surface);
    return;
  }
  const auto first = std::uint32_t(scene.vertices.size());
  for (const Direction d : {a, b, c}) scene.vertices.push_back({d, d, {}});
  scene.triangles.push_back({{first, first + 1, first + 2}, surface});
}

constexpr int the_sphere = -1;  // for `levels`

// A grey ball about the origin before the eye, and `rest`.
Scene ball(int levels, const std::string& rest, const std::string& depth = "-1") {
  Scene scene = parse_scene(
      small_scene(depth, rest + R"(<shape type="sphere">)" + grey("0.8, 0.8, 0.8") + "</shape>", "1,-3,1.2"),
      "ball.xml");
  if (levels == the_sphere) return scene;
  const std::uint32_t surface = scene.spheres.back().surface;
  scene.spheres.pop_back();
  const Direction x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  for (const float i : {-1.f, 1.f}) {
    for (const float j : {-1.f, 1.f}) {
      for (const float k : {-1.f, 1.f}) add_ball(scene, i * x, j * y, k * z, levels, surface);
    }
  }
  return scene;
}

const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>)";

struct Expected {
  double mean = 0, error = 0;  // of the picture under a sky of radiance 1
  double lossless = 0;         // were nothing to go inside
  double black = 0;            // share of the ball's points whose normals look away from the eye
};
Expected expected(const Scene& scene) {
  const EmbreeScene embree(scene);
  const Camera& c = scene.camera;
  Pcg32 u(5);
  Expected e;
  constexpr int n = 400000;
  double squares = 0, met = 0;
  for (int i = 0; i < n; ++i) {
    const float x = (2 * to_unit_float(u()) - 1) * c.tan_x, y = (2 * to_unit_float(u()) - 1) * c.tan_y;
    const Direction along = normalize(c.forward + x * c.left + y * c.up);
    const auto hit = embree.intersect({c.origin, along});
    double value = 1, lossless = 1;
    if (hit) {
      const Interaction on = interaction_at(scene, *hit, c.origin, along);
      const bool front = dot(on.shading, along) < 0;
      ++met, e.black += !front;
      lossless = front ? .8 : 0;
      value = lossless * (1 + double(dot(on.normal(), on.shading))) / 2;
    }
    e.mean += value / n, squares += value * value / n, e.lossless += lossless / n;
  }
  e.error = std::sqrt((squares - e.mean * e.mean) / n), e.black /= met;
  return e;
}

TEST(ShadingNormals, LoseTheEnergyThatGoesBelowTheSurfaceAndNoMore) {
  for (const int levels : {the_sphere, 2, 3}) {
    const Scene scene = ball(levels, sky);
    const Expected e = expected(scene);
    const Sight seen = look(scene, 8, 512, 1);
    const double error = std::hypot(seen.error, e.error);
    std::printf("%d triangles: %.5f +- %.5f for %.5f, %.5f without the loss; %.4f of the ball is black\n",
                int(scene.triangles.size()), seen.mean, error, e.mean, e.lossless, e.black);
    EXPECT_LT(std::abs(seen.mean - e.mean), 4.5 * error) << levels;
    EXPECT_GT(std::abs(1.01 * seen.mean - e.mean), 4.5 * error) << "a planted gain of 1 %";
    if (levels == 2) {
      EXPECT_GT(std::abs(seen.mean - e.lossless), 4.5 * error) << "the twin: the loss is there";
    }
  }
}

TEST(ShadingNormals, DarkenAnEdgeThatShrinksWithTheTriangles) {
  EXPECT_EQ(expected(ball(the_sphere, sky)).black, 0);
  const double coarse = expected(ball(2, sky)).black, middle = expected(ball(3, sky)).black,
               fine = expected(ball(5, sky)).black;
  std::printf("black: %.5f, %.5f, %.5f\n", coarse, middle, fine);
  EXPECT_LT(coarse, .02);
  EXPECT_LT(middle, coarse / 2);
  EXPECT_LT(fine, middle / 8);
  EXPECT_GT(fine, 0) << "it is there to be seen";
}

// A lamp that all but fills the ball, seen from outside.
double through_ball(int levels) {
  float inside = 1;
  const Scene hollow = ball(levels, sky);
  for (const Triangle& t : hollow.triangles) {
    const Point a = hollow.vertices[t.corner[0]].at, b = hollow.vertices[t.corner[1]].at,
                c = hollow.vertices[t.corner[2]].at;
    inside = std::min(inside, std::abs(dot(normalize(cross(b - a, c - a)), a)));
  }
  const std::string lamp = R"(<shape type="sphere"><float name="radius" value=")" +
                           std::to_string(.998f * inside) +
                           R"("/><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)";
  return look(ball(levels, lamp), 2, 256, 3).mean;
}

// A lamp under a floor whose normals lean towards it.
double through_floor(float theta) {
  Scene scene = parse_scene(small_scene("-1", R"(<shape type="disk"><transform name="to_world">
      <translate y="-3" z="-1"/></transform><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
      <shape type="rectangle"><transform name="to_world"><scale value="2"/></transform></shape>)",
                                        "0,-4,1.4"),
                            "floor.xml");
  add_triangles(scene, scene.rectangles.front(), direction_from_angles(theta, -pi / 2));
  scene.rectangles.clear();
  return look(scene, 2, 256, 3).mean;
}

// What leaves above a normal that is parallel to its position goes outwards, below a triangle too: it never
// comes to a lamp inside. Normals that lean without the surface's bending have no such luck.
TEST(ShadingNormals, LetNothingThroughABallButALeaningFloorLeaks) {
  for (const int levels : {the_sphere, 2, 3, 4}) EXPECT_EQ(through_ball(levels), 0) << levels;
  EXPECT_EQ(through_floor(0), 0);
  EXPECT_GT(through_floor(.7f), 0) << "the twin: as documented, not refused";
}

// The sun from the side: where triangles shade themselves, the round ball would be lit.
TEST(ShadingNormals, ShadeThemselvesWhereTheSunIsLow) {
  const std::string sun = R"(<emitter type="directional"><vector name="direction" x="-1" y="0.2" z="-0.1"/>
    <rgb name="irradiance" value="1"/></emitter>)";
  const double round = look(ball(the_sphere, sun), 4, 256, 1).mean;
  double last = .2;
  for (const int levels : {2, 3, 4}) {
    const double lost = 1 - look(ball(levels, sun), 4, 256, 1).mean / round;
    std::printf("%d levels: %.5f of the sun's light is lost\n", levels, lost);
    EXPECT_GT(lost, 0);
    EXPECT_LT(lost, last / 2);
    last = lost;
  }
}

}  // namespace
}  // namespace reflectree::render
