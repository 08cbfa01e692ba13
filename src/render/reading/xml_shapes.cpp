// SPDX-License-Identifier: Apache-2.0
#include "xml_shapes.hpp"

#include <algorithm>

#include "reflectree/formats/file.hpp"
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

constexpr std::size_t most_vertices = std::size_t(1) << 28U;

}  // namespace

// Normals that the mesh has not are those of its triangles where a group keeps it, before it is placed.
void ShapeReader::add_mesh(Node n, Mesh mesh, const Matrix& m, const Matrix& placed, bool flip,
                           std::uint32_t surface) {
  using Mapping = Surface::Mapping;
  scene_.surfaces[surface].mapping = mesh.has_uv ? Mapping::vertices
                                     : flip      ? Mapping::swapped_corners
                                                 : Mapping::corners;
  if (scene_.vertices.size() + mesh.vertices.size() > most_vertices)
    xml_.fail(n, "more than 2^28 vertices with all instances", "leave some out");
  const bool twice = placed != identity;
  for (Vertex& v : mesh.vertices) {
    v.at = apply(m, {v.at.x, v.at.y, v.at.z}, 1);
    v.normal = apply_to_normal(m, v.normal);
  }
  if (mesh.smooth && twice) compute_normals(mesh);
  for (Vertex& v : mesh.vertices) {
    if (twice)
      v.at = apply(placed, {v.at.x, v.at.y, v.at.z}, 1), v.normal = apply_to_normal(placed, v.normal);
    if (!within_reach(v.at) || !finite(v.normal))
      xml_.fail(n, "a corner that does not exist, is not finite or beyond 1e15", "mend the mesh");
  }
  if (mesh.smooth && !twice) compute_normals(mesh);  // of the triangles as they are now
  const auto base = std::uint32_t(scene_.vertices.size());
  scene_.surfaces[surface].first_vertex = base;
  scene_.surfaces[surface].first_triangle = std::uint32_t(scene_.triangles.size());
  for (Vertex& v : mesh.vertices) {
    if (flip) v.normal = -v.normal;
    scene_.vertices.push_back(v);
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    auto corner = mesh.triangles[i];
    for (std::uint32_t& c : corner) c += base;
    const auto at = [&](std::size_t k) { return scene_.vertices[corner[k]].at; };
    if (flip) std::swap(corner[1], corner[2]);
    const float size = length(cross(at(1) - at(0), at(2) - at(0)));
    if (!(size > 0 && std::isfinite(size))) continue;  // has no area
    scene_.triangles.push_back({corner, surface}), kept.push_back(i);
  }
  for (MeshAttribute& a : mesh.attributes) {
    if (!a.of_triangles) continue;
    for (std::size_t i = 0; i < kept.size(); ++i) a.values[i] = a.values[kept[i]];
  }
  add_attributes(n, mesh, surface);
}

void ShapeReader::add_attributes(Node n, const Mesh& mesh, std::uint32_t index) {
  Surface& surface = scene_.surfaces[index];
  const std::uint32_t asked = materials_.attributes_of(surface.scattering);
  const auto& names = materials_.attribute_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!(asked >> i & 1U)) continue;
    const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                    [&](const MeshAttribute& a) { return a.name == names[i]; });
    if (found == mesh.attributes.end()) {
      std::string all;
      for (const MeshAttribute& a : mesh.attributes) all += (all.empty() ? "" : ", ") + a.name;
      xml_.fail(n, "no attribute '" + names[i] + "', which its material asks for",
                all.empty() ? "name a PLY mesh that has it" : "it has " + all);
    }
    surface.attributes.resize(std::max(surface.attributes.size(), i + 1));
    surface.attributes[i] = {found->of_triangles, found->values};
  }
}

void ShapeReader::add_sphere(Node n, const Matrix& m, bool flip, std::uint32_t surface) {
  const double radius = xml_.property(n, "radius", 1);
  const auto axis = [&](Vec3<double> v) { return apply_double(m, v, 0); };
  const auto x = axis({1, 0, 0}), y = axis({0, 1, 0}), z = axis({0, 0, 1});
  const double scale = length(x);
  const auto near = [&](double a, double b) { return std::abs(a - b) <= 1e-5 * scale * scale; };
  if (!near(dot(y, y), scale * scale) || !near(dot(z, z), scale * scale) || !near(dot(x, y), 0) ||
      !near(dot(y, z), 0) || !near(dot(z, x), 0) || !(scale * radius > 0)) {
    xml_.fail(n, "the transform makes no sphere of it", "scale it evenly and by more than 0");
  }
  const auto unit = [&](Vec3<double> v) { return to_float((1 / scale) * v); };
  const auto centre = apply_double(m, xml_.point(n, "center", {}), 1);
  if (!render::within_reach(centre) || !(radius * scale <= largest_coordinate))
    xml_.fail(n, "the sphere reaches beyond 1e15", "use larger units");
  const bool mirrored = dot(cross(x, y), z) < 0;  // turns the sphere inside out, as in Mitsuba
  scene_.spheres.push_back({centre, radius * scale, flip != mirrored, {unit(x), unit(y), unit(z)}, surface});
}

