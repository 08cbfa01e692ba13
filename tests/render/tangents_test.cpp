// SPDX-License-Identifier: Apache-2.0
// Directions on a surface: tangents are what its points do as u and v grow, and anisotropic materials are
// seen along them.
#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/render/integrators/path_tracer.hpp"
#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

const char* shapes[] = {"sphere", "rectangle", "disk", "cube"};

std::string shape(const std::string& kind, const std::string& words, const std::string& inside) {
  return "<shape type=\"" + kind + "\">" + words +
         "<transform name=\"to_world\"><rotate x=\"1\" y=\"0.5\" angle=\"40\"/><scale value=\"1.3\"/>" +
         (kind == "sphere" ? "" : "<scale x=\"0.7\"/>") + "</transform>" + inside + "</shape>";
}
Scene alone(const std::string& kind, const std::string& words = "") {
  return parse_scene(small_scene("2", shape(kind, words, ""), "0.3,-4,1.4"), "shape.xml");
}

// The largest error of at(u + du, v + dv) = at(u, v) + ... at pairs of near hits, relative.
double worst(const Scene& scene, bool swapped) {
  const EmbreeScene embree(scene);
  Pcg32 u(5);
  double largest = 0;
  for (int found = 0; found < 200;) {
    const auto about = [&](float size) { return size * (2 * to_unit_float(u()) - 1); };
    const Point eye{about(4), about(4), 4};
    const Direction along = normalize(Point{about(.6f), about(.6f), about(.6f)} - eye);
    const Direction beside = normalize(along + Direction{about(1e-3f), about(1e-3f), about(1e-3f)});
    const auto a = embree.intersect({eye, along}), b = embree.intersect({eye, beside});
    if (!a || !b || a->index != b->index) continue;
    const Interaction p = interaction_at(scene, *a, eye, along), q = interaction_at(scene, *b, eye, beside);
    const float x = q.uv.x - p.uv.x, y = q.uv.y - p.uv.y;
    if (std::abs(dot(p.shading, along)) < .3f || std::abs(x) > .1f || std::abs(y) > .1f) continue;
    const Tangents one = tangents_at(scene, *a, p), other = tangents_at(scene, *b, q);
    const Direction du = .5f * (one.du + other.du), dv = .5f * (one.dv + other.dv);
    const Direction step = q.at - p.at, told = swapped ? x * dv + y * du : x * du + y * dv;
    largest = std::max(largest, double(length(told - step) / length(step)));
    ++found;
  }
  return largest;
}

TEST(Tangents, AreHowPointsMoveWithTextureCoordinates) {
  for (const char* kind : shapes) {
    for (const char* words : {"", "<boolean name=\"flip_normals\" value=\"true\"/>"}) {
      const Scene scene = alone(kind, words);
      EXPECT_LT(worst(scene, false), 2e-2) << kind;
      EXPECT_GT(worst(scene, true), .2) << kind << ": u for v";
    }
  }
}

TEST(Tangents, FramesAreRightHandedAndFollowU) {
  const Direction n = normalize(Direction{.3f, -.2f, .9f}), du{2, 1, 0};
  const auto f = frame_along(n, du);
  EXPECT_NEAR(dot(f.s, f.n), 0, 1e-6f);
  EXPECT_NEAR(length(f.s), 1, 1e-6f);
  EXPECT_GT(dot(f.s, du), 0);
  EXPECT_NEAR(dot(cross(f.s, f.t), f.n), 1, 1e-6f);
  for (const Direction none : {Direction{}, 3.f * n}) {
    const auto any = frame_along(n, none);
    EXPECT_NEAR(dot(cross(any.s, any.t), n), 1, 1e-5f);
  }
}

std::string brushed(const std::string& material) {
  return "<bsdf type=\"twosided\"><bsdf type=\"reflectree\"><string name=\"material\" value=\"" + material +
         "\"/></bsdf></bsdf>";
}

Sight seen(const char* kind, const std::string& material, const std::string& sampler) {
  const std::string lamp =
      R"(<shape type="rectangle"><transform name="to_world"><scale value="0.8"/><lookat origin="2,-2,3"
      target="0,0,0" up="0,0,1"/></transform><emitter type="area"><rgb name="radiance" value="4"/></emitter></shape>)";
  SceneOptions options;
  options.sampler = sampler;
  return look(parse_scene(small_scene("2", shape(kind, "", brushed(material)) + lamp, "0.3,-4,1.4"),
                          "brushed.xml", options),
              4, 40, 3);
}

// Two widths exchanged and turned by a quarter: the same metal by another name, and by another sampler.
TEST(Tangents, TurnAnisotropicMaterials) {
  for (const char* kind : {"sphere", "disk"}) {
    const bool once = kind == std::string("disk");  // built in seconds
    const Sight one = seen(kind, "ggx:alpha_x=0.4,alpha_y=0.2", once ? "one-shot" : "cosine");
    EXPECT_TRUE(agreement(one, seen(kind, "ggx:alpha_x=0.2,alpha_y=0.4,phi_deg=90", "cosine"))(1.15)) << kind;
    EXPECT_FALSE(agreement(one, seen(kind, "ggx:alpha_x=0.2,alpha_y=0.4", "cosine"))(1.15)) << kind;
  }
}

// Each pixel of a directional light's picture is f cos in the frame of radius and round of the disk.
TEST(Tangents, DiskIsBrushedByItsRings) {
  Scene scene = parse_scene(
      small_scene("2",
                  "<shape type=\"disk\">" + brushed("ggx:alpha_x=0.3,alpha_y=0.05,f0=1") +
                      R"(</shape><emitter type="directional"><vector name="direction" x="0.4" y="0.2" z="-1"/>
                      <rgb name="irradiance" value="1"/></emitter>)",
                  "0.5,-1.5,2"),
      "rings.xml", {{}, "cosine"});
  const AnyBrdf f = make_brdf(parse_material("ggx:alpha_x=0.3,alpha_y=0.05,f0=1"));
  const EmbreeScene embree(scene);
  PathTracer tracer(scene);
  const Direction sun = -normalize(Direction{.4f, .2f, -1});
  Pcg32 u(3);
  double turned = 0;
  for (int i = 0; i < 100; ++i) {
    const Point at{.9f * (to_unit_float(u()) - .5f), .9f * (to_unit_float(u()) - .5f), 0};
    const Point eye{.5f, -1.5f, 2};
    const Direction along = normalize(at - eye);
    std::vector<CameraRay> rays{{eye, along, PathBits(u)}};
    Rgb found;
    tracer.radiance(rays, {&found, 1});
    const LocalFrame<float> rings{normalize(at), cross(Direction{0, 0, 1}, normalize(at)), {0, 0, 1}};
    const auto value = [&](const LocalFrame<float>& frame) {
      return double(sun.z * to_rgb(eval(f, to_local(frame, -along), to_local(frame, sun))).r);
    };
    EXPECT_NEAR(double(found.r), value(rings), 1e-3 * value(rings) + 1e-5);
    turned = std::max(turned, std::abs(value({rings.t, -rings.s, rings.n}) / value(rings) - 1));
  }
  EXPECT_GT(turned, .5) << "the twin: another frame shows another picture";
}

}  // namespace
}  // namespace reflectree::render
