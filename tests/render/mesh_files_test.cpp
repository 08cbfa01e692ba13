// SPDX-License-Identifier: Apache-2.0
// Damaged meshes: whatever bytes a PLY or OBJ file holds, a scene with it ends in a picture or in an Error.
#include <gtest/gtest.h>

#include <fstream>

#include "../scratch.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::render {
namespace {

std::string binary_ply() {
  std::string s =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const float corners[] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
  const std::int32_t face[] = {0, 1, 2};
  s.append(reinterpret_cast<const char*>(corners), sizeof corners).append(1, '\3');
  return s.append(reinterpret_cast<const char*>(face), sizeof face);
}

const std::string ascii_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
    "float "
    "nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int "
    "vertex_indices\nend_header\n"
    "-1 -1 0 0 0 1\n1 -1 0 0 0 1\n1 1 0 0 0 1\n-1 1 0 0 0 1\n4 0 1 2 3\n";

const std::string obj = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\n";

enum class End { picture, error };

End end_of(const std::string& kind, const std::string& bytes) {
  const std::string name = "mesh." + kind;
  std::ofstream(scratch(name), std::ios::binary) << bytes;
  const std::string xml = R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective">
    <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform><film type="hdrfilm">
    <integer name="width" value="2"/><integer name="height" value="2"/></film></sensor><emitter type="constant"/>
    <shape type=")" + kind +
                          "\"><string name=\"filename\" value=\"" + name + "\"/></shape></scene>";
  try {
    const Image image = render(parse_scene(xml, scratch("scene.xml")), {.samples = 1});
    for (const float v : image.values) EXPECT_TRUE(std::isfinite(v));
    return End::picture;
  } catch (const Error&) {
    return End::error;
  }
}

std::string damaged(std::string s, Pcg32& u) {
  const auto below = [&](std::size_t n) { return std::size_t((std::uint64_t(u()) * n) >> 32U); };
  for (std::size_t i = 0, n = 1 + below(4); i < n && !s.empty(); ++i) {
    const std::size_t at = below(s.size());
    switch (below(5)) {
      case 0:
        s[at] = char(u());
        break;
      case 1:
        s.resize(at);
        break;
      case 2:
        s.insert(at, s.substr(below(s.size()), below(16)));
        break;
      case 3:
        s.erase(at, 1 + below(8));
        break;
      default:
        s[at] = "0123456789-/e. \n"[below(16)];
    }
  }
  return s;
}

TEST(MeshFiles, DamagedOnesEndInAPictureOrAnError) {
  Pcg32 u(11);
  for (const auto& [kind, seed] :
       {std::pair<std::string, std::string>{"ply", binary_ply()}, {"ply", ascii_ply}, {"obj", obj}}) {
    EXPECT_EQ(end_of(kind, seed), End::picture);
    int pictures = 0, errors = 0;
    for (int i = 0; i < 600; ++i) ++(end_of(kind, damaged(seed, u)) == End::picture ? pictures : errors);
    EXPECT_GT(pictures, 20) << kind << ": some damage does not matter";
    EXPECT_GT(errors, 20) << kind << ": and some is seen";
  }
}

TEST(MeshFiles, ImpossibleCountsAndCornersAreErrors) {
  const auto with = [](const std::string& old, const std::string& now) {
    std::string s = ascii_ply;
    return s.replace(s.find(old), old.size(), now);
  };
  EXPECT_EQ(end_of("ply", with("vertex 4", "vertex 400000000000")), End::error);
  EXPECT_EQ(end_of("ply", with("4 0 1 2 3", "4 0 1 2 4")), End::error);
  EXPECT_EQ(end_of("ply", with("4 0 1 2 3", "4 0 1 2 -1")), End::error);
  EXPECT_EQ(end_of("ply", with("-1 -1 0", "nan -1 0")), End::error);
  EXPECT_EQ(end_of("ply", with("4 0 1 2 3", "2 0 1")), End::error) << "no triangle at all";
  EXPECT_EQ(end_of("obj", "f 1 2 3\n"), End::error);
}

}  // namespace
}  // namespace reflectree::render
