// SPDX-License-Identifier: Apache-2.0
#include "xml_reader.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "reflectree/error.hpp"
#include "scene_colour.hpp"

namespace reflectree::render {

XmlReader::XmlReader(std::string_view xml, const std::string& path, const SceneOptions& options)
    : xml_(xml), path_(path), options_(options), defines_(options.defines) {
  const auto parsed = document_.load_buffer(xml_.data(), xml_.size());
  if (!parsed) throw Error(parsed.description(), place(parsed.offset), "mend the XML");
  root_ = document_.child("scene");
  if (!root_) throw Error("no <scene>", path_, "name a Mitsuba 3 scene");
  for (const Node n : root_.children("default"))
    defines_.try_emplace(n.attribute("name").value(), n.attribute("value").value());
}

std::string XmlReader::beside(const std::string& file) const {
  files_.push_back((std::filesystem::path(path_).parent_path() / file).string());
  return files_.back();
}

std::string XmlReader::place(std::ptrdiff_t offset) const {
  const std::string_view before = xml_.substr(0, std::size_t(std::max<std::ptrdiff_t>(offset, 0)));
  const std::size_t newline = before.rfind('\n');
  return path_ + ":" + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" +
         std::to_string(before.size() - (newline == std::string_view::npos ? 0 : newline + 1));
}

void XmlReader::fail(Node n, const std::string& what, const std::string& how) const {
  throw Error(what, place(n.offset_debug()), how);
}

void XmlReader::unknown(Node n) const {
  fail(n, "no " + std::string(n.name()) + " '" + type(n) + "' is known", "use another");
}

void XmlReader::only(Node n, Names known) const {
  for (const Node c : n.children()) {
    const char* name = c.attribute("name").value();
    const std::string_view word = *name ? name : c.name();
    if (c.type() == pugi::node_element && std::find(known.begin(), known.end(), word) == known.end()) {
      fail(c, "'" + std::string(word) + "' is not known in <" + n.name() + " type=\"" + type(n) + "\">",
           "leave it out");
    }
  }
}

// One level of references is all that has a meaning.
Node XmlReader::resolve(Node n) const {
  if (std::string_view(n.name()) != "ref") return n;
  const std::string id = text(n, "id");
  const Node found = root_.find_child_by_attribute("id", id.c_str());
  if (!found || std::string_view(found.name()) == "ref")
    fail(n, "no element has the id '" + id + "'", "check the id");
  return found;
}

// Every $name in it is replaced by what it stands for.
std::string XmlReader::text(Node n, const char* attribute) const {
  std::string value = n.attribute(attribute).value();
  for (std::size_t at = value.find('$'); at != std::string::npos; at = value.find('$', at)) {
    std::size_t end = at + 1;
    while (end < value.size() && (std::isalnum(static_cast<unsigned char>(value[end])) || value[end] == '_'))
      ++end;
    const std::string name = value.substr(at + 1, end - at - 1);
    const auto known = defines_.find(name);
    if (known == defines_.end()) fail(n, "nothing defines $" + name, "give -D " + name + "=VALUE");
    value.replace(at, end - at, known->second);
    at += known->second.size();
  }
  return value;
}

std::vector<double> XmlReader::numbers(Node n, const std::string& words) const {
  std::vector<double> found;
  const char* at = words.c_str();
  for (;;) {
    while (*at == ' ' || *at == ',' || *at == '\n' || *at == '\t' || *at == '\r') ++at;
    if (!*at) return found;
    char* end = nullptr;
    found.push_back(std::strtod(at, &end));
    if (end == at || !std::isfinite(found.back()))
      fail(n, "no finite number in '" + words + "'", "write numbers");
    at = end;
  }
}

double XmlReader::number(Node n, const char* attribute, double otherwise) const {
  const auto found = numbers(n, text(n, attribute));
  return found.empty() ? otherwise : found[0];
}

Vec3<double> XmlReader::triple(Node n, const char* attribute) const {
  const auto v = numbers(n, text(n, attribute));
  if (v.size() != 3) fail(n, std::string(attribute) + " needs three numbers", "write x, y, z");
  return {v[0], v[1], v[2]};
}

double XmlReader::property(Node n, const char* name, double otherwise) const {
  const Node c = named(n, name);
  return c ? number(c, "value", otherwise) : otherwise;
}

int XmlReader::integer(Node n, const char* name, int otherwise) const {
  const double v = property(n, name, otherwise);
  if (!(v >= -1 && v <= 1e9 && v == std::floor(v)))
    fail(named(n, name), "no whole number between -1 and 1e9", "mend '" + std::string(name) + "'");
  return int(v);
}

bool XmlReader::flag(Node n, const char* name, bool otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  const std::string value = text(c, "value");
  if (value != "true" && value != "false") fail(c, "'" + value + "' is no boolean", "write true or false");
  return value == "true";
}

std::string XmlReader::word(Node n, const char* name, const std::string& otherwise) const {
  const Node c = named(n, name);
  return c ? text(c, "value") : otherwise;
}

Vec3<double> XmlReader::point(Node n, const char* name, Vec3<double> otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  if (c.attribute("value")) return triple(c, "value");
  return {number(c, "x", 0), number(c, "y", 0), number(c, "z", 0)};
}

Rgb XmlReader::colour(Node n, const char* name, Rgb otherwise, bool reflectance) const {
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
  if (tag != "rgb" && tag != "spectrum" && tag != "float")
    fail(c, "no colour '" + std::string(tag) + "'", "use rgb, spectrum or float");
  const auto v = numbers(c, value);
  if (v.size() == 1) return to_rgb(float(v[0]));
  if (v.size() != 3) fail(c, "a colour has one or three numbers", "write r, g, b");
  return {float(v[0]), float(v[1]), float(v[2])};
}

}  // namespace reflectree::render