// From p0 to p1; without lids.
void ShapeReader::add_cylinder(Node n, const Matrix& m, bool flip, std::uint32_t surface) {
  const double radius = xml_.property(n, "radius", 1);
  const Vec3<double> p0 = xml_.point(n, "p0", {}), p1 = xml_.point(n, "p1", {0, 0, 1}), along = p1 - p0;
  if (!(radius > 0 && length(along) > 0)) xml_.fail(n, "a cylinder without a size", "mend radius, p0 and p1");
  const LocalFrame<double> frame = frame_from_normal(normalize(along));
  const Vec3<double> s = apply_double(m, radius * frame.s, 0), t = apply_double(m, radius * frame.t, 0),
                     axis = apply_double(m, along, 0), base = apply_double(m, p0, 1);
  const double size = length(s);
  const auto square = [](Vec3<double> a, Vec3<double> b) {
    return std::abs(dot(a, b)) <= 1e-5 * length(a) * length(b);
  };
  if (!(size > 0 && length(axis) > 0) || std::abs(length(t) - size) > 1e-5 * size || !square(s, t) ||
      !square(s, axis) || !square(t, axis))
    xml_.fail(n, "the transform makes no cylinder of it", "scale it evenly across and do not shear it");
  if (!render::within_reach(base) || !render::within_reach(base + axis) || !(size <= largest_coordinate))
    xml_.fail(n, "the cylinder reaches beyond 1e15", "use larger units");
  scene_.cylinders.push_back({base, s, t, axis, flip, surface});
}

void ShapeReader::add_flat(Node n, const Matrix& m, bool flip, std::uint32_t surface,
                           std::vector<Flat>& all) {
  const Direction normal = apply_to_normal(m, {0, 0, 1});
  const Flat flat{apply_double(m, {}, 1), apply_double(m, {1, 0, 0}, 0), apply_double(m, {0, 1, 0}, 0),
                  flip ? -normal : normal, surface};
  const double area = rectangle_area(flat);
  for (const double x : {-1., 1.}) {
    if (!within_reach(point_on(flat, x, -1)) || !within_reach(point_on(flat, x, 1)))
      xml_.fail(n, "corners that are not finite or beyond 1e15", "mend the transform");
  }
  if (area > 0) all.push_back(flat);
}

std::uint32_t ShapeReader::surface_of(Node n, bool instance) {
  Surface surface{nullptr, {}};
  bool shines = false;
  for (const Node c : n.children()) {
    if (c.type() != pugi::node_element) continue;
    const Node meant = xml_.resolve(c);
    const std::string_view tag = meant.name();
    if (tag == "bsdf") {
      if (surface.scattering) xml_.fail(c, "a second material", "keep one of the two");
      surface.scattering = materials_.read(meant);
    } else if (tag == "emitter") {
      if (XmlReader::type(meant) != "area") xml_.unknown(meant);
      if (shines) xml_.fail(c, "a second emitter", "keep one of the two");
      if (instance) xml_.fail(c, "a lamp in a group", "put it outside");
      xml_.only(meant, {"radiance"});
      shines = true;
      if (const auto texture = materials_.emission(meant, "radiance")) {
        surface.radiance = mean(*texture);
        if (texture->picture) surface.shine = std::make_shared<const Texture>(*texture);
      } else {
        surface.radiance = xml_.colour(meant, "radiance", {1, 1, 1}, ColourOf::light);
      }
    } else if (meant != c) {
      xml_.fail(c, "a shape cannot refer to a <" + std::string(tag) + ">", "refer to a bsdf or an emitter");
    }
  }
  // As in Mitsuba, what shines and names no material is black, and whatever else names none is grey.
  const Rgb grey{.5f, .5f, .5f};
  if (!surface.scattering) surface.scattering = diffuse({shines ? Rgb{} : grey, nullptr});
  scene_.surfaces.push_back(std::move(surface));
  return std::uint32_t(scene_.surfaces.size() - 1);
}

