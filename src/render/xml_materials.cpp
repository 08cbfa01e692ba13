// SPDX-License-Identifier: Apache-2.0
#include "xml_materials.hpp"

#include "metals.hpp"
#include "reflectree/error.hpp"
#include "reflectree/io/material_file.hpp"
#include "reflectree/peers/registry.hpp"

namespace reflectree::render {

// A picture from 8 bits is in sRGB unless it is `raw`.
Texture MaterialReader::texture(Node n, const char* name, Rgb otherwise) {
  const Node found = XmlReader::named(n, name), t = found ? xml_.resolve(found) : found;
  if (!t || std::string_view(t.name()) != "texture") {
    return {xml_.colour(n, name, otherwise, true), nullptr};
  }
  if (XmlReader::type(t) != "bitmap") xml_.unknown(t);
  xml_.only(t, {"filename", "filter_type", "wrap_mode", "raw"});
  if (xml_.word(t, "wrap_mode", "repeat") != "repeat") xml_.fail(t, "textures only repeat", "drop wrap_mode");
  const std::string filter = xml_.word(t, "filter_type", "bilinear");
  if (filter != "bilinear" && filter != "nearest")
    xml_.fail(t, "no filter_type '" + filter + "'", "use bilinear or nearest");
  const std::string file = xml_.beside(xml_.word(t, "filename", ""));
  Image image = read_image(file);
  const bool encoded = file.size() > 4 && file.substr(file.size() - 4) == ".png";
  if (encoded && !xml_.flag(t, "raw", false)) {
    for (float& v : image.values) v = from_srgb(v);
  }
  return {{}, std::make_shared<const Image>(std::move(image)), filter == "nearest"};
}

Roughness MaterialReader::roughness(Node n) const {
  Roughness r;
  const std::string kind = xml_.word(n, "distribution", "beckmann");
  if (kind != "beckmann" && kind != "ggx")
    xml_.fail(n, "no distribution '" + kind + "'", "use beckmann or ggx");
  r.kind = kind == "ggx" ? Roughness::Kind::ggx : Roughness::Kind::beckmann;
  r.alpha = float(xml_.property(n, "alpha", .1));
  r.sample_visible = xml_.flag(n, "sample_visible", true);
  if (!(r.alpha > 0)) xml_.fail(n, "alpha is not positive", "use conductor or plastic");
  return r;
}

float MaterialReader::relative_ior(Node n, double inside) const {
  for (const char* name : {"int_ior", "ext_ior"}) {
    const Node c = XmlReader::named(n, name);
    if (c && std::string_view(c.name()) == "string")
      xml_.fail(c, "indices are numbers here", "write its number");
  }
  const double in = xml_.property(n, "int_ior", inside), out = xml_.property(n, "ext_ior", 1.000277);
  if (!(in > 0 && out > 0)) xml_.fail(n, "an index of refraction is not positive", "give positive numbers");
  return float(in / out);
}

std::pair<Rgb, Rgb> MaterialReader::eta_and_k(Node n) const {
  if (XmlReader::named(n, "eta") && XmlReader::named(n, "k"))
    return {xml_.colour(n, "eta", {}, false), xml_.colour(n, "k", {}, false)};
  const std::string name = xml_.word(n, "material", "none");
  if (name == "none") return {};
  if (const Metal* metal = find_metal(name)) return {metal->eta, metal->k};
  xml_.fail(n, "no metal '" + name + "'", "give eta and k, or one of " + metal_names());
}

Plastic MaterialReader::plastic_of(Node n) {
  Plastic p;
  p.eta = relative_ior(n, 1.49);
  p.diffuse = texture(n, "diffuse_reflectance", {.5f, .5f, .5f});
  p.specular = texture(n, "specular_reflectance", {1, 1, 1});
  p.nonlinear = xml_.flag(n, "nonlinear", false);
  return p;
}

ScatteringPtr MaterialReader::with_sampler(const AnyBrdf& f, const std::string& text) {
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
  xml_.only(n, {"material"});
  const std::string text = xml_.word(n, "material", "");
  const auto load = [this](const std::string& p, const std::string& m) {
    return load_brdf(xml_.beside(p), m);
  };
  return with_sampler(make_brdf(parse_material(text), load), text);
}

ScatteringPtr MaterialReader::from_file(Node n) {
  xml_.only(n, {"filename"});
  return with_sampler(load_brdf(xml_.beside(xml_.word(n, "filename", ""))), "");
}

std::vector<ScatteringPtr> MaterialReader::inside(Node n, int depth) {
  std::vector<ScatteringPtr> found;
  for (const Node c : n.children()) {
    const Node meant = xml_.resolve(c);
    if (std::string_view(meant.name()) == "bsdf") found.push_back(read(meant, depth + 1));
  }
  return found;
}

ScatteringPtr MaterialReader::read(Node n, int depth) {
  if (depth > 8) xml_.fail(n, "materials refer to each other in a circle", "break the circle of ids");
  const auto known = known_.find(n.offset_debug());
  if (known != known_.end()) return known->second;
  return known_[n.offset_debug()] = make(n, depth);
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
    xml_.only(n, {"eta", "k", "material", "specular_reflectance", "alpha", "distribution", "sample_visible"});
    const auto [eta, k] = eta_and_k(n);
    return rough_conductor(roughness(n), eta, k, texture(n, "specular_reflectance", white));
  }
  if (type == "plastic") {
    xml_.only(n, {"int_ior", "ext_ior", "diffuse_reflectance", "specular_reflectance", "nonlinear"});
    return plastic(plastic_of(n));
  }
  if (type == "roughplastic") {
    xml_.only(n, {"int_ior", "ext_ior", "diffuse_reflectance", "specular_reflectance", "nonlinear", "alpha",
                  "distribution", "sample_visible"});
    return rough_plastic(plastic_of(n), roughness(n));
  }
  if (type == "dielectric") {
    xml_.only(n, {"int_ior", "ext_ior", "specular_reflectance", "specular_transmittance"});
    return dielectric(relative_ior(n, 1.5046), texture(n, "specular_reflectance", white),
                      texture(n, "specular_transmittance", white));
  }
  if (type == "measured") return from_file(n);
  if (type == "reflectree") return from_text(n);
  if (type == "twosided") {
    const auto sides = inside(n, depth);
    if (sides.empty() || sides.size() > 2) xml_.fail(n, "one or two bsdfs are needed", "put them there");
    return two_sided(sides.front(), sides.back());
  }
  if (type == "blendbsdf") {
    const auto parts = inside(n, depth);
    if (parts.size() != 2) xml_.fail(n, "two bsdfs are needed", "put them there");
    return blend(texture(n, "weight", {.5f, .5f, .5f}), parts[0], parts[1]);
  }
  xml_.unknown(n);
}

}  // namespace reflectree::render
