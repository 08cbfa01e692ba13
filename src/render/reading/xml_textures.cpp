// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "xml_materials.hpp"

namespace reflectree::render {

// The part of a transform that turns (u, v): Mitsuba leaves out the third row and column.
std::array<float, 6> MaterialReader::to_uv(Node t) const {
  const Matrix m = xml_.transform(XmlReader::named(t, "to_uv"));
  return {float(m[0][0]), float(m[0][1]), float(m[0][3]), float(m[1][0]), float(m[1][1]), float(m[1][3])};
}

// A picture from 8 or 16 bits is in sRGB unless it is `raw`.
Texture MaterialReader::bitmap(Node t) const {
  using Wrap = Texture::Wrap;
  xml_.only(t, {"filename", "filter_type", "wrap_mode", "raw", "to_uv", "format", "accel"});
  Texture made;
  const std::string wrap = xml_.word(t, "wrap_mode", "repeat"),
                    filter = xml_.word(t, "filter_type", "bilinear");
  if (wrap != "repeat" && wrap != "mirror" && wrap != "clamp")
    xml_.fail(t, "no wrap_mode '" + wrap + "'", "use repeat, mirror or clamp");
  if (filter != "bilinear" && filter != "nearest")
    xml_.fail(t, "no filter_type '" + filter + "'", "use bilinear or nearest");
  made.wrap = wrap == "repeat" ? Wrap::repeat : wrap == "mirror" ? Wrap::mirror : Wrap::clamp;
  made.nearest = filter == "nearest";
  made.to_uv = to_uv(t);
  const std::string format = xml_.word(t, "format", "auto");  // Mitsuba's own, in its memory
  if (format != "auto" && format != "variant" && format != "fp16")
    xml_.fail(t, "no format '" + format + "'", "use auto, variant or fp16");
  xml_.flag(t, "accel", true);
  for (const char* word : {"format", "accel"}) xml_.idle(XmlReader::named(t, word));
  const std::string file = xml_.file(t);
  const bool raw = xml_.flag(t, "raw", false);
  xml_.placed(t,
              [&] { made.picture = std::make_shared<const Image>(colours_of(read_image(file), file, raw)); });
  return made;
}

// Squares of half a unit: a picture of four texels, repeated.
Texture MaterialReader::checkerboard(Node t) const {
  xml_.only(t, {"color0", "color1", "to_uv"});
  const Rgb a = xml_.colour(t, "color0", {.4f, .4f, .4f}, ColourOf::reflectance),
            b = xml_.colour(t, "color1", {.2f, .2f, .2f}, ColourOf::reflectance);
  Image squares = make_image(2, 2, {"R", "G", "B"});
  squares.values = {a.r, a.g, a.b, b.r, b.g, b.b, b.r, b.g, b.b, a.r, a.g, a.b};
  Texture made;
  made.picture = std::make_shared<const Image>(std::move(squares)), made.nearest = true,
  made.to_uv = to_uv(t);
  return made;
}

Texture MaterialReader::texture(Node n, const char* name, Rgb otherwise) {
  const Node found = XmlReader::named(n, name), t = found ? xml_.resolve(found) : found;
  if (t == found && (!t || std::string_view(t.name()) != "texture")) {
    Texture one;
    one.colour = xml_.colour(n, name, otherwise, ColourOf::reflectance);
    return one;
  }
  if (std::string_view(t.name()) != "texture")
    xml_.fail(found, "'" + std::string(name) + "' refers to a <" + t.name() + ">", "refer to a texture");
  return texture_of(t);
}

Texture MaterialReader::texture_of(Node t) {
  const auto read = [&] {
    if (XmlReader::type(t) == "bitmap") return bitmap(t);
    if (XmlReader::type(t) == "checkerboard") return checkerboard(t);
    if (XmlReader::type(t) == "mesh_attribute") return mesh_attribute(t);
    if (XmlReader::type(t) == "rawconstant") return raw_constant(t);
    xml_.unknown(t);
  };
  return xml_.attempt(read, Texture{});
}

// One number, or three as they are.
Texture MaterialReader::raw_constant(Node t) const {
  xml_.only(t, {"value"});
  const Node value = XmlReader::named(t, "value");
  if (!value) xml_.fail(t, "no 'value'", "add it");
  Texture made;
  if (value.name() == std::string_view("vector") || value.name() == std::string_view("point")) {
    const auto v = xml_.point(t, "value", {});
    made.colour = {float(v.x), float(v.y), float(v.z)};
  } else {
    made.colour = to_rgb(float(xml_.property(t, "value", 0)));
  }
  if (!(made.colour.r >= 0 && made.colour.g >= 0 && made.colour.b >= 0))
    xml_.fail(value, "a value below 0", "write numbers from 0 on");
  return made;
}

Texture MaterialReader::mesh_attribute(Node t) {
  xml_.only(t, {"name", "scale"});
  const std::string name = xml_.word(t, "name", "");
  if (name.rfind("vertex_", 0) != 0 && name.rfind("face_", 0) != 0)
    xml_.fail(t, "a mesh's attribute is called vertex_... or face_..., not '" + name + "'", "mend 'name'");
  const auto known = std::find(attribute_names_.begin(), attribute_names_.end(), name);
  Texture made;
  made.attribute = int(known - attribute_names_.begin());
  made.scale = float(xml_.property(t, "scale", 1));
  if (known == attribute_names_.end()) {
    if (attribute_names_.size() == max_attributes)
      xml_.fail(t, "more than four attributes of meshes in a scene", "leave some out");
    attribute_names_.push_back(name);
  }
  asked_ |= 1U << unsigned(made.attribute);
  return made;
}

std::optional<Texture> MaterialReader::emission(Node n, const char* name) {
  const Node found = XmlReader::named(n, name);
  if (!found || xml_.resolve(found).name() != std::string_view("texture")) return std::nullopt;
  const Texture made = texture_of(xml_.resolve(found));
  if (made.attribute >= 0)
    xml_.fail(found, "lamps do not shine by attributes of meshes here", "give a picture");
  return made;
}

Texture MaterialReader::number(Node n, const char* name, double otherwise) {
  const Node c = XmlReader::named(n, name);
  const std::string_view tag = c.name();
  Texture t;
  if (tag != "texture" && tag != "ref" && tag != "rgb" && tag != "spectrum") {
    t.colour = to_rgb(float(xml_.property(n, name, otherwise)));
    return t;
  }
  t = texture(n, name, {});
  if (t.attribute >= 0) t.grey = true;
  if (t.attribute >= 0) return t;
  const bool squares =
      tag != "rgb" && tag != "spectrum" && XmlReader::type(xml_.resolve(c)) == "checkerboard";
  const auto mean = [](Rgb colour) { return (colour.r + colour.g + colour.b) / 3; };
  if (!t.picture) {
    t.colour = to_rgb(mean(t.colour));
    return t;
  }
  Image grey = make_image(t.picture->width, t.picture->height, {"Y"});
  const std::size_t channels = t.picture->channels.size();
  for (std::size_t i = 0; i < grey.values.size(); ++i) {
    const float* v = t.picture->values.data() + i * channels;
    grey.values[i] = channels == 1 ? v[0]
                     : squares     ? mean({v[0], v[1], v[2]})
                                   : luminance({v[0], v[1], v[2]});
  }
  // Asked for a number, Mitsuba's checkerboard has its two colours exchanged.
  if (squares) std::swap(grey.values[0], grey.values[1]), std::swap(grey.values[2], grey.values[3]);
  t.picture = std::make_shared<const Image>(std::move(grey));
  return t;
}

}  // namespace reflectree::render
