// SPDX-License-Identifier: Apache-2.0
#include "xml_materials.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "materials/metals.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/render/materials/scattering_family.hpp"

namespace reflectree::render {

namespace {

struct NamedIndex {
  std::string_view name;
  double index;
};
// Between 0 and 20 degrees Celsius, at about 589 nm: Mitsuba's names and numbers.
constexpr NamedIndex indices[] = {
    {"vacuum", 1},        {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.333},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.47},      {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.575},       {"diamond", 2.419}};

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return s;
}

}  // namespace

MaterialReader::Widened MaterialReader::roughness(Node n, bool pictures) {
  Widened w;
  Roughness& r = w.roughness;
  const std::string kind = lower(xml_.word(n, "distribution", "beckmann"));
  if (kind != "beckmann" && kind != "ggx")
    xml_.fail(n, "no distribution '" + kind + "'", "use beckmann or ggx");
  r.kind = kind == "ggx" ? Roughness::Kind::ggx : Roughness::Kind::beckmann;
  r.sample_visible = xml_.flag(n, "sample_visible", true);
  const Node u = XmlReader::named(n, "alpha_u"), v = XmlReader::named(n, "alpha_v");
  if (u || v) {
    if (!u || !v || XmlReader::named(n, "alpha"))
      xml_.fail(n, "either alpha, or alpha_u and alpha_v", "write alpha");
    w.x = number(n, "alpha_u", 0), w.y = number(n, "alpha_v", 0);
  } else if (pictures) {
    w.x = w.y = number(n, "alpha", .1);
  } else {
    w.x.colour = w.y.colour = to_rgb(float(xml_.property(n, "alpha", .1)));
  }
  if (!varies(w.x)) r.alpha.x = w.x.colour.r;
  if (!varies(w.y)) r.alpha.y = w.y.colour.r;
  if (!(r.alpha.x > 0 && r.alpha.y > 0)) xml_.fail(n, "alpha is not positive", "use conductor or plastic");
  return w;
}

double MaterialReader::ior(Node n, const char* name, double otherwise) const {
  const Node c = XmlReader::named(n, name);
  if (!c || std::string_view(c.name()) != "string") return xml_.property(n, name, otherwise);
  const std::string word = lower(xml_.word(n, name, ""));
  const auto* found =
      std::find_if(std::begin(indices), std::end(indices), [&](auto& i) { return i.name == word; });
  if (found != std::end(indices)) return found->index;
  std::string all;
  for (const NamedIndex& i : indices) all += (all.empty() ? "" : ", ") + std::string(i.name);
  xml_.fail(c, "no index of refraction is known of '" + word + "'", "write its number, or one of " + all);
}

float MaterialReader::relative_ior(Node n, double inside) const {
  const double in = ior(n, "int_ior", inside), out = ior(n, "ext_ior", 1.000277);
  if (!(in > 0 && out > 0)) xml_.fail(n, "an index of refraction is not positive", "give positive numbers");
  return float(in / out);
}

// A metal's name, or eta and k; Mitsuba's k is 1 where eta alone is given.
std::pair<Rgb, Rgb> MaterialReader::eta_and_k(Node n) const {
  const std::string name = xml_.word(n, "material", "none");
  const Node own = XmlReader::named(n, "eta") ? XmlReader::named(n, "eta") : XmlReader::named(n, "k");
  if (own && name != "none") xml_.fail(own, "both a material and eta or k", "keep one of the two");
  if (own)
    return {xml_.colour(n, "eta", {}, ColourOf::index), xml_.colour(n, "k", {1, 1, 1}, ColourOf::index)};
  if (name == "none") return {};
  if (const Metal* metal = find_metal(name)) return {metal->eta, metal->k};
  xml_.fail(n, "no metal '" + name + "'", "give eta and k, or one of " + metal_names());
}

PlasticParameters MaterialReader::plastic_of(Node n) {
  PlasticParameters p;
  p.eta = relative_ior(n, 1.49);
  p.diffuse = texture(n, "diffuse_reflectance", {.5f, .5f, .5f});
  p.specular = texture(n, "specular_reflectance", {1, 1, 1});
  p.nonlinear = xml_.flag(n, "nonlinear", false);
  return p;
}

