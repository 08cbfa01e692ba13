// SPDX-License-Identifier: Apache-2.0
// PLY, ASCII or little-endian binary (Turk 1994): vertices with x y z, nx ny nz and u v, s t or
// texture_u texture_v; faces as lists.
#include <algorithm>
#include <bit>
#include <cmath>
#include <sstream>

#include "reflectree/error.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/render/shapes/mesh_files.hpp"

namespace reflectree::render {

namespace {

struct Property {
  std::string name, type, count;  // `count`: type of a list's length; empty: no list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  bool ascii = false;
  std::vector<Element> elements;
  std::size_t bytes = 0;
};

[[noreturn]] void fail(const std::string& what, const std::string& path) {
  throw Error(what, path, "export it again, as ASCII or little-endian PLY");
}

Header read_header(const std::string& text, const std::string& path) {
  if (text.rfind("ply", 0) != 0) refuse_recognised(Bytes(text.begin(), text.end()), path, "name a PLY mesh");
  const std::size_t end = text.find("end_header");
  const std::size_t line_end = end == std::string::npos ? end : text.find('\n', end);
  if (text.rfind("ply", 0) != 0 || line_end == std::string::npos) fail("not a PLY mesh", path);
  Header h;
  h.bytes = line_end + 1;
  std::istringstream lines(text.substr(0, end));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> word;
      if (word != "ascii" && word != "binary_little_endian") fail("no PLY format '" + word + "'", path);
      h.ascii = word == "ascii";
    } else if (word == "element") {
      Element e;
      words >> e.name >> e.count;
      h.elements.push_back(e);
    } else if (word == "property") {
      if (h.elements.empty()) fail("a property of nothing", path);
      Property p;
      words >> p.type;
      if (p.type == "list") words >> p.count >> p.type;
      words >> p.name;
      h.elements.back().properties.push_back(p);
    }
  }
  return h;
}

// One number after the other.
class Numbers {
 public:
  Numbers(ByteView bytes, const Header& header, const std::string& path)
      : in_(bytes, path), text_(), ascii_(header.ascii), path_(path) {
    in_.seek(header.bytes);
    if (ascii_) {
      text_.str(std::string(bytes.begin() + std::ptrdiff_t(header.bytes), bytes.end()));
    }
  }
  double next(const std::string& type) {
    if (ascii_) {
      double v = 0;
      if (!(text_ >> v)) fail("a number is missing", path_);
      return v;
    }
    if (type == "float" || type == "float32") return double(in_.f32());
    if (type == "double" || type == "float64") return in_.f64();
    if (type == "uchar" || type == "uint8") return in_.u8();
    if (type == "char" || type == "int8") return std::int8_t(in_.u8());
    if (type == "ushort" || type == "uint16") return in_.u16();
    if (type == "short" || type == "int16") return std::int16_t(in_.u16());
    if (type == "uint" || type == "uint32") return in_.u32();
    if (type == "int" || type == "int32") return std::int32_t(in_.u32());
    fail("no PLY type '" + type + "'", path_);
  }

 private:
  ByteReader in_;
  std::istringstream text_;
  bool ascii_;
  const std::string& path_;
};

bool has(const Element& e, const std::string& name) {
  return std::any_of(e.properties.begin(), e.properties.end(),
                     [&](const Property& p) { return p.name == name; });
}

// The names of an element's texture coordinates, as Mitsuba chooses them; empty: it has none.
std::pair<std::string, std::string> uv_names(const Element& e) {
  for (const auto& [u, v] : {std::pair{"texture_u", "texture_v"}, {"s", "t"}, {"u", "v"}}) {
    if (has(e, u) && has(e, v)) return {u, v};
  }
  return {};
}

float* field(Vertex& v, const std::string& name, const std::pair<std::string, std::string>& uv) {
  if (name == uv.first) return &v.uv.x;
  if (name == uv.second) return &v.uv.y;
  const std::pair<const char*, float*> all[] = {{"x", &v.at.x},      {"y", &v.at.y},
                                                {"z", &v.at.z},      {"nx", &v.normal.x},
                                                {"ny", &v.normal.y}, {"nz", &v.normal.z}};
  const auto* found = std::find_if(std::begin(all), std::end(all), [&](auto& f) { return name == f.first; });
  return found == std::end(all) ? nullptr : found->second;
}

