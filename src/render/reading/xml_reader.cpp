// SPDX-License-Identifier: Apache-2.0
#include "xml_reader.hpp"

#include <algorithm>
#include <cctype>

#include "reflectree/error.hpp"

namespace reflectree::render {

namespace {
std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return s;
}
}  // namespace

XmlReader::XmlReader(std::string_view xml, const std::string& path, const SceneOptions& options)
    : options_(options), text_(xml, path, options.defines), defines_(options.defines) {
  const auto parsed = document_.load_buffer(text_.text().data(), text_.text().size());
  if (!parsed) throw Error(parsed.description(), text_.place(parsed.offset), "mend the XML");
  root_ = document_.child("scene");
  if (!root_) throw Error("no <scene>", path, "name a Mitsuba 3 scene");
  find_defaults(root_, 0);
  replace_names(root_, 0);
  upgrade(root_);
  for (const auto& [name, value] : options.defines) {
    if (!used_.count(name)) throw Error("the scene does not say $" + name, path, "leave -D " + name + " out");
  }
  check(root_);
}

std::string XmlReader::beside(const std::string& file) const {
  files_.push_back(text_.find(file));
  return files_.back();
}

std::string XmlReader::file(Node n) const {
  if (word(n, "filename", "").empty())
    fail(n, "no file is named", "add <string name=\"filename\" value=\"...\"/>");
  return beside(word(n, "filename", ""));
}

void XmlReader::fail(Node n, const std::string& what, const std::string& how) const {
  throw ElementError({what, place(n), how});
}

// The error's own place follows the element's.
void XmlReader::rethrow(Node n, const Error& e) const {
  const std::string all = e.what();
  const std::size_t how = std::min(all.rfind("; "), all.size());
  throw ElementError({all.substr(0, how), place(n), how < all.size() ? all.substr(how + 2) : "mend it"});
}

void XmlReader::unknown(Node n) const {
  fail(n, "no " + std::string(n.name()) + " '" + type(n) + "' is known", "use another");
}

// Parts that are objects may have any name; textures, references and plain values are told by theirs.
void XmlReader::only(Node n, Names known) const {
  const auto knows = [&](std::string_view w) {
    return std::find(known.begin(), known.end(), w) != known.end();
  };
  for (const Node c : n.children()) {
    const std::string_view name = c.attribute("name").value(), tag = c.name();
    if (c.type() != pugi::node_element || knows(name) ||
        (c.attribute("type") && tag != "texture" && knows(tag)) ||
        ((name.empty() || tag == "ref") && knows(tag)))
      continue;
    const std::string word(name.empty() ? tag : name);
    note(c, "'" + word + "' is not known in <" + n.name() + " type=\"" + type(n) + "\">", "leave it out");
  }
}

// One level of references is all that has a meaning.
Node XmlReader::resolve(Node n) const {
  if (std::string_view(n.name()) != "ref") return n;
  const auto found = ids_.find(text(n, "id"));
  if (found == ids_.end()) fail(n, "no element has the id '" + text(n, "id") + "'", "check the id");
  return found->second;
}

Node XmlReader::child(Node n, const char* tag) const {
  const Node found = n.child(tag);
  if (const Node second = found.next_sibling(tag))
    fail(second, "a second <" + std::string(tag) + ">", "keep one of the two");
  return found;
}

Node XmlReader::part(Node n, const char* tag) const {
  Node found;
  for (const Node c : n.children()) {
    const Node meant = c.type() == pugi::node_element ? resolve(c) : Node();
    if (meant.name() != std::string_view(tag)) continue;
    if (found) fail(c, "a second <" + std::string(tag) + ">", "keep one of the two");
    found = meant;
  }
  return found;
}

void XmlReader::refer_to(Node n, Names tags) const {
  for (const Node c : n.children("ref")) {
    const std::string_view meant = resolve(c).name();
    if (std::find(tags.begin(), tags.end(), meant) == tags.end())
      fail(c, "<" + std::string(n.name()) + "> cannot refer to a <" + std::string(meant) + ">",
           "refer to a " + std::string(*tags.begin()));
  }
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
  if (!n.attribute(attribute)) return otherwise;
  const auto found = numbers(n, text(n, attribute));
  if (found.size() != 1)
    fail(n, "one number is needed, not '" + text(n, attribute) + "'",
         "write " + std::string(attribute) + "=\"...\"");
  return found[0];
}

Vec3<double> XmlReader::triple(Node n, const char* attribute) const {
  const auto v = numbers(n, text(n, attribute));
  if (v.size() != 3) fail(n, std::string(attribute) + " needs three numbers", "write x, y, z");
  return {v[0], v[1], v[2]};
}

