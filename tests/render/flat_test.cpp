// SPDX-License-Identifier: Apache-2.0
// Rectangles and disks against extended precision: where rays meet them, what their edges let by, how they
// are drawn as lamps. The twins are the same shapes made of triangles, whose corners and hits are floats.
#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/math/random.hpp"
#include "reflectree/render/lights/lights.hpp"
#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

using Exact = Vec3<long double>;
Exact exact(Vec3<double> p) { return {p.x, p.y, p.z}; }
Exact exact(Point p) { return {p.x, p.y, p.z}; }

// The plane first, then its coordinates by the normal equations: another way than the renderer's.
struct Truth {
  long double distance, x, y;
  Exact at;
};
Truth truth(const Flat& f, const Ray& ray) {
  const Exact s = exact(f.s), t = exact(f.t), o = exact(ray.origin), d = exact(ray.direction);
  const Exact n = cross(s, t);
  const long double distance = dot(exact(f.centre) - o, n) / dot(d, n);
  const Exact at = o + distance * d, from = at - exact(f.centre);
  const long double ss = dot(s, s), st = dot(s, t), tt = dot(t, t), determinant = ss * tt - st * st;
  return {distance, (dot(from, s) * tt - dot(from, t) * st) / determinant,
          (dot(from, t) * ss - dot(from, s) * st) / determinant, at};
}

double between(Pcg32& u, double low, double high) { return low + (high - low) * to_unit_double(u()); }
Vec3<double> within(Pcg32& u, double size) {
  return {between(u, -size, size), between(u, -size, size), between(u, -size, size)};
}
Point rounded(Vec3<double> p) { return {float(p.x), float(p.y), float(p.z)}; }

// A leaning parallelogram of about `size`, about that far from the world's origin.
Flat leaning(Pcg32& u, double size) {
  const Vec3<double> s = within(u, size), turned = cross(s, within(u, 1));
  const Vec3<double> t = turned + between(u, -.5, .5) * s;
  const auto n = normalize(cross(s, t));
  return {within(u, size), s, t, rounded(n), 0};
}

// Towards (x, y) of the shape, at `sine` above its plane.
Ray towards(Pcg32& u, const Flat& f, double x, double y, double sine) {
  const Vec3<double> n = normalize(cross(f.s, f.t)), along = normalize(cross(n, within(u, 1)));
  const Vec3<double> at = f.centre + x * f.s + y * f.t;
  const double distance = between(u, .5, 2) * length(f.s);
  const Point origin = rounded(at + distance * (sine * n + std::sqrt(1 - sine * sine) * along));
  const Vec3<double> to = at - Vec3<double>{origin.x, origin.y, origin.z};
  return {origin, rounded(normalize(to))};
}

enum class Made { of_one_plane, of_triangles };
Scene shown(const Flat& f, Made made, bool disk = false) {
  Scene scene;
  scene.surfaces.push_back({diffuse({{.5f, .5f, .5f}, nullptr}), {1, 1, 1}});
  if (made == Made::of_one_plane) {
    (disk ? scene.disks : scene.rectangles).push_back(f);
    return scene;
  }
  add_triangles(scene, f, f.normal);
  return scene;
}

