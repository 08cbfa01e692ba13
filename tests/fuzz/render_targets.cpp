// SPDX-License-Identifier: Apache-2.0
// The readers of the render room: pictures, meshes and scenes.
#include <cmath>

#include "../scratch.hpp"
#include "expect.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/picture/image.hpp"
#include "reflectree/render/film/film.hpp"
#include "reflectree/render/shapes/mesh_files.hpp"
#include "targets.hpp"

namespace reflectree::fuzz {
namespace {

using namespace render;

// A picture as it comes, then its colours.
template <Image read(ByteView, const std::string&)>
void run_picture(ByteView bytes) {
  expect_error_or_success([&] {
    const Image all = read(bytes, "picture");
    require(all.values.size() == std::size_t(all.width) * std::size_t(all.height) * all.channels.size());
    for (const bool raw : {false, true}) {
      const Image shown = colours_of(all, "picture", raw);
      require(shown.channels.size() == 1 || shown.channels.size() == 3);
      for (const float v : shown.values) require(std::isfinite(v));
    }
  });
}

void require_sound(const Mesh& mesh) {
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size());
  }
}

void run_ply(ByteView bytes) {
  for (const bool flat : {false, true})
    expect_error_or_success([&] { require_sound(read_ply(bytes, "mesh", flat, flat)); });
}