ScatteringPtr MaterialReader::with_sampler(const AnyBrdf& f, const std::string& text) {
  if (!xml_.sound()) return diffuse({});  // nothing will be rendered, and building takes its time
  const auto make = [&](const std::string& name, const char* option, const PeerSubject& subject) {
    const SamplerInfo* info = find_sampler(name);
    if (!info) {
      std::string all;
      for (const SamplerInfo& known : samplers()) all += (all.empty() ? "" : ", ") + std::string(known.name);
      throw Error("no sampler '" + name + "'", option, "choose one of " + all);
    }
    auto sampler = info->make(subject, host_);
    if (!sampler) throw Error("'" + name + "' does not take this material", option, "choose another");
    return std::move(*sampler);
  };
  const SceneOptions& o = xml_.options();
  auto sampler = make(o.sampler, "--sampler", {f, text.empty() ? Material{} : parse_material(text), {}});
  if (o.adjoint.empty()) return sampled(f, std::move(sampler));
  return sampled(f, std::move(sampler), make(o.adjoint, "--adjoint", {adjoint_of(f), Material{}, {}}));
}

ScatteringPtr MaterialReader::from_text(Node n) {
  const std::string text = xml_.word(n, "material", "");
  const Material material = xml_.placed(n, [&] { return parse_material(text); });
  if (is_family(material)) return from_family(n, material);
  xml_.only(n, {"material"});
  const auto load = [this](const std::string& p, const std::string& m) {
    return load_brdf(xml_.beside(p), m);
  };
  return with_sampler(xml_.placed(n, [&] { return make_brdf(material, load); }), text);
}

// A material with ranges: a number or a texture for each of them, by its name.
ScatteringPtr MaterialReader::from_family(Node n, const Material& material) {
  const AnyFamily family = xml_.placed(n, [&] { return make_family(material); });
  std::vector<Texture> at;
  for (const ParameterRange& range : family.ranges()) {
    if (!XmlReader::named(n, range.name.c_str()))
      xml_.fail(n, range.name + " has a range, and no value", "add a texture or a number of that name");
    at.push_back(number(n, range.name.c_str(), 0));
  }
  xml_.only(n, {"material", family.ranges().front().name, family.ranges().back().name});
  const std::string& sampler = xml_.options().sampler;
  if (sampler != "exact" && sampler != "one-shot")
    xml_.fail(n, "'" + sampler + "' has no sampler of a family", "render with --sampler exact or one-shot");
  if (!xml_.sound()) return diffuse({});
  return xml_.placed(n, [&] {
    return sampled_family(
        make_sampler(Family<AnyFamily>{family, family.ranges(), family.traits().name}, {}, host_),
        sampler == "exact", std::move(at));
  });
}

ScatteringPtr MaterialReader::from_file(Node n) {
  xml_.only(n, {"filename"});
  const std::string file = xml_.file(n);
  return with_sampler(xml_.placed(n, [&] { return load_brdf(file); }), "");
}

std::vector<ScatteringPtr> MaterialReader::inside(Node n, int depth, std::string_view texture) {
  std::vector<ScatteringPtr> found;
  for (const Node c : n.children()) {
    if (c.type() != pugi::node_element) continue;
    const Node meant = xml_.resolve(c);
    if (std::string_view(meant.name()) == "bsdf") {
      found.push_back(read(meant, depth + 1));
    } else if (meant != c && (texture.empty() || c.attribute("name").value() != texture)) {
      xml_.fail(c, "refers to a <" + std::string(meant.name()) + ">", "refer to a bsdf");
    }
  }
  return found;
}

ScatteringPtr MaterialReader::only_one_inside(Node n, int depth, std::string_view texture) {
  const auto found = inside(n, depth, texture);
  if (found.size() != 1) xml_.fail(n, "one bsdf is needed", "put it there");
  return found.front();
}

// normalmap and bumpmap; the latter's texture may have any name.
ScatteringPtr MaterialReader::perturbed(Node n, int depth) {
  const bool bumps = XmlReader::type(n) == "bumpmap";
  Node map = bumps ? Node() : XmlReader::named(n, "normalmap");
  for (const Node c : n.children()) {
    if (bumps && c.type() == pugi::node_element && xml_.resolve(c).name() == std::string_view("texture"))
      map = c;
  }
  if (!map)
    xml_.fail(n, bumps ? "a bump map without a texture" : "a normal map without 'normalmap'",
              "add the texture");
  const std::string name = map.attribute("name").value();
  xml_.only(n, {"bsdf", "ref", "texture", name, "flip_invalid_normals", "use_shadowing_function",
                bumps ? "scale" : "bsdf"});
  const NormalRules rules{xml_.flag(n, "flip_invalid_normals", true),
                          xml_.flag(n, "use_shadowing_function", true)};
  const Texture texture = texture_of(xml_.resolve(map));
  ScatteringPtr inner = only_one_inside(n, depth, name);
  if (bumps) return bump_map(texture, float(xml_.property(n, "scale", 1)), rules, std::move(inner));
  if (texture.picture && texture.picture->channels.size() < 3)
    xml_.fail(map, "a normal map in grey", "give a picture of red, green and blue");
  return normal_map(texture, rules, std::move(inner));
}

