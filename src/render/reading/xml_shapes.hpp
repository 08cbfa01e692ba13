// SPDX-License-Identifier: Apache-2.0
// <shape>: its vertices, triangles, spheres, disks, ..., its material, and the light it gives.
// Instances are copies.
#pragma once

#include "reflectree/render/shapes/mesh_files.hpp"
#include "xml_materials.hpp"

namespace reflectree::render {

class ShapeReader {
 public:
  ShapeReader(const XmlReader& xml, MaterialReader& materials, Scene& scene)
      : xml_(xml), materials_(materials), scene_(scene) {}
  void read(Node n) { read(n, identity, false); }

 private:
  // `placed`: what acts on the shape in its place. `instance`: of a group, whose shapes do not shine.
  void read(Node n, const Matrix& placed, bool instance);
  void read_instance(Node n, const Matrix& placed, bool instance);
  std::uint32_t surface_of(Node n, bool instance);
  Mesh mesh(Node n);
  void add_mesh(Node n, Mesh mesh, const Matrix& m, const Matrix& placed, bool flip, std::uint32_t surface);
  void add_attributes(Node n, const Mesh& mesh, std::uint32_t surface);
  void add_sphere(Node n, const Matrix& m, bool flip, std::uint32_t surface);
  void add_cylinder(Node n, const Matrix& m, bool flip, std::uint32_t surface);
  void add_flat(Node n, const Matrix& m, bool flip, std::uint32_t surface, std::vector<Flat>& all);

  const XmlReader& xml_;
  MaterialReader& materials_;
  Scene& scene_;
  std::map<std::ptrdiff_t, Mesh> known_;  // meshes of groups, by place in the file
  int nested_ = 0;                        // instances in instances
};

}  // namespace reflectree::render
