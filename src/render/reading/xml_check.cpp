// SPDX-License-Identifier: Apache-2.0
// What is true of every element, whatever it is for: its attributes are known and complete, $names have been
// replaced, nothing is said twice, no text stands between. A word that is misspelt would be no word
// otherwise, and the default would stand in for it.
#include <algorithm>
#include <cctype>
#include <set>

#include "xml_reader.hpp"

namespace reflectree::render {

namespace {

struct Attributes {
  const char* tag;
  std::vector<std::string_view> needed, allowed;
};

const Attributes* attributes_of(std::string_view tag) {
  static const Attributes all[] = {
      {"float", {"name", "value"}, {}},
      {"integer", {"name", "value"}, {}},
      {"boolean", {"name", "value"}, {}},
      {"string", {"name", "value"}, {}},
      {"rgb", {"name", "value"}, {}},
      {"spectrum", {"name"}, {"value", "filename", "type", "id"}},
      {"point", {"name"}, {"value", "x", "y", "z"}},
      {"vector", {"name"}, {"value", "x", "y", "z"}},
      {"transform", {"name"}, {}},
      {"translate", {}, {"value", "x", "y", "z"}},
      {"scale", {}, {"value", "x", "y", "z"}},
      {"rotate", {"angle"}, {"value", "x", "y", "z"}},
      {"lookat", {"origin", "target"}, {"up"}},
      {"matrix", {"value"}, {}},
      {"ref", {"id"}, {"name"}},
      {"alias", {"id", "as"}, {}},
      {"default", {"name", "value"}, {}},
      {"scene", {}, {"version", "type", "id", "name"}},
  };
  const auto* found =
      std::find_if(std::begin(all), std::end(all), [&](const Attributes& a) { return a.tag == tag; });
  if (found != std::end(all)) return found;
  static const std::set<std::string_view> objects{"integrator", "sensor", "film",    "rfilter", "sampler",
                                                  "shape",      "bsdf",   "emitter", "texture"};
  static const Attributes object{"", {"type"}, {"id", "name"}};
  return objects.count(tag) ? &object : nullptr;
}

bool has(const std::vector<std::string_view>& all, std::string_view word) {
  return std::find(all.begin(), all.end(), word) != all.end();
}

}  // namespace

// What the scene says of its own $names; the command line's come first.
void XmlReader::find_defaults(Node n, int depth) {
  if (depth > 64) fail(n, "elements are nested deeper than 64", "close those that have ended");
  for (const Node c : n.children()) {
    if (c.name() != std::string_view("default")) {
      find_defaults(c, depth + 1);
      continue;
    }
    replace_names(c, depth);  // by those before it
    defines_.try_emplace(c.attribute("name").value(), c.attribute("value").value());
    used_.insert(c.attribute("name").value());
  }
}

// pugixml keeps the places of elements.
void XmlReader::replace_names(Node n, int depth) {
  for (pugi::xml_attribute a : n.attributes()) {
    std::string value = a.value();
    const std::string missing =
        render::replace_names(value, defines_, [&](const std::string& name) { used_.insert(name); });
    if (!missing.empty()) fail(n, "nothing defines $" + missing, "give -D " + missing + "=VALUE");
    a.set_value(value.c_str());
  }
  for (const Node c : n.children()) {
    const bool is_default = c.name() == std::string_view("default");  // is done already
    if (c.type() == pugi::node_element && !is_default) replace_names(c, depth + 1);
  }
}

namespace {

// sampleCount: sample_count; toUV: to_uv.
std::string with_underscores(std::string_view name) {
  const auto small = [](char c) { return std::islower(static_cast<unsigned char>(c)) != 0; };
  const auto large = [](char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; };
  std::string out;
  bool inside = false;  // of capitals that follow a small letter
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool starts = i > 0 && small(name[i - 1]) && large(name[i]);
    inside = starts || (inside && large(name[i]));
    if (starts) out += '_';
    out += inside ? char(std::tolower(static_cast<unsigned char>(name[i]))) : name[i];
  }
  return out;
}

}  // namespace