// The largest error of 2000 hits: of distances in units of their last place, of positions in those of their
// largest coordinate, and of texture coordinates in units of 2^-24.
struct Errors {
  double distance = 0, position = 0, uv = 0;
  int missed = 0;
};
void grow(double& so_far, long double error) { so_far = std::max(so_far, std::abs(double(error))); }
long double largest(Exact p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
double last_place(double x) { return std::ldexp(1., std::ilogb(x) - 23); }
Errors errors(double size, double sine, Made made) {
  Errors worst;
  Pcg32 u(7);
  for (int shape = 0; shape < 100; ++shape) {
    const Flat f = leaning(u, size);
    const Scene scene = shown(f, made);
    const EmbreeScene embree(scene);
    for (int i = 0; i < 20; ++i) {
      const Ray ray = towards(u, f, between(u, -.9, .9), between(u, -.9, .9), sine);
      const Truth t = truth(f, ray);
      if (std::abs(t.x) > .99L || std::abs(t.y) > .99L || !(t.distance > 0)) continue;  // the ray was rounded
      const auto hit = embree.intersect(ray);
      if (!hit) {
        ++worst.missed;
        continue;
      }
      const Interaction on = interaction_at(scene, *hit, ray.origin, ray.direction);
      const Exact off = exact(on.at) - t.at;
      grow(worst.distance, ((long double)hit->distance - t.distance) / last_place(double(t.distance)));
      grow(worst.position, largest(off) / last_place(double(largest(t.at))));
      grow(worst.uv, ((long double)on.uv.x - (t.x + 1) / 2) * 0x1p24L);
      grow(worst.uv, ((long double)on.uv.y - (t.y + 1) / 2) * 0x1p24L);
    }
  }
  return worst;
}
bool correctly_rounded(const Errors& e) {
  return e.missed == 0 && e.distance < .51 && e.position < .51 && e.uv < .51;
}

TEST(Flat, HitsAreCorrectlyRoundedAtEveryScaleAndAngle) {
  for (const double size : {1e-3, 1., 1e6}) {
    for (const double sine : {1., .1, 1e-4}) {
      const Errors e = errors(size, sine, Made::of_one_plane), twin = errors(size, sine, Made::of_triangles);
      EXPECT_TRUE(correctly_rounded(e)) << size << ", " << sine << ": " << e.missed << ", " << e.distance
                                        << ", " << e.position << ", " << e.uv;
      EXPECT_FALSE(correctly_rounded(twin)) << size << ", " << sine << ": triangles are not that good";
      if (sine < .01) {
        EXPECT_GT(std::max(twin.distance, double(twin.missed)), 100) << "and far from it when grazed";
      }
    }
  }
}

// Rays towards points a few floats from the edge: the shape decides as extended precision does.
int wrong_at_edges(bool disk, double size, Made made) {
  int wrong = 0, inside = 0, outside = 0;
  Pcg32 u(11);
  for (int shape = 0; shape < 200; ++shape) {
    const Flat f = leaning(u, size);
    const Scene scene = shown(f, made, disk);
    const EmbreeScene embree(scene);
    for (int i = 0; i < 20; ++i) {
      const double rim = 1 + between(u, -1e-6, 1e-6), phi = between(u, 0, 2 * M_PI);
      const double x = disk ? rim * std::cos(phi) : rim, y = disk ? rim * std::sin(phi) : between(u, -.9, .9);
      const Ray ray = towards(u, f, x, y, between(u, .3, 1));
      const Truth t = truth(f, ray);
      const long double beyond = disk ? t.x * t.x + t.y * t.y - 1 : std::abs(t.x) - 1;
      if (std::abs(beyond) < 1e-12L) continue;  // what double precision cannot tell
      const bool met = bool(embree.intersect(ray)), hits = beyond < 0;
      ++(hits ? inside : outside);
      wrong += met != hits || met != embree.occluded(ray);
    }
  }
  EXPECT_GT(std::min(inside, outside), 1000) << "both sides are tried";
  return wrong;
}

TEST(Flat, EdgesAreWhereTheyAre) {
  for (const double size : {1e-3, 1e6}) {
    EXPECT_EQ(wrong_at_edges(false, size, Made::of_one_plane), 0) << size;
    EXPECT_EQ(wrong_at_edges(true, size, Made::of_one_plane), 0) << size;
    EXPECT_GT(wrong_at_edges(false, size, Made::of_triangles), 100) << size << ": the twin";
  }
}

// Rectangles, disks, balls and triangles among each other, by single rays and in packets.
TEST(Flat, PacketsMeetWhatSingleRaysMeet) {
  Pcg32 u(5);
  Scene scene;
  for (std::uint32_t i = 0; i < 40; ++i) {
    scene.surfaces.push_back({diffuse({{.5f, .5f, .5f}, nullptr}), {}});
    Flat f = leaning(u, 1);
    f.surface = i;
    if (i % 4 == 0) scene.rectangles.push_back(f);
    if (i % 4 == 1) scene.disks.push_back(f);
    if (i % 4 == 2) scene.spheres.push_back({f.centre, .2, false, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, i});
    if (i % 4 == 3) add_triangles(scene, f, f.normal);
  }
  const EmbreeScene embree(scene);
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    const Vec3<double> from = within(u, 3);
    rays.push_back({rounded(from), rounded(normalize(within(u, 1) - from)), 0, i % 3 == 0 ? 3.f : 1e30f});
  }
  for (const bool coherent : {false, true}) {
    std::vector<std::optional<Hit>> hits(rays.size());
    std::vector<std::uint8_t> shadows(rays.size());
    embree.intersect(rays, coherent, hits);
    embree.occluded(rays, shadows);
    std::array<int, 4> met{};
    int open = 0, mixed = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto hit = embree.intersect(rays[i]);
      ASSERT_EQ(bool(hit), bool(hits[i])) << i;
      ASSERT_EQ(embree.occluded(rays[i]), shadows[i] != 0) << i;
      ASSERT_EQ(bool(hit), shadows[i] != 0) << i;
      if (!hit) {
        ++open;
        continue;
      }
      ++met[std::size_t(hit->kind)];
      mixed += i > 0 && hits[i - 1] && hits[i - 1]->index != hit->index;
      const Interaction on = interaction_at(scene, *hits[i], rays[i].origin, rays[i].direction);
      ASSERT_EQ(hit->kind, hits[i]->kind);
      ASSERT_EQ(hit->index, hits[i]->index);
      ASSERT_NEAR(hit->distance, hits[i]->distance, 1e-5f);
      ASSERT_EQ(surface_of(scene, *hits[i]), on.surface);
      ASSERT_EQ(on.surface % 4, (std::array{3U, 2U, 0U, 1U}[std::size_t(hit->kind)])) << "its own kind's";
    }
    for (const int n : met) EXPECT_GT(n, 50);
    EXPECT_GT(open, 50);
    EXPECT_GT(mixed, 50) << "the twin: neighbours meet different things";
  }
}

