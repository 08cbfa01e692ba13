// SPDX-License-Identifier: Apache-2.0
// Mitsuba 3's XML: what is known is read, everything else is an Error with line and column.
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <pugixml.hpp>

#include "reflectree/brdf/number_text.hpp"
#include "reflectree/error.hpp"
#include "reflectree/io/file.hpp"
#include "reflectree/io/material_file.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/render/scene.hpp"
#include "scene_colour.hpp"

namespace reflectree::render {

namespace {

using Node = pugi::xml_node;
using Matrix = std::array<std::array<double, 4>, 4>;
using Names = std::initializer_list<std::string_view>;

constexpr Matrix identity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix m{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) m[i][j] += a[i][k] * b[k][j];
    }
  }
  return m;
}

Point apply(const Matrix& m, Vec3<double> p, double w) {
  const auto row = [&](std::size_t i) {
    return float(m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3] * w);
  };
  return {row(0), row(1), row(2)};
}

class Reader {
 public:
  Reader(std::string_view xml, const std::string& path, const SceneOptions& options, const Host& host)
      : xml_(xml), path_(path), options_(options), host_(host), defines_(options.defines) {}

  Scene read() {
    pugi::xml_document document;
    const auto parsed = document.load_buffer(xml_.data(), xml_.size());
    if (!parsed) throw Error(parsed.description(), place(parsed.offset), "mend the XML");
    root_ = document.child("scene");
    if (!root_) throw Error("no <scene>", path_, "name a Mitsuba 3 scene");
    for (const Node n : root_.children("default"))
      defines_.try_emplace(n.attribute("name").value(), n.attribute("value").value());
    for (const Node n : root_.children()) {
      const std::string_view tag = n.name();
      if (tag == "integrator")
        read_integrator(n);
      else if (tag == "sensor")
        read_sensor(n);
      else if (tag == "shape")
        read_shape(n);
      else if (tag == "emitter")
        read_emitter(n);
      else if (tag != "default" && tag != "bsdf")
        fail(n, "<" + std::string(tag) + "> is not known here", "leave it out");
    }
    if (scene_.width == 0) throw Error("no <sensor>", path_, "add a perspective sensor");
    return std::move(scene_);
  }

 private:
  std::string place(std::ptrdiff_t offset) const {
    const std::string_view before = xml_.substr(0, std::size_t(std::max<std::ptrdiff_t>(offset, 0)));
    const std::size_t newline = before.rfind('\n');
    return path_ + ":" + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" +
           std::to_string(before.size() - (newline == std::string_view::npos ? 0 : newline + 1));
  }
  [[noreturn]] void fail(Node n, const std::string& what, const std::string& how) const {
    throw Error(what, place(n.offset_debug()), how);
  }
  std::string text(Node n, const char* attribute) const {
    std::string value = n.attribute(attribute).value();
    if (value.empty() || value[0] != '$') return value;
    const auto at = defines_.find(value.substr(1));
    if (at == defines_.end()) fail(n, "nothing defines " + value, "give -D " + value.substr(1) + "=VALUE");
    return at->second;
  }
  std::vector<double> numbers(Node n, const std::string& words) const {
    std::vector<double> found;
    const char* at = words.c_str();
    for (;;) {
      while (*at == ' ' || *at == ',' || *at == '\n' || *at == '\t') ++at;
      if (!*at) return found;
      char* end = nullptr;
      found.push_back(std::strtod(at, &end));
      if (end == at || !std::isfinite(found.back()))
        fail(n, "no finite number in '" + words + "'", "write numbers");
      at = end;
    }
  }
  double number(Node n, const char* attribute, double otherwise) const {
    const auto found = numbers(n, text(n, attribute));
    return found.empty() ? otherwise : found[0];
  }
  // Everything inside `n` must be one of these, by name or, where it has none, by tag.
  void only(Node n, Names known) const {
    for (const Node c : n.children()) {
      const char* name = c.attribute("name").value();
      const std::string_view word = *name ? name : c.name();
      if (std::find(known.begin(), known.end(), word) == known.end()) {
        fail(c, "'" + std::string(word) + "' is not known in <" + n.name() + " type=\"" + type(n) + "\">",
             "leave it out");
      }
    }
  }
  static std::string type(Node n) { return n.attribute("type").value(); }
  static Node named(Node n, const char* name) { return n.find_child_by_attribute("name", name); }
  double property(Node n, const char* name, double otherwise) const {
    const Node c = named(n, name);
    return c ? number(c, "value", otherwise) : otherwise;
  }
  [[noreturn]] void unknown(Node n) const {
    fail(n, "no " + std::string(n.name()) + " '" + type(n) + "' is known", "use another");
  }

