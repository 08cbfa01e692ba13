// SPDX-License-Identifier: Apache-2.0
// The readers of the render room: meshes and scenes.
#include <cmath>

#include "expect.hpp"
#include "reflectree/render/film.hpp"
#include "reflectree/render/mesh_files.hpp"
#include "targets.hpp"

namespace reflectree::fuzz {
namespace {

using namespace render;

void require_sound(const Mesh& mesh) {
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size());
  }
}

void run_ply(ByteView bytes) {
  for (const bool flat : {false, true})
    expect_error_or_success([&] { require_sound(read_ply(bytes, "mesh", flat, flat)); });
}

void run_obj(ByteView bytes) {
  for (const bool flat : {false, true})
    expect_error_or_success([&] { require_sound(read_obj(bytes, "mesh", flat, flat)); });
}

// Any text, with the cheapest sampler; a path of four edges or fewer through one pixel of what is read.
void run_scene(ByteView bytes) {
  const std::string text(bytes.begin(), bytes.end());
  expect_error_or_success([&] {
    SceneOptions options;
    options.sampler = "cosine";
    Scene scene = parse_scene(text, "nowhere/scene.xml", options);
    scene.width = scene.height = scene.samples = 1;
    scene.max_depth = 4;
    scene.transport = {};
    const Image image = render::render(scene, {.samples = 1});
    require(image.values.size() == 6);
  });
}

Bytes as_bytes(std::string_view text) { return {text.begin(), text.end()}; }

constexpr std::string_view corners =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty "
    "float v\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";

std::vector<Bytes> ply_seeds() {
  Bytes binary;
  append_text(binary, "ply\nformat binary_little_endian 1.0\n");
  append_text(binary, corners);
  for (const float v : {-1.f, -1.f, 0.f, 0.f, 0.f, 1.f,  -1.f, 0.f, 1.f, 0.f,
                        1.f,  1.f,  .5f, 1.f, 1.f, -1.f, 1.f,  0.f, 0.f, 1.f})
    append_f32(binary, v);
  for (const std::uint32_t third : {2U, 3U}) {
    binary.push_back(3);
    for (const std::uint32_t corner : {0U, third - 1, third}) append_u32(binary, corner);
  }
  const std::string text = "ply\nformat ascii 1.0\ncomment by hand\n" + std::string(corners) +
                           "-1 -1 0 0 0\n1 -1 0 1 0\n1 1 .5 1 1\n-1 1 0 0 1\n3 0 1 2\n4 0 1 2 3\n";
  return {binary, as_bytes(text)};
}

std::vector<Bytes> obj_seeds() {
  return {
      as_bytes("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\n"
               "f 1 2 3 4\n"),
      as_bytes("o a\ng b\nusemtl c\ns 1\nv 0 0 0\nv 1 0 0 1\nv 0 1e0 0\nv 1 1 0\nv 2 .5 0\nf -5//1 -4 -3\n"
               "f 1 2 5 4 3\nl 1 2\np 1\n")};
}

std::vector<Bytes> scene_seeds() {
  const auto with = [](const std::string& rest) {
    return as_bytes(R"(<scene version="3.0.0"><default name="n" value="4"/><integrator type="path">
<integer name="max_depth" value="$n"/></integrator><sensor type="perspective"><float name="fov" value="45"/>
<transform name="to_world"><lookat origin="0,-4,1" target="0,0,0" up="0,0,1"/></transform>
<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="4"/><rfilter type="tent"/></film>
<sampler type="stratified"><integer name="sample_count" value="4"/></sampler></sensor>)" +
                    rest + "</scene>");
  };
  return {
      with(
          R"(<bsdf type="twosided" id="a"><bsdf type="diffuse"><rgb name="reflectance" value="#a0b0c0"/></bsdf>
</bsdf><shape type="rectangle"><transform name="to_world"><scale value="3"/></transform><ref id="a"/></shape>
<shape type="sphere"><point name="center" x="0" y="0" z="1"/><float name="radius" value=".5"/>
<bsdf type="roughconductor"><float name="alpha" value=".2"/><string name="material" value="Cu"/></bsdf></shape>
<emitter type="constant"><rgb name="radiance" value="1 .5 .2"/></emitter>)"),
      with(R"(<shape type="cube"><transform name="to_world"><rotate x="1" y="1" angle="30"/></transform>
<bsdf type="blendbsdf"><float name="weight" value=".3"/><bsdf type="plastic"/><bsdf type="dielectric"/></bsdf></shape>
<shape type="disk"><transform name="to_world"><rotate x="1" angle="180"/><translate z="3"/></transform>
<emitter type="area"><spectrum name="radiance" value="400:1, 700:2"/></emitter></shape>
<emitter type="point"><point name="position" value="1,2,3"/></emitter>
<emitter type="directional"><vector name="direction" value="0,0,-1"/></emitter>)"),
      with(
          R"(<shape type="sphere"><bsdf type="reflectree"><string name="material" value="lambert:rho=0.5"/></bsdf>
</shape>)")};
}

}  // namespace

std::span<const Target> targets() {
  static const Target all[] = {
      {"ply", run_ply, ply_seeds}, {"obj", run_obj, obj_seeds}, {"scene", run_scene, scene_seeds}};
  return all;
}

}  // namespace reflectree::fuzz
