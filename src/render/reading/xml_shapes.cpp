// SPDX-License-Identifier: Apache-2.0
#include "xml_shapes.hpp"

#include "reflectree/formats/file.hpp"
#include "reflectree/render/shapes/mesh_files.hpp"
#include "shapes/flat.hpp"

namespace reflectree::render {

namespace {

// Six squares from -1 to 1, normals outwards, with Mitsuba's texture coordinates: on each, where u = 0 and
// v = 1, the side along which u grows and the one along which v falls.
Mesh cube() {
  struct Side {
    Point at;
    Direction along_u, against_v;
  };
  const Side sides[] = {{{1, -1, -1}, {0, 0, 1}, {-1, 0, 0}}, {{1, 1, -1}, {-1, 0, 0}, {0, 0, 1}},
                        {{1, -1, -1}, {0, 1, 0}, {0, 0, 1}},  {{1, -1, 1}, {0, 1, 0}, {-1, 0, 0}},
                        {{-1, -1, 1}, {0, 1, 0}, {0, 0, -1}}, {{1, 1, -1}, {0, -1, 0}, {-1, 0, 0}}};
  Mesh all;
  for (const Side& side : sides) {
    const Direction n = cross(side.along_u, side.against_v);
    const auto base = std::uint32_t(all.vertices.size());
    for (const auto& [u, v] : {Uv{0, 1}, Uv{1, 1}, Uv{1, 0}, Uv{0, 0}})
      all.vertices.push_back({side.at + (2 * u) * side.along_u + (2 * (1 - v)) * side.against_v, n, {u, v}});
    all.triangles.push_back({base, base + 1, base + 2});
    all.triangles.push_back({base + 3, base, base + 2});
  }
  return all;
}

bool finite(Direction n) { return std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z); }
bool within_reach(Point p) { return render::within_reach(to_double(p)); }

void add_mesh(const XmlReader& xml, Node n, Mesh mesh, const Matrix& m, bool flip, std::uint32_t surface,
              Scene& scene) {
  using Mapping = Surface::Mapping;
  scene.surfaces[surface].mapping = mesh.has_uv ? Mapping::vertices
                                    : flip      ? Mapping::swapped_corners
                                                : Mapping::corners;
  for (Vertex& v : mesh.vertices) {
    v.at = apply(m, {v.at.x, v.at.y, v.at.z}, 1);
    if (!within_reach(v.at) || !finite(v.normal))
      xml.fail(n, "a corner that does not exist, is not finite or beyond 1e15", "mend the mesh");
    v.normal = apply_to_normal(m, v.normal);
  }
  if (mesh.smooth) compute_normals(mesh);  // of the triangles as they are now
  const auto base = std::uint32_t(scene.vertices.size());
  for (Vertex& v : mesh.vertices) {
    if (flip) v.normal = -v.normal;
    scene.vertices.push_back(v);
  }
  for (auto corner : mesh.triangles) {
    for (std::uint32_t& c : corner) c += base;
    const auto at = [&](std::size_t k) { return scene.vertices[corner[k]].at; };
    if (flip) std::swap(corner[1], corner[2]);
    const float size = length(cross(at(1) - at(0), at(2) - at(0)));
    if (size > 0 && std::isfinite(size)) scene.triangles.push_back({corner, surface});  // others have no area
  }
}

void add_sphere(const XmlReader& xml, Node n, const Matrix& m, bool flip, std::uint32_t surface,
                Scene& scene) {
  const double radius = xml.property(n, "radius", 1);
  const auto axis = [&](Vec3<double> v) { return apply_double(m, v, 0); };
  const auto x = axis({1, 0, 0}), y = axis({0, 1, 0}), z = axis({0, 0, 1});
  const double scale = length(x);
  const auto near = [&](double a, double b) { return std::abs(a - b) <= 1e-5 * scale * scale; };
  if (!near(dot(y, y), scale * scale) || !near(dot(z, z), scale * scale) || !near(dot(x, y), 0) ||
      !near(dot(y, z), 0) || !near(dot(z, x), 0) || !(scale * radius > 0)) {
    xml.fail(n, "the transform makes no sphere of it", "scale it evenly and by more than 0");
  }
  const auto unit = [&](Vec3<double> v) { return to_float((1 / scale) * v); };
  const auto centre = apply_double(m, xml.point(n, "center", {}), 1);
  if (!render::within_reach(centre) || !(radius * scale <= largest_coordinate))
    xml.fail(n, "the sphere reaches beyond 1e15", "use larger units");
  const bool mirrored = dot(cross(x, y), z) < 0;  // turns the sphere inside out, as in Mitsuba
  scene.spheres.push_back({centre, radius * scale, flip != mirrored, {unit(x), unit(y), unit(z)}, surface});
}

void add_flat(const XmlReader& xml, Node n, const Matrix& m, bool flip, std::uint32_t surface,
              std::vector<Flat>& all) {
  const Direction normal = apply_to_normal(m, {0, 0, 1});
  const Flat flat{apply_double(m, {}, 1), apply_double(m, {1, 0, 0}, 0), apply_double(m, {0, 1, 0}, 0),
                  flip ? -normal : normal, surface};
  const double area = rectangle_area(flat);
  for (const double x : {-1., 1.}) {
    if (!within_reach(point_on(flat, x, -1)) || !within_reach(point_on(flat, x, 1)))
      xml.fail(n, "corners that are not finite or beyond 1e15", "mend the transform");
  }
  if (area > 0) all.push_back(flat);
}

}  // namespace