void XmlReader::need(Node property, Names tags, const std::string& what) const {
  if (std::find(tags.begin(), tags.end(), property.name()) != tags.end()) return;
  const std::string name = property.attribute("name").value();
  fail(property, "'" + name + "' is " + what + ", and this is a <" + property.name() + ">",
       "write <" + std::string(*tags.begin()) + " name=\"" + name + "\" .../>");
}

double XmlReader::property(Node n, const char* name, double otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  need(c, {"float", "integer"}, "a number");
  return number(c, "value", otherwise);
}

int XmlReader::integer(Node n, const char* name, int otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  need(c, {"integer"}, "a whole number");
  const double v = number(c, "value", otherwise);
  if (!(v >= -1 && v <= 1e9 && v == std::floor(v)))
    fail(c, "no whole number between -1 and 1e9", "mend '" + std::string(name) + "'");
  return int(v);
}

bool XmlReader::flag(Node n, const char* name, bool otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  need(c, {"boolean"}, "a boolean");
  const std::string value = lower(text(c, "value"));
  if (value != "true" && value != "false") fail(c, "'" + value + "' is no boolean", "write true or false");
  return value == "true";
}

std::string XmlReader::word(Node n, const char* name, const std::string& otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  need(c, {"string"}, "a text");
  return text(c, "value");
}

Vec3<double> XmlReader::point(Node n, const char* name, Vec3<double> otherwise) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  need(c, {"point", "vector"}, "a point or a direction");
  if (c.attribute("value")) return triple(c, "value");
  return {number(c, "x", 0), number(c, "y", 0), number(c, "z", 0)};
}

// wavelength:value, ...
SampledSpectrum XmlReader::sampled(Node n) const {
  std::string plain = text(n, "value");
  const auto pairs = std::count(plain.begin(), plain.end(), ':');
  std::replace(plain.begin(), plain.end(), ':', ' ');
  const auto v = numbers(n, plain);
  if (pairs < 2 || v.size() != 2 * std::size_t(pairs))
    fail(n, "a spectrum is one number or two and more pairs", "write wavelength:value, wavelength:value");
  SampledSpectrum s;
  for (std::size_t i = 0; i < v.size(); i += 2) {
    if (!s.empty() && !(v[i] > s.back().first)) fail(n, "wavelengths do not ascend", "sort them");
    s.emplace_back(v[i], v[i + 1]);
  }
  return s;
}

Rgb XmlReader::colour(Node n, const char* name, Rgb otherwise, ColourOf of) const {
  const Node c = named(n, name);
  if (!c) return otherwise;
  const std::string_view tag = c.name();
  if (tag == "texture" || tag == "ref")
    fail(c, "'" + std::string(name) + "' has one colour here, and this is a <" + std::string(tag) + ">",
         "write <rgb name=\"" + std::string(name) + "\" value=\"r, g, b\"/>");
  need(c, {"rgb", "spectrum", "float", "integer"}, "a colour");
  if (c.attribute("type") || c.attribute("filename"))
    fail(c, "spectra of a plugin or a file are not read here", "write value=\"wavelength:value, ...\"");
  Rgb found;
  if (tag == "spectrum") {
    const std::string value = text(c, "value");
    if (value.find(':') != std::string::npos || value.find(',') != std::string::npos) {
      found = to_linear_srgb(sampled(c), of);
    } else {
      found = float(number(c, "value", 0)) * (of == ColourOf::light ? equal_energy : Rgb{1, 1, 1});
    }
  } else {
    const auto v = numbers(c, text(c, "value"));
    if (v.size() != 1 && !(v.size() == 3 && tag == "rgb"))
      fail(c, tag == "rgb" ? "a colour has one or three numbers" : "one number is needed",
           tag == "rgb" ? "write r, g, b" : "write an <rgb> for a colour");
    found = v.size() == 1 ? to_rgb(float(v[0])) : Rgb{float(v[0]), float(v[1]), float(v[2])};
  }
  if (!(found.r >= 0 && found.g >= 0 && found.b >= 0))
    fail(c, "'" + std::string(name) + "' is negative", "write numbers from 0 on");
  if (of == ColourOf::reflectance && tag == "rgb" && !(found.r <= 1 && found.g <= 1 && found.b <= 1))
    fail(c, "'" + std::string(name) + "' reflects more than all", "write r, g, b up to 1");
  return found;
}

}  // namespace reflectree::render