// The solid angle of a triangle (van Oosterom & Strackee 1983).
double solid_angle(Vec3<double> a, Vec3<double> b, Vec3<double> c) {
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(std::abs(dot(a, cross(b, c))),
                        la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

// A lamp seen from a point: what is drawn lies on it evenly, has the density that a hit there is given, and
// the mean of 1 / pdf is the solid angle.
TEST(Flat, LampsAreDrawnEvenlyWithTheDensityOfTheirHits) {
  Pcg32 bits(3);
  const Flat f{{1, 2, 3},
               {.8, .1, .2},
               {-.3, .9, .1},
               rounded(normalize(cross(Vec3<double>{.8, .1, .2}, {-.3, .9, .1}))),
               0};
  const Point eye = rounded(f.centre + Vec3<double>{.3, -.4, 1.2});
  const Vec3<double> from = f.centre - Vec3<double>{eye.x, eye.y, eye.z};
  const auto corner = [&](double x, double y) { return from + x * f.s + y * f.t; };
  for (const bool disk : {false, true}) {
    const Scene scene = shown(f, Made::of_one_plane, disk);
    const Lights lights(scene);
    const EmbreeScene embree(scene);
    PathBits u(bits);
    constexpr int n = 100000;
    double sum = 0, squares = 0, xx = 0, xy = 0, yy = 0;
    for (int i = 0; i < n; ++i) {
      const auto drawn = lights.sample(eye, u);
      ASSERT_TRUE(drawn);
      sum += 1 / double(drawn->pdf), squares += 1 / (double(drawn->pdf) * double(drawn->pdf));
      const auto hit = embree.intersect({eye, drawn->direction});
      if (!hit) continue;  // an edge
      const Interaction on = interaction_at(scene, *hit, eye, drawn->direction);
      EXPECT_NEAR(lights.pdf(eye, drawn->direction, *hit, on) / drawn->pdf, 1, 1e-5);
      EXPECT_NEAR(hit->distance / drawn->distance, 1, 1e-6);
      xx += hit->u * hit->u / n, xy += hit->u * hit->v / n, yy += hit->v * hit->v / n;
    }
    const double mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n),
                 even = disk ? .25 : 1 / 3.;
    EXPECT_NEAR(xx, even, .005);
    EXPECT_NEAR(yy, even, .005);
    EXPECT_NEAR(xy, 0, .005);
    // The disk by a fan of 4096 triangles.
    double expected = solid_angle(corner(-1, -1), corner(1, -1), corner(1, 1)) +
                      solid_angle(corner(-1, -1), corner(1, 1), corner(-1, 1));
    if (disk) {
      expected = 0;
      const auto rim = [&](int k) { return corner(std::cos(k * M_PI / 2048), std::sin(k * M_PI / 2048)); };
      for (int k = 0; k < 4096; ++k) expected += solid_angle(from, rim(k), rim(k + 1));
    }
    EXPECT_LT(std::abs(mean - expected), 4.5 * error) << disk;
    EXPECT_GT(std::abs(1.02 * mean - expected), 4.5 * error) << disk << ": an area 2 % too large is seen";
  }
}

TEST(Flat, NormalsFollowMirrorsAndFlipsAndTextureCoordinatesDoNot) {
  for (const std::string type : {"rectangle", "disk"}) {
    const auto seen = [&](const std::string& scale, const std::string& flip) {
      const Scene scene = parse_scene(
          small_scene("2",
                      "<shape type=\"" + type + "\"><transform name=\"to_world\"><scale " + scale +
                          "/></transform><boolean name=\"flip_normals\" value=\"" + flip + "\"/></shape>",
                      "0,-4,1"),
          "flat.xml");
      const Point above{.5f, .25f, 1};
      const auto hit = EmbreeScene(scene).intersect({above, {0, 0, -1}});
      return interaction_at(scene, *hit, above, {0, 0, -1});
    };
    const Interaction plain = seen("x=\"1\"", "false"), flipped = seen("x=\"1\"", "true"),
                      mirrored = seen("x=\"-1\"", "false"), inverted = seen("z=\"-1\"", "false");
    EXPECT_EQ(plain.shading, (Direction{0, 0, 1}));
    EXPECT_EQ(flipped.shading, (Direction{0, 0, -1}));
    EXPECT_EQ(mirrored.shading, (Direction{0, 0, 1}));
    EXPECT_EQ(inverted.shading, (Direction{0, 0, -1}));
    EXPECT_EQ(plain.uv, flipped.uv);
    EXPECT_EQ(plain.uv, inverted.uv);
    EXPECT_NE(plain.uv, mirrored.uv);
    if (type == "rectangle") {
      EXPECT_EQ(plain.uv, (Uv{.75f, .625f}));
    }
  }
}

}  // namespace
}  // namespace reflectree::render