void read_shape(const XmlReader& xml, MaterialReader& materials, Node n, Scene& scene) {
  Surface surface{nullptr, {}};
  bool shines = false;
  for (const Node c : n.children()) {
    if (c.type() != pugi::node_element) continue;
    const Node meant = xml.resolve(c);
    const std::string_view tag = meant.name();
    if (tag == "bsdf") {
      if (surface.scattering) xml.fail(c, "a second material", "keep one of the two");
      surface.scattering = materials.read(meant);
    } else if (tag == "emitter") {
      if (XmlReader::type(meant) != "area") xml.unknown(meant);
      if (shines) xml.fail(c, "a second emitter", "keep one of the two");
      xml.only(meant, {"radiance"});
      shines = true;
      surface.radiance = xml.colour(meant, "radiance", {1, 1, 1}, ColourOf::light);
    } else if (meant != c) {
      xml.fail(c, "a shape cannot refer to a <" + std::string(tag) + ">", "refer to a bsdf or an emitter");
    }
  }
  // As in Mitsuba, what shines and names no material is black, and whatever else names none is grey.
  const Rgb grey{.5f, .5f, .5f};
  if (!surface.scattering) surface.scattering = diffuse({shines ? Rgb{} : grey, nullptr});
  const auto index = std::uint32_t(scene.surfaces.size());
  scene.surfaces.push_back(std::move(surface));

  const std::string type = XmlReader::type(n);
  const Matrix m = xml.transform(XmlReader::named(n, "to_world"));
  const bool flip = xml.flag(n, "flip_normals", false), flat = xml.flag(n, "face_normals", false);
  if (type == "sphere") {
    xml.only(n, {"center", "radius", "to_world", "bsdf", "ref", "emitter", "flip_normals"});
    add_sphere(xml, n, m, flip, index, scene);
    return;
  }
  if (type == "disk" || type == "rectangle" || type == "cube") {
    xml.only(n, {"to_world", "bsdf", "ref", "emitter", "flip_normals"});
    if (type == "cube") {
      add_mesh(xml, n, cube(), m, flip, index, scene);
    } else {
      add_flat(xml, n, m, flip, index, type == "disk" ? scene.disks : scene.rectangles);
    }
  } else if (type == "obj" || type == "ply") {
    xml.only(n, {"filename", "to_world", "bsdf", "ref", "emitter", "face_normals", "flip_normals",
                 "flip_tex_coords"});
    const bool flip_v = xml.flag(n, "flip_tex_coords", type == "obj");
    const std::string path = xml.file(n);
    const auto read = [&] {
      const Bytes bytes = read_file(path, largest_mesh_file);
      return type == "obj" ? read_obj(bytes, path, flat, flip_v) : read_ply(bytes, path, flat, flip_v);
    };
    const Mesh mesh = xml.placed(n, read);
    if (mesh.triangles.empty())
      xml.fail(n, path + " holds no triangles", "name a mesh, or leave the shape out");
    add_mesh(xml, n, mesh, m, flip, index, scene);
  } else {
    xml.unknown(n);
  }
}

}  // namespace reflectree::render