// Further values as Mitsuba names them: r, g, b or red, green, blue are ..._color; three of one stem and of
// _x _y _z, _r _g _b, _0 _1 _2 or _1 _2 _3 go together under it, and the first of those alone is a number.
struct Extra {
  std::vector<std::size_t> fields;  // of the element's properties: one or three
  MeshAttribute values;
};
std::vector<Extra> extras_of(const Element& e) {
  std::vector<Extra> found;
  const auto place = [&](const std::string& name) {
    const auto at = std::find_if(e.properties.begin(), e.properties.end(),
                                 [&](const Property& p) { return p.name == name && p.count.empty(); });
    return std::size_t(at - e.properties.begin());
  };
  const bool faces = e.name == "face";
  const std::string prefix = faces ? "face_" : "vertex_";
  std::vector<bool> used(e.properties.size());
  const auto three = [&](const std::string& name, const std::string& a, const std::string& b,
                         const std::string& c) {
    const std::size_t at[] = {place(a), place(b), place(c)};
    for (const std::size_t i : at) {
      if (i == e.properties.size() || used[i]) return;
    }
    for (const std::size_t i : at) used[i] = true;
    found.push_back({{at[0], at[1], at[2]}, {prefix + name, faces, {}}});
  };
  three("color", "r", "g", "b"), three("color", "red", "green", "blue");
  for (std::size_t i = 0; i < e.properties.size(); ++i) {
    const std::string& name = e.properties[i].name;
    const std::size_t line = name.rfind('_');
    if (line == std::string::npos || line + 2 != name.size()) continue;
    const std::string stem = name.substr(0, line), own = stem + "_";
    for (const char* ends : {"xyz", "rgb", "012", "123"}) {
      if (name[line + 1] == ends[0]) three(stem, own + ends[0], own + ends[1], own + ends[2]);
    }
  }
  for (std::size_t i = 0; i < e.properties.size(); ++i) {
    const std::string& name = e.properties[i].name;
    const std::size_t line = name.rfind('_');
    if (used[i] || line == std::string::npos || line + 2 != name.size()) continue;
    if (!e.properties[i].count.empty() || std::string("xr01").find(name[line + 1]) == std::string::npos)
      continue;
    found.push_back({{i}, {prefix + name.substr(0, line), faces, {}}});
  }
  return found;
}

void add_face(Mesh& mesh, const std::vector<double>& corners, const std::string& path) {
  for (const double c : corners) {
    if (!(c >= 0 && c < double(mesh.vertices.size()))) fail("a corner that does not exist", path);
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.push_back(
        {std::uint32_t(corners[0]), std::uint32_t(corners[i - 1]), std::uint32_t(corners[i])});
  }
}

}  // namespace

Mesh read_ply(ByteView bytes, const std::string& path, bool face_normals, bool flip_v) {
  const Header header = read_header(std::string(bytes.begin(), bytes.end()), path);
  Numbers numbers(bytes, header, path);
  Mesh mesh;
  bool normals = false;
  std::vector<double> list;
  for (const Element& e : header.elements) {
    if (e.properties.empty()) continue;
    const auto uv = uv_names(e);
    if (e.name == "vertex") {
      mesh.has_uv = !uv.first.empty();
      normals = has(e, "nx") && has(e, "ny") && has(e, "nz");
    }
    if (e.name == "face" && has(e, "texcoord"))
      throw Error("texture coordinates of faces are not read", path, "export those of vertices");
    std::vector<Extra> extras;
    if (e.name == "vertex" || e.name == "face") extras = extras_of(e);
    std::vector<float> fields(e.properties.size());
    for (std::uint64_t i = 0; i < e.count; ++i) {
      Vertex vertex;
      const std::size_t triangles = mesh.triangles.size();
      for (std::size_t k = 0; k < e.properties.size(); ++k) {
        const Property& p = e.properties[k];
        if (p.count.empty()) {
          const double v = numbers.next(p.type);
          fields[k] = float(v);
          float* at = e.name == "vertex" ? field(vertex, p.name, uv) : nullptr;
          if (at) *at = float(v);
          continue;
        }
        const double count = numbers.next(p.count);
        if (!(count >= 0 && count <= double(bytes.size()))) fail("a list of impossible length", path);
        list.clear();
        for (double n = 0; n < count; ++n) list.push_back(numbers.next(p.type));
        if (e.name == "face" && p.name.rfind("vertex_ind", 0) == 0) add_face(mesh, list, path);
      }
      if (flip_v) vertex.uv.y = 1 - vertex.uv.y;
      if (e.name == "vertex") mesh.vertices.push_back(vertex);
      for (Extra& x : extras) {
        const Rgb v = x.fields.size() == 1
                          ? to_rgb(fields[x.fields[0]])
                          : Rgb{fields[x.fields[0]], fields[x.fields[1]], fields[x.fields[2]]};
        if (!std::isfinite(v.r + v.g + v.b)) fail("'" + x.values.name + "' is not finite", path);
        x.values.values.insert(x.values.values.end(),
                               x.values.of_triangles ? mesh.triangles.size() - triangles : 1, v);
      }
    }
    for (Extra& x : extras) mesh.attributes.push_back(std::move(x.values));
  }
  const auto has_faces = [](const Element& e) { return e.name == "face" && e.count > 0; };
  if (std::none_of(header.elements.begin(), header.elements.end(), has_faces)) {
    fail("a PLY mesh without faces", path);
  }
  if (face_normals || !normals) {
    for (Vertex& v : mesh.vertices) v.normal = {};
  }
  mesh.smooth = !face_normals && !normals;
  return mesh;
}

}  // namespace reflectree::render
