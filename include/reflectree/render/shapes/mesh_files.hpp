// SPDX-License-Identifier: Apache-2.0
// Triangle meshes from OBJ, PLY and Mitsuba's .serialized files. A mesh without normals is `smooth`, as in
// Mitsuba; with `face_normals` it is not, and each triangle has its own.
#pragma once

#include <string>

#include "reflectree/formats/bytes.hpp"
#include "reflectree/render/scene.hpp"

namespace reflectree::render {

// A value for each vertex or triangle; numbers are grey.
struct MeshAttribute {
  std::string name;  // vertex_... or face_...
  bool of_triangles = false;
  std::vector<Rgb> values;
};
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MeshAttribute> attributes{};  // of PLY
  bool has_uv = true;                       // texture coordinates, at some vertex at least
  bool smooth = false;  // compute_normals is to be called, once the vertices are where they stay
};

// Polygons become fans. `path` is named by errors. Throw Error.
Mesh read_obj(ByteView bytes, const std::string& path, bool face_normals, bool flip_v);
Mesh read_ply(ByteView bytes, const std::string& path, bool face_normals, bool flip_v);
// `index`: of the meshes in the file, from 0.
Mesh read_serialized(ByteView bytes, const std::string& path, int index, bool face_normals);
inline constexpr std::uint64_t largest_mesh_file = std::uint64_t(1) << 32U;

// The triangles' normals, weighted by the angle at the vertex (Thuermer & Wuethrich 1998).
void compute_normals(Mesh& mesh);

}  // namespace reflectree::render