ScatteringPtr MaterialReader::read(Node n, int depth) {
  if (depth > 8) xml_.fail(n, "materials refer to each other in a circle", "break the circle of ids");
  const auto known = known_.find(n.offset_debug());
  if (known != known_.end()) {
    asked_ |= attributes_of(known->second);
    return known->second;
  }
  const std::uint32_t outside = std::exchange(asked_, 0);
  auto made = xml_.attempt([&] { return make(n, depth); }, ScatteringPtr());
  if (!made) made = diffuse({});
  attributes_of_[made.get()] = asked_;
  asked_ |= outside;
  return known_[n.offset_debug()] = made;
}

ScatteringPtr MaterialReader::make(Node n, int depth) {
  const std::string type = XmlReader::type(n);
  const Rgb white{1, 1, 1};
  if (type == "diffuse") {
    xml_.only(n, {"reflectance"});
    return diffuse(texture(n, "reflectance", {.5f, .5f, .5f}));
  }
  if (type == "conductor") {
    xml_.only(n, {"eta", "k", "material", "specular_reflectance"});
    const auto [eta, k] = eta_and_k(n);
    return conductor(eta, k, texture(n, "specular_reflectance", white));
  }
  if (type == "roughconductor") {
    xml_.only(n, {"eta", "k", "material", "specular_reflectance", "alpha", "alpha_u", "alpha_v",
                  "distribution", "sample_visible"});
    const auto [eta, k] = eta_and_k(n);
    Widened alpha = roughness(n, true);
    return rough_conductor(alpha.roughness, eta, k, texture(n, "specular_reflectance", white),
                           std::move(alpha.x), std::move(alpha.y));
  }
  if (type == "plastic") {
    xml_.only(n, {"int_ior", "ext_ior", "diffuse_reflectance", "specular_reflectance", "nonlinear"});
    return plastic(plastic_of(n));
  }
  if (type == "roughplastic") {
    xml_.only(n, {"int_ior", "ext_ior", "diffuse_reflectance", "specular_reflectance", "nonlinear", "alpha",
                  "distribution", "sample_visible"});
    return rough_plastic(plastic_of(n), roughness(n, false).roughness);
  }
  if (type == "dielectric") {
    xml_.only(n, {"int_ior", "ext_ior", "specular_reflectance", "specular_transmittance"});
    return dielectric(relative_ior(n, 1.5046), texture(n, "specular_reflectance", white),
                      texture(n, "specular_transmittance", white));
  }
  if (type == "thindielectric") {
    xml_.only(n, {"int_ior", "ext_ior", "specular_reflectance", "specular_transmittance"});
    lets_pass_ = true;
    return thin_dielectric(relative_ior(n, 1.5046), texture(n, "specular_reflectance", white),
                           texture(n, "specular_transmittance", white));
  }
  if (type == "mask") {
    xml_.only(n, {"bsdf", "ref", "opacity"});
    lets_pass_ = true;
    Texture opacity = number(n, "opacity", .5);
    return mask(std::move(opacity), only_one_inside(n, depth, "opacity"));
  }
  if (type == "null") {  // as a mask that is not there
    xml_.only(n, {});
    lets_pass_ = true;
    return mask({}, diffuse({}));
  }
  if (type == "normalmap" || type == "bumpmap") return perturbed(n, depth);
  if (type == "measured") return from_file(n);
  if (type == "reflectree") return from_text(n);
  if (type == "twosided") {
    xml_.only(n, {"bsdf", "ref"});
    const auto sides = inside(n, depth);
    if (sides.empty() || sides.size() > 2) xml_.fail(n, "one or two bsdfs are needed", "put them there");
    for (const ScatteringPtr& side : sides) {
      if (side->transmits())
        xml_.fail(n, "what lets light through has two sides already", "leave <twosided> out");
    }
    return two_sided(sides.front(), sides.back());
  }
  if (type == "blendbsdf") {
    xml_.only(n, {"bsdf", "ref", "weight"});
    if (!XmlReader::named(n, "weight")) xml_.fail(n, "a blend without 'weight'", "add it, between 0 and 1");
    const auto parts = inside(n, depth, "weight");
    if (parts.size() != 2) xml_.fail(n, "two bsdfs are needed", "put them there");
    return blend(number(n, "weight", 0), parts[0], parts[1]);
  }
  xml_.unknown(n);
}

}  // namespace reflectree::render
