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

// Every $name in an attribute is replaced by what it stands for, \$ by $. pugixml keeps the places of
// elements.
void XmlReader::replace_names(Node n, int depth) {
  if (depth > 64) fail(n, "elements are nested deeper than 64", "close those that have ended");
  for (pugi::xml_attribute a : n.attributes()) {
    std::string value = a.value();
    for (std::size_t at = value.find('$'); at != std::string::npos; at = value.find('$', at)) {
      if (at > 0 && value[at - 1] == '\\') {
        value.erase(at - 1, 1);
        continue;
      }
      std::size_t end = at + 1;
      while (end < value.size() &&
             (std::isalnum(static_cast<unsigned char>(value[end])) || value[end] == '_'))
        ++end;
      const std::string name = value.substr(at + 1, end - at - 1);
      const auto known = defines_.find(name);
      if (known == defines_.end()) fail(n, "nothing defines $" + name, "give -D " + name + "=VALUE");
      used_.insert(name);
      value.replace(at, end - at, known->second);
      at += known->second.size();
    }
    a.set_value(value.c_str());
  }
  for (const Node c : n.children()) {
    const bool is_default = c.name() == std::string_view("default");  // is done already
    if (c.type() == pugi::node_element && !is_default) replace_names(c, depth + 1);
  }
}

void XmlReader::check_attributes(Node n) const {
  const std::string_view tag = n.name();
  const Attributes* known = attributes_of(tag);
  if (!known) return;  // whoever meets the element says that it is not known
  for (const pugi::xml_attribute a : n.attributes()) {
    if (!has(known->needed, a.name()) && !has(known->allowed, a.name()))
      fail(n, "<" + std::string(tag) + "> has no attribute '" + a.name() + "'", "check its name");
  }
  for (const std::string_view a : known->needed) {
    if (!n.attribute(std::string(a).c_str()))
      fail(n, "<" + std::string(tag) + "> without '" + std::string(a) + "'",
           "add " + std::string(a) + "=\"...\"");
  }
  const bool whole = n.attribute("value"), x = n.attribute("x"), y = n.attribute("y"), z = n.attribute("z");
  if (has(known->allowed, "x") && whole && (x || y || z))
    fail(n, "both 'value' and x, y, z", "keep one of the two");
  if ((tag == "point" || tag == "vector") && !whole && !(x && y && z))
    fail(n, "<" + std::string(tag) + "> needs x, y and z", "write all three");
}

void XmlReader::check(Node n) const {
  check_attributes(n);
  const std::string id = n.attribute("id").value();
  if (!id.empty() && std::string_view(n.name()) != "ref" && !ids_.try_emplace(id, n).second)
    fail(n, "a second element has the id '" + id + "'", "give it another");
  std::set<std::string_view> names;
  for (const Node c : n.children()) {
    if (c.type() == pugi::node_pcdata || c.type() == pugi::node_cdata)
      fail(n, "text inside <" + std::string(n.name()) + ">", "write value=\"...\"");
    if (c.type() != pugi::node_element) continue;
    const std::string_view name = c.attribute("name").value();
    if (!name.empty() && std::string_view(c.name()) != "default" && !names.insert(name).second)
      fail(c, "'" + std::string(name) + "' is given twice", "keep one of the two");
    if (attributes_of(n.name()) && !n.attribute("type") && n != root_ &&
        std::string_view(n.name()) != "transform")
      fail(c, "<" + std::string(c.name()) + "> inside <" + n.name() + ">", "close the outer one before");
    check(c);
  }
}

}  // namespace reflectree::render