void run_serialized(ByteView bytes) {
  for (const int index : {0, 1})
    expect_error_or_success([&] { require_sound(read_serialized(bytes, "mesh", index, index > 0)); });
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

// 2 x 1 pixels of 16 bits, grey with alpha; PNG's own sums of bytes are right.
Bytes grey16() {
  return {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
          0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x04, 0x00, 0x00, 0x00, 0x0e,
          0xbb, 0x6b, 0x42, 0x00, 0x00, 0x00, 0x11, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x78,
          0x95, 0xc0, 0xfc, 0x82, 0x81, 0xf5, 0xff, 0x7f, 0x00, 0x11, 0x9f, 0x04, 0x39, 0xd7, 0x36,
          0x60, 0x11, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
}

constexpr std::string_view corners =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty "
    "float v\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";

Bytes file_of(void (*write)(const std::string&, const Image&), const char* name, const Image& image) {
  const std::string path = scratch(name);
  write(path, image);
  return read_file(path, 1U << 20U);
}

Image spots(std::vector<std::string> channels) {
  Image image = make_image(5, 3, std::move(channels));
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(i % 7) / 7;
  return image;
}

std::vector<Bytes> png_seeds() {
  const auto write = [](const std::string& path, const Image& image) { write_png(path, image); };
  return {file_of(write, "seed.png", spots({"R", "G", "B"})), grey16()};
}
std::vector<Bytes> exr_seeds() {
  return {file_of(write_exr, "seed.exr", spots({"R", "G", "B", "A"})),
          file_of(write_exr, "seed.exr", spots({"diffuse.R", "diffuse.G", "diffuse.B"})),
          file_of(write_exr, "seed.exr", spots({"Y", "Z"}))};
}
std::vector<Bytes> hdr_seeds() {
  Bytes flat = as_bytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
  Bytes coded = as_bytes("#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n");
  for (const int v : {128, 64, 0, 129, 1, 2, 3, 0}) flat.push_back(std::uint8_t(v));
  for (const int v : {2, 2, 0, 8, 136, 128, 136, 64, 136, 32, 136, 129}) coded.push_back(std::uint8_t(v));
  return {flat, coded};
}

// 2 x 2 pixels, 24 bits each.
std::vector<Bytes> bmp_seeds() {
  Bytes plain = as_bytes("BM");
  for (const std::uint32_t v : {70U, 0U, 54U, 40U, 2U, 2U, 0x180001U, 0U, 16U, 0U, 0U, 0U, 0U})
    append_u32(plain, v);
  for (int i = 0; i < 16; ++i) plain.push_back(std::uint8_t(16 * i));
  return {plain};
}
std::vector<Bytes> tga_seeds() {
  Bytes plain{0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0}, coded = plain;
  for (int i = 0; i < 12; ++i) plain.push_back(std::uint8_t(20 * i));
  coded[2] = 10;
  for (const int v : {0x81, 10, 20, 30, 1, 1, 2, 3, 4, 5, 6}) coded.push_back(std::uint8_t(v));
  return {plain, coded};
}
// Of one block of 8 x 8, grey, all alike; by libjpeg's standard tables cut to what it needs.
std::vector<Bytes> jpeg_seeds() {
  Bytes b;
  for (const int v : {0xff, 0xd8, 0xff, 0xdb, 0, 67, 0}) b.push_back(std::uint8_t(v));
  for (int i = 0; i < 64; ++i) b.push_back(1);
  for (const int v : {0xff, 0xc0, 0,  11,   8,    0, 8, 0, 8, 1, 1, 0x11, 0, 0xff, 0xc4, 0,   20, 0,
                      1,    0,    0,  0,    0,    0, 0, 0, 0, 0, 0, 0,    0, 0,    0,    0,   6,  0xff,
                      0xc4, 0,    20, 0x10, 1,    0, 0, 0, 0, 0, 0, 0,    0, 0,    0,    0,   0,  0,
                      0,    0,    0,  0xff, 0xda, 0, 8, 1, 1, 0, 0, 63,   0, 0x54, 0xff, 0xd9})
    b.push_back(std::uint8_t(v));
  return {b};
}

// Stored blocks: a triangle of floats with a name, and one of doubles with coordinates.
Bytes stored(const Bytes& raw) {
  Bytes out;
  const auto put = [&](std::uint32_t v) { out.push_back(std::uint8_t(v)); };
  const auto size = std::uint32_t(raw.size());
  for (const std::uint32_t v : {0x78U, 0x01U, 0x01U, size, size >> 8U, ~size, ~size >> 8U}) put(v);
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t v : raw) put(v), a = (a + v) % 65521, b = (b + a) % 65521;
  for (const std::uint32_t v : {b >> 8U, b, a >> 8U, a}) put(v);
  return out;
}
std::vector<Bytes> serialized_seeds() {
  const auto mesh = [](bool wide) {
    Bytes raw;
    append_u32(raw, wide ? 0x2002U : 0x1000U);
    append_text(raw, "name"), raw.push_back(0);
    append_u64(raw, 3), append_u64(raw, 1);
    for (int i = 0; i < (wide ? 15 : 9); ++i) {
      if (wide)
        append_f64(raw, i % 4 - 1);
      else
        append_f32(raw, float(i % 4 - 1));
    }
    for (const std::uint32_t c : {0U, 1U, 2U}) append_u32(raw, c);
    Bytes out{0x1c, 0x04, 0x04, 0x00};
    for (const std::uint8_t v : stored(raw)) out.push_back(v);
    return out;
  };
  Bytes both = mesh(false);
  const std::size_t second = both.size();
  for (const std::uint8_t v : mesh(true)) both.push_back(v);
  append_u64(both, 0), append_u64(both, second), append_u32(both, 2);
  return {mesh(true), both};
}

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
      with(R"(<shape type="cube"><transform name="to_world"><scale x="-1"/></transform><bsdf type="diffuse">
<texture type="checkerboard" name="reflectance"><rgb name="color0" value=".9 .2 .1"/><transform name="to_uv">
<scale x="3"/></transform></texture></bsdf></shape><shape type="sphere"><bsdf type="roughconductor">
<texture type="checkerboard" name="alpha"/><spectrum name="eta" value="400:1, 700:2"/></bsdf></shape>
<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>)"),
      with(R"(<path value="."/><alias id="a" as="b"/><shape type="shapegroup" id="g"><shape type="cylinder">
<float name="radius" value=".5"/><point name="p1" value="0,1,1"/><bsdf type="bumpmap"><texture type="checkerboard" name="x"/>
<bsdf type="roughconductor"><float name="alpha_u" value=".1"/><float name="alpha_v" value=".3"/></bsdf></bsdf></shape>
<shape type="cube"><bsdf type="normalmap"><texture type="checkerboard" name="normalmap"/><bsdf type="diffuse"/></bsdf></shape>
</shape><shape type="instance"><ref id="g"/><transform name="to_world"><scale value=".5"/></transform></shape>
<shape type="instance"><ref id="g"/></shape><emitter type="spot"><float name="cutoff_angle" value="40"/></emitter>
<shape type="disk"><bsdf type="mask"><texture type="checkerboard" name="opacity"/><bsdf type="thindielectric"/></bsdf></shape>
<shape type="cylinder"><emitter type="area"><texture type="checkerboard" name="radiance"/></emitter></shape>)"),
      with(
          R"(<shape type="sphere"><bsdf type="reflectree"><string name="material" value="lambert:rho=0.5"/></bsdf>
</shape>)"),
      as_bytes(R"(<scene version="3.0.0"><integrator type="direct"><integer name="emitter_samples" value="0"/>
<integer name="bsdf_samples" value="2"/></integrator><sampler type="independent" id="s"/><rfilter type="box" id="r"/>
<film type="hdrfilm" id="f"><integer name="width" value="9"/><integer name="height" value="7"/><ref id="r"/>
<integer name="crop_offset_x" value="2"/><integer name="crop_offset_y" value="1"/><integer name="crop_width" value="4"/>
<integer name="crop_height" value="3"/></film><sensor type="thinlens"><float name="aperture_radius" value="0.2"/>
<float name="focus_distance" value="3"/><float name="fov" value="50"/><ref id="s"/><ref id="f"/></sensor>
<emitter type="projector"><rgb name="irradiance" value="1, 2, 3"/><float name="scale" value="2"/></emitter>
<shape type="sphere"><point name="center" value="0, 0, 4"/><bsdf type="diffuse"><texture type="rawconstant"
name="reflectance"><vector name="value" value="0.2, 0.4, 0.6"/></texture></bsdf></shape></scene>)"),
      as_bytes(
          R"(<scene version="3.0.0"><sensor type="orthographic"><transform name="to_world"><scale x="2" y="1.5"/>
<translate z="-3"/></transform><float name="near_clip" value="0.5"/><film type="hdrfilm"/></sensor>
<shape type="cube"/><emitter type="constant"/></scene>)")};
}

}  // namespace

std::span<const Target> targets() {
  static const Target all[] = {{"png", run_picture<read_png>, png_seeds},
                               {"exr", run_picture<read_exr>, exr_seeds},
                               {"hdr", run_picture<read_hdr>, hdr_seeds},
                               {"jpeg", run_picture<read_jpeg>, jpeg_seeds},
                               {"bmp", run_picture<read_bmp>, bmp_seeds},
                               {"tga", run_picture<read_tga>, tga_seeds},
                               {"ply", run_ply, ply_seeds},
                               {"serialized", run_serialized, serialized_seeds},
                               {"obj", run_obj, obj_seeds},
                               {"scene", run_scene, scene_seeds}};
  return all;
}

}  // namespace reflectree::fuzz