  Vec3<double> triple(Node n, const char* attribute) const {
    const auto v = numbers(n, text(n, attribute));
    if (v.size() != 3) fail(n, std::string(attribute) + " needs three numbers", "write x, y, z");
    return {v[0], v[1], v[2]};
  }
  Matrix transform(Node n) const {
    Matrix all = identity;
    for (const Node op : n.children()) {
      const std::string_view tag = op.name();
      Matrix m = identity;
      if (tag == "translate" || tag == "scale") {
        const double other = tag == "scale" ? number(op, "value", 1) : 0;
        const double v[3] = {number(op, "x", other), number(op, "y", other), number(op, "z", other)};
        for (std::size_t i = 0; i < 3; ++i) (tag == "scale" ? m[i][i] : m[i][3]) = v[i];
      } else if (tag == "rotate") {
        const auto a = normalize(Vec3<double>{number(op, "x", 0), number(op, "y", 0), number(op, "z", 0)});
        const double t = number(op, "angle", 0) * pi_v<double> / 180, c = std::cos(t), s = std::sin(t);
        const double axis[3] = {a.x, a.y, a.z};  // Rodrigues
        const double turn[3][3] = {{0, -a.z, a.y}, {a.z, 0, -a.x}, {-a.y, a.x, 0}};
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j)
            m[i][j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j] + s * turn[i][j];
        }
      } else if (tag == "lookat") {
        const auto o = triple(op, "origin"), d = normalize(triple(op, "target") - o);
        const auto left = normalize(cross(triple(op, "up"), d)), up = cross(d, left);
        m = {{{left.x, up.x, d.x, o.x}, {left.y, up.y, d.y, o.y}, {left.z, up.z, d.z, o.z}, {0, 0, 0, 1}}};
      } else {
        fail(op, "no transform '" + std::string(tag) + "'", "use translate, scale, rotate or lookat");
      }
      all = m * all;
    }
    for (const auto& row : all) {
      for (const double v : row) {
        if (!std::isfinite(v)) fail(n, "the transform is not finite", "check axes, up and target");
      }
    }
    return all;
  }

  Rgb colour(Node n, const char* name, Rgb otherwise, bool reflectance) const {
    const Node c = named(n, name);
    if (!c) return otherwise;
    const std::string_view tag = c.name();
    const std::string value = text(c, "value");
    if (tag == "spectrum" && value.find(':') != std::string::npos) {
      std::string plain = value;
      std::replace(plain.begin(), plain.end(), ':', ' ');
      const auto v = numbers(c, plain);
      SampledSpectrum s;
      for (std::size_t i = 0; i + 1 < v.size(); i += 2) {
        if (!s.empty() && !(v[i] > s.back().first)) fail(c, "wavelengths do not ascend", "sort them");
        s.emplace_back(v[i], v[i + 1]);
      }
      return to_linear_srgb(s, reflectance);
    }
    if (tag != "rgb" && tag != "spectrum")
      fail(c, "no colour '" + std::string(tag) + "'", "use rgb or spectrum");
    const auto v = numbers(c, value);
    if (v.size() == 1) return to_rgb(float(v[0]));
    if (v.size() != 3) fail(c, "a colour has one or three numbers", "write r, g, b");
    return {float(v[0]), float(v[1]), float(v[2])};
  }

  void read_integrator(Node n) {
    if (type(n) != "path") unknown(n);
    only(n, {"max_depth", "rr_depth"});
    scene_.max_depth = int(property(n, "max_depth", -1)), scene_.rr_depth = int(property(n, "rr_depth", 5));
  }

  void read_sensor(Node n) {
    if (type(n) != "perspective") unknown(n);
    only(n, {"fov", "fov_axis", "near_clip", "far_clip", "focus_distance", "to_world", "sampler", "film"});
    const Node film = n.child("film"), sampler = n.child("sampler");
    if (type(film) != "hdrfilm") unknown(film ? film : n);
    if (sampler && type(sampler) != "independent") unknown(sampler);
    only(film, {"width", "height", "rfilter", "pixel_format"});
    if (type(film.child("rfilter")) != "box")
      fail(film, "the filter is not box", "write <rfilter type=\"box\"/>");
    const double width = property(film, "width", 768), height = property(film, "height", 576);
    const double samples = property(sampler, "sample_count", 16);
    if (!(width >= 1 && height >= 1 && width <= 65536 && height <= 65536))
      fail(film, "a film without pixels", "give it a positive width and height");
    if (!(samples >= 1 && samples <= 1e9))
      fail(sampler, "sample_count is not positive", "give a positive number");
    scene_.width = int(width), scene_.height = int(height), scene_.samples = int(samples);
    const Node axis = named(n, "fov_axis");
    const std::string along = axis ? text(axis, "value") : "x";
    if (along != "x" && along != "y" && along != "smaller")
      fail(axis, "no fov_axis '" + along + "'", "use x, y or smaller");
    const bool vertical = along == "y" || (along == "smaller" && height < width);
    const float t = float(std::tan(property(n, "fov", 50) * pi_v<double> / 360)),
                aspect = float(width / height);
    const Matrix m = transform(named(n, "to_world"));
    scene_.camera = {apply(m, {}, 1),
                     normalize(apply(m, {1, 0, 0}, 0)),
                     normalize(apply(m, {0, 1, 0}, 0)),
                     normalize(apply(m, {0, 0, 1}, 0)),
                     vertical ? t * aspect : t,
                     vertical ? t : t / aspect};
  }

  // The element itself or what a <ref> names; one level of references is all that has a meaning.
  Node resolve(Node n) const {
    if (std::string_view(n.name()) != "ref") return n;
    const char* id = n.attribute("id").value();
    const Node found = root_.find_child_by_attribute("id", id);
    if (!found || std::string_view(found.name()) == "ref")
      fail(n, "no element has the id '" + std::string(id) + "'", "check the id");
    return found;
  }

  Surface read_surface(Node n, int depth = 0) {
    if (depth > 8) fail(n, "materials refer to each other in a circle", "break the circle of ids");
    Surface s;
    if (type(n) == "twosided") {
      Node inside;
      for (const Node c : n.children()) inside = resolve(c);
      if (!inside) fail(n, "nothing inside", "put a bsdf there");
      s = read_surface(inside, depth + 1), s.two_sided = true;
    } else if (type(n) == "diffuse") {
      only(n, {"reflectance"});
      s.albedo = colour(n, "reflectance", s.albedo, true);
    } else if (type(n) == "reflectree") {
      only(n, {"material"});
      const Material material = parse_material(text(named(n, "material"), "value"));
      s.f = make_brdf(material,
                      [this](const std::string& p, const std::string& m) { return load_brdf(beside(p), m); });
      const SamplerInfo* info = find_sampler(options_.sampler);
      if (!info)
        throw Error("no sampler '" + options_.sampler + "'", "--sampler", "'exact' and 'one-shot' are ours");
      s.sampler = info->make({*s.f, material, {}}, host_);
      if (!s.sampler)
        throw Error("'" + options_.sampler + "' does not take this material", "--sampler", "choose another");
    } else {
      unknown(n);
    }
    return s;
  }

  std::string beside(const std::string& file) const {
    return (std::filesystem::path(path_).parent_path() / file).string();
  }

  void read_shape(Node n) {
    only(n, {"filename", "to_world", "bsdf", "ref", "emitter", "face_normals"});
    Surface surface;
    Rgb radiance;
    for (const Node c : n.children()) {
      const Node meant = resolve(c);
      const std::string_view tag = meant.name();
      if (tag == "bsdf") surface = read_surface(meant);
      if (tag == "emitter") {
        if (type(meant) != "area") unknown(meant);
        radiance = colour(meant, "radiance", {1, 1, 1}, false);
      }
    }
    const Matrix m = transform(named(n, "to_world"));
    scene_.surfaces.push_back(std::move(surface));
    const auto base = std::uint32_t(scene_.points.size());
    if (type(n) == "rectangle") {
      for (const auto& p : {Vec3<double>{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}})
        scene_.points.push_back(apply(m, p, 1));
      add(n, base, {0, 1, 2}, radiance), add(n, base, {0, 2, 3}, radiance);
    } else if (type(n) == "obj") {
      read_obj(n, m, base, radiance);
    } else {
      unknown(n);
    }
  }

  void add(Node n, std::uint32_t base, std::array<std::uint32_t, 3> corner, Rgb radiance) {
    for (std::uint32_t& c : corner) {
      c += base;
      if (c >= scene_.points.size() || !is_finite(scene_.points[c]))
        fail(n, "a corner that does not exist or is not finite", "mend the mesh");
    }
    const Point a = scene_.points[corner[0]];
    const float size = length(cross(scene_.points[corner[1]] - a, scene_.points[corner[2]] - a));
    if (!(size > 0)) return;  // a degenerate triangle has no area to be seen by
    scene_.triangles.push_back({corner, std::uint32_t(scene_.surfaces.size() - 1), radiance});
  }

  // Whether a flat triangle's vertex normals point against its own: they say which side is the front. Normals
  // that are not the triangle's own are refused, not ignored.
  bool turned(Node n, const tinyobj::attrib_t& a, const tinyobj::index_t* corner) const {
    const auto at = [](const std::vector<float>& v, int i) {
      const std::size_t k = 3 * std::size_t(i);
      return i >= 0 && k + 2 < v.size() ? Point{v[k], v[k + 1], v[k + 2]} : Point{};
    };
    const Point p = at(a.vertices, corner[0].vertex_index);
    const Point own =
        cross(at(a.vertices, corner[1].vertex_index) - p, at(a.vertices, corner[2].vertex_index) - p);
    if (!(length(own) > 0)) return false;
    float least = 1, most = -1;
    for (int k = 0; k < 3; ++k) {
      const Point given = at(a.normals, corner[k].normal_index);
      const float cosine = dot(given, own) / (length(given) * length(own));
      least = std::min(least, cosine), most = std::max(most, cosine);
    }
    if (!(least > .999f || most < -.999f)) {
      fail(n, "the mesh has shading normals, which are not interpolated yet", "set face_normals to true");
    }
    return most < 0;
  }

  void read_obj(Node n, const Matrix& m, std::uint32_t base, Rgb radiance) {
    const std::string file = beside(text(named(n, "filename"), "value"));
    const Bytes bytes = read_file(file, std::uint64_t(1) << 32U);
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(std::string(bytes.begin(), bytes.end()), "")) {
      throw Error("not an OBJ mesh (" + reader.Error() + ")", file, "export it again");
    }
    const auto& a = reader.GetAttrib();
    const Node flat = named(n, "face_normals");
    const bool smooth = !a.normals.empty() && !(flat && text(flat, "value") == "true");
    for (std::size_t i = 0; i + 2 < a.vertices.size(); i += 3) {
      scene_.points.push_back(apply(m, {a.vertices[i], a.vertices[i + 1], a.vertices[i + 2]}, 1));
    }
    for (const auto& shape : reader.GetShapes()) {
      const auto& v = shape.mesh.indices;
      for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
        std::array<std::uint32_t, 3> corner{};
        for (std::size_t k = 0; k < 3; ++k) corner[k] = std::uint32_t(v[i + k].vertex_index);
        if (smooth && turned(n, a, &v[i])) std::swap(corner[1], corner[2]);
        add(n, base, corner, radiance);
      }
    }
  }

  void read_emitter(Node n) {
    if (type(n) == "area" && n.attribute("id")) return;  // reached through references
    if (type(n) != "constant") unknown(n);
    only(n, {"radiance"});
    scene_.sky = scene_.sky + colour(n, "radiance", {1, 1, 1}, false);
  }

  std::string_view xml_;
  const std::string& path_;
  const SceneOptions& options_;
  const Host& host_;
  std::map<std::string, std::string> defines_;
  Node root_;
  Scene scene_;
};

}  // namespace

Scene parse_scene(std::string_view xml, const std::string& path, const SceneOptions& options,
                  const Host& host) {
  return Reader(xml, path, options, host).read();
}

Scene load_scene(const std::string& path, const SceneOptions& options, const Host& host) {
  const Bytes bytes = read_file(path, std::uint64_t(1) << 26U);
  return parse_scene(std::string(bytes.begin(), bytes.end()), path, options, host);
}

}  // namespace reflectree::render
