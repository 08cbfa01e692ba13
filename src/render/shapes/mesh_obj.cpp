// SPDX-License-Identifier: Apache-2.0
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reflectree/error.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/render/shapes/mesh_files.hpp"

namespace reflectree::render {

void compute_normals(Mesh& mesh) {
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vertex& here = mesh.vertices[t[k]];
      const Point a = mesh.vertices[t[(k + 1) % 3]].at - here.at,
                  b = mesh.vertices[t[(k + 2) % 3]].at - here.at;
      const Direction n = cross(a, b);
      const float size = length(n);
      if (!(size > 0)) continue;
      const float angle = std::atan2(size, dot(a, b));
      here.normal = here.normal + (angle / size) * n;
    }
  }
  for (Vertex& v : mesh.vertices) {
    const float size = length(v.normal);
    v.normal = size > 0 ? (1 / size) * v.normal : Direction{};
  }
}

Mesh read_obj(ByteView bytes, const std::string& path, bool face_normals, bool flip_v) {
  refuse_recognised(bytes, path, "name an OBJ mesh");
  tinyobj::ObjReader reader;
  tinyobj::ObjReaderConfig whole;
  whole.triangulate = false;  // polygons become fans, as in Mitsuba
  if (!reader.ParseFromString(std::string(bytes.begin(), bytes.end()), "", whole)) {
    throw Error("not an OBJ mesh (" + reader.Error() + ")", path, "export it again");
  }
  const auto no_face = [](const tinyobj::shape_t& s) { return s.mesh.indices.empty(); };
  if (std::all_of(reader.GetShapes().begin(), reader.GetShapes().end(), no_face)) {
    throw Error("an OBJ mesh without faces", path, "export it again");
  }
  const auto& a = reader.GetAttrib();
  const auto number = [](const std::vector<float>& v, int i, int width, int k) {
    return i >= 0 ? v[std::size_t(i) * std::size_t(width) + std::size_t(k)] : 0.f;
  };
  const auto there = [](const std::vector<float>& v, int i, int width) {
    return i < 0 || std::size_t(i + 1) * std::size_t(width) <= v.size();
  };
  Mesh mesh;
  mesh.has_uv = false;
  std::map<std::array<int, 3>, std::uint32_t> known;  // corners that share all three share a vertex
  for (const auto& shape : reader.GetShapes()) {
    const auto& corners = shape.mesh.indices;
    const auto& counts = shape.mesh.num_face_vertices;  // bytes
    if (std::accumulate(counts.begin(), counts.end(), std::size_t(0)) != corners.size())
      throw Error("a face of more than 255 corners", path, "export it as triangles");
    std::size_t first = 0;
    for (const std::size_t count : counts) {
      for (std::size_t i = first + 2; i < first + count; ++i) {
        std::array<std::uint32_t, 3> triangle{};
        const std::size_t of[3] = {first, i - 1, i};
        for (std::size_t k = 0; k < 3; ++k) {
          const auto& c = corners[of[k]];
          if (c.vertex_index < 0 || !there(a.vertices, c.vertex_index, 3) ||
              !there(a.texcoords, c.texcoord_index, 2) || !there(a.normals, c.normal_index, 3)) {
            throw Error("a corner that does not exist", path, "export it again");
          }
          const auto [entry, fresh] = known.try_emplace({c.vertex_index, c.texcoord_index, c.normal_index},
                                                        std::uint32_t(mesh.vertices.size()));
          triangle[k] = entry->second;
          if (!fresh) continue;
          Vertex v;
          v.at = {number(a.vertices, c.vertex_index, 3, 0), number(a.vertices, c.vertex_index, 3, 1),
                  number(a.vertices, c.vertex_index, 3, 2)};
          if (!face_normals) {
            v.normal = {number(a.normals, c.normal_index, 3, 0), number(a.normals, c.normal_index, 3, 1),
                        number(a.normals, c.normal_index, 3, 2)};
          }
          v.uv = {number(a.texcoords, c.texcoord_index, 2, 0), number(a.texcoords, c.texcoord_index, 2, 1)};
          if (c.texcoord_index >= 0) {
            mesh.has_uv = true;
            if (flip_v) v.uv.y = 1 - v.uv.y;
          }
          mesh.vertices.push_back(v);
        }
        mesh.triangles.push_back(triangle);
      }
      first += count;
    }
  }
  mesh.smooth = !face_normals && a.normals.empty();
  return mesh;
}

}  // namespace reflectree::render