// A group's mesh is read once for all its instances.
Mesh ShapeReader::mesh(Node n) {
  const auto known = known_.find(n.offset_debug());
  if (known != known_.end()) return known->second;
  const std::string type = XmlReader::type(n);
  const bool serialized = type == "serialized", flat = xml_.flag(n, "face_normals", false);
  const int which = xml_.integer(n, "shape_index", 0);
  if (which < 0) xml_.fail(XmlReader::named(n, "shape_index"), "a number below 0", "write 0 or more");
  const bool flip_v = xml_.flag(n, "flip_tex_coords", type == "obj");
  const std::string path = xml_.file(n);
  const auto read = [&] {
    const Bytes bytes = read_file(path, largest_mesh_file);
    if (serialized) return read_serialized(bytes, path, which, flat);
    return type == "obj" ? read_obj(bytes, path, flat, flip_v) : read_ply(bytes, path, flat, flip_v);
  };
  Mesh made = xml_.placed(n, read);
  if (made.triangles.empty())
    xml_.fail(n, path + " holds no triangles", "name a mesh, or leave the shape out");
  if (nested_ > 0) known_[n.offset_debug()] = made;
  return made;
}

void ShapeReader::read_instance(Node n, const Matrix& placed, bool instance) {
  xml_.only(n, {"to_world", "ref", "shape"});
  if (instance && ++nested_ > 8) xml_.fail(n, "instances nested deeper than 8", "break the circle of groups");
  Node group;
  for (const Node c : n.children()) {
    if (c.type() != pugi::node_element || c.name() == std::string_view("transform")) continue;
    const Node meant = xml_.resolve(c);
    if (meant.name() != std::string_view("shape") || XmlReader::type(meant) != "shapegroup")
      xml_.fail(c, "an instance of a <" + std::string(meant.name()) + ">", "refer to a shapegroup");
    if (group) xml_.fail(c, "a second group", "keep one of the two");
    group = meant;
  }
  if (!group) xml_.fail(n, "an instance of nothing", "refer to a shapegroup");
  const Matrix m = placed * xml_.transform(XmlReader::named(n, "to_world"));
  ++nested_;
  for (const Node c : group.children()) {
    if (c.type() != pugi::node_element) continue;
    const Node meant = xml_.resolve(c);
    if (meant.name() != std::string_view("shape")) xml_.fail(c, "a group holds shapes alone", "leave it out");
    read(meant, m, true);
  }
  --nested_;
  if (instance) --nested_;
}

void ShapeReader::read(Node n, const Matrix& placed, bool instance) {
  const std::string type = XmlReader::type(n);
  if (type == "shapegroup") {
    if (instance) xml_.fail(n, "a group in a group", "put an instance of it there");
    return;  // seen through its instances
  }
  if (type == "instance") return read_instance(n, placed, instance);
  const std::uint32_t surface = surface_of(n, instance);
  const Matrix m = xml_.transform(XmlReader::named(n, "to_world"));
  const bool flip = xml_.flag(n, "flip_normals", false);
  const auto no_attributes = [&] { add_attributes(n, {}, surface); };
  if (type == "sphere") {
    xml_.only(n, {"center", "radius", "to_world", "bsdf", "ref", "emitter", "flip_normals"});
    no_attributes(), add_sphere(n, placed * m, flip, surface);
  } else if (type == "cylinder") {
    xml_.only(n, {"p0", "p1", "radius", "to_world", "bsdf", "ref", "emitter", "flip_normals"});
    no_attributes(), add_cylinder(n, placed * m, flip, surface);
  } else if (type == "disk" || type == "rectangle") {
    xml_.only(n, {"to_world", "bsdf", "ref", "emitter", "flip_normals"});
    no_attributes(),
        add_flat(n, placed * m, flip, surface, type == "disk" ? scene_.disks : scene_.rectangles);
  } else if (type == "cube") {
    xml_.only(n, {"to_world", "bsdf", "ref", "emitter", "flip_normals"});
    add_mesh(n, cube(), m, placed, flip, surface);
  } else if (type == "obj" || type == "ply" || type == "serialized") {
    xml_.only(n, {"filename", "to_world", "bsdf", "ref", "emitter", "face_normals", "flip_normals",
                  type == "serialized" ? "shape_index" : "flip_tex_coords"});
    add_mesh(n, mesh(n), m, placed, flip, surface);
  } else {
    xml_.unknown(n);
  }
}

}  // namespace reflectree::render