// Files of Mitsuba before 2.0: the words that Mitsuba 3's own reader converts. Of all files: Mitsuba takes a
// texture under the name <spectrum>, too; a shorter name is written in place, and the element keeps its own.
void XmlReader::upgrade(Node n) {
  static const std::set<std::string_view> textures{"bitmap", "checkerboard", "mesh_attribute", "rawconstant"};
  if (n.name() == std::string_view("spectrum") && textures.count(n.attribute("type").value()))
    n.set_name("texture");
  if (text_.is_old(n.offset_debug()) && n != root_) {
    for (const Node c : n.children()) {
      pugi::xml_attribute name = c.attribute("name");
      if (!name || c.name() == std::string_view("default")) continue;
      name.set_value(with_underscores(name.value()).c_str());
      if (type(n) == "diffuse" && name.value() == std::string_view("diffuse_reflectance"))
        name.set_value("reflectance");
    }
    const bool moves = named(n, "uoffset") || named(n, "voffset") || named(n, "uscale") || named(n, "vscale");
    if (moves) {
      Node move, scale, to_uv = n.append_child("transform");
      to_uv.append_attribute("name") = "to_uv";
      move = to_uv.append_child("translate"), scale = to_uv.append_child("scale");
      const auto take = [&](const char* word, Node into, const char* axis, const char* otherwise) {
        const Node old = named(n, word);
        into.append_attribute(axis) = old ? old.attribute("value").value() : otherwise;
        if (old) n.remove_child(old);
      };
      take("uoffset", move, "x", "0"), take("voffset", move, "y", "0");
      take("uscale", scale, "x", "1"), take("vscale", scale, "y", "1");
    }
  }
  for (const Node c : n.children()) {
    if (c.attribute("type")) upgrade(c);
  }
}

void XmlReader::check_attributes(Node n) const {
  const std::string_view tag = n.name();
  const Attributes* known = attributes_of(tag);
  if (!known) return;  // whoever meets the element says that it is not known
  for (const pugi::xml_attribute a : n.attributes()) {
    if (!has(known->needed, a.name()) && !has(known->allowed, a.name()))
      note(n, "<" + std::string(tag) + "> has no attribute '" + a.name() + "'", "check its name");
  }
  for (const std::string_view a : known->needed) {
    if (!n.attribute(std::string(a).c_str()))
      note(n, "<" + std::string(tag) + "> without '" + std::string(a) + "'",
           "add " + std::string(a) + "=\"...\"");
  }
  const bool whole = n.attribute("value"), x = n.attribute("x"), y = n.attribute("y"), z = n.attribute("z");
  if (has(known->allowed, "x") && whole && (x || y || z))
    note(n, "both 'value' and x, y, z", "keep one of the two");
  if ((tag == "point" || tag == "vector") && !whole && !(x && y && z))
    note(n, "<" + std::string(tag) + "> needs x, y and z", "write all three");
}

void XmlReader::check(Node n) const {
  check_attributes(n);
  if (n.name() == std::string_view("alias")) {
    const auto meant = ids_.find(text(n, "id"));
    if (meant == ids_.end()) {
      note(n, "no element before it has the id '" + text(n, "id") + "'", "check the id");
    } else if (!ids_.try_emplace(text(n, "as"), meant->second).second) {
      note(n, "a second element has the id '" + text(n, "as") + "'", "give it another");
    }
    return;
  }
  const std::string id = n.attribute("id").value();
  if (!id.empty() && std::string_view(n.name()) != "ref" && !ids_.try_emplace(id, n).second)
    note(n, "a second element has the id '" + id + "'", "give it another");
  std::set<std::string_view> names;
  for (const Node c : n.children()) {
    if (c.type() == pugi::node_pcdata || c.type() == pugi::node_cdata)
      note(n, "text inside <" + std::string(n.name()) + ">", "write value=\"...\"");
    if (c.type() != pugi::node_element) continue;
    const std::string_view name = c.attribute("name").value();
    if (!name.empty() && std::string_view(c.name()) != "default" && !names.insert(name).second)
      note(c, "'" + std::string(name) + "' is given twice", "keep one of the two");
    if (attributes_of(n.name()) && !n.attribute("type") && n != root_ &&
        std::string_view(n.name()) != "transform")
      note(c, "<" + std::string(c.name()) + "> inside <" + n.name() + ">", "close the outer one before");
    check(c);
  }
}

}  // namespace reflectree::render
