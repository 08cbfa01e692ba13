// SPDX-License-Identifier: Apache-2.0
// <bsdf> and <texture>.
#pragma once

#include "reflectree/brdf/material/material.hpp"
#include "xml_reader.hpp"

namespace reflectree::render {

class MaterialReader {
 public:
  MaterialReader(const XmlReader& xml, const Host& host) : xml_(xml), host_(host) {}
  ScatteringPtr read(Node n) { return read(n, 0); }
  // What a lamp sends from all over it; none where `n` has one colour.
  std::optional<Texture> emission(Node n, const char* name);
  // The attributes of meshes that textures name, and those that a material asks for, a bit each.
  const std::vector<std::string>& attribute_names() const { return attribute_names_; }
  std::uint32_t attributes_of(const ScatteringPtr& made) const {
    const auto found = attributes_of_.find(made.get());
    return found == attributes_of_.end() ? 0 : found->second;
  }
  // Whether any material lets light pass as it came.
  bool lets_pass() const { return lets_pass_; }

 private:
  ScatteringPtr read(Node n, int depth);
  ScatteringPtr make(Node n, int depth);
  ScatteringPtr from_file(Node n);
  ScatteringPtr from_text(Node n);
  ScatteringPtr from_family(Node n, const Material& material);
  ScatteringPtr with_sampler(const AnyBrdf& f, const std::string& text);
  // Its bsdfs; a reference of the name `texture` may lead to a texture.
  std::vector<ScatteringPtr> inside(Node n, int depth, std::string_view texture = "");
  ScatteringPtr only_one_inside(Node n, int depth, std::string_view texture);
  ScatteringPtr perturbed(Node n, int depth);
  Texture texture(Node n, const char* name, Rgb otherwise);
  // A number that may vary over the surface: a colour's mean, a picture's luminance, as in Mitsuba.
  Texture number(Node n, const char* name, double otherwise);
  Texture texture_of(Node t);
  Texture mesh_attribute(Node t);
  Texture raw_constant(Node t) const;
  Texture bitmap(Node t) const;
  Texture checkerboard(Node t) const;
  std::array<float, 6> to_uv(Node t) const;
  // An interface's widths; pictures in place of the numbers, where it may have any.
  struct Widened {
    Roughness roughness;
    Texture x, y;
  };
  Widened roughness(Node n, bool pictures);
  PlasticParameters plastic_of(Node n);
  float relative_ior(Node n, double inside) const;
  double ior(Node n, const char* name, double otherwise) const;
  std::pair<Rgb, Rgb> eta_and_k(Node n) const;

  const XmlReader& xml_;
  const Host& host_;
  std::map<std::ptrdiff_t, ScatteringPtr> known_;  // by place in the file: each is made once
  std::vector<std::string> attribute_names_;
  std::map<const Scattering*, std::uint32_t> attributes_of_;
  std::uint32_t asked_ = 0;  // by the material that is being read
  bool lets_pass_ = false;
};

}  // namespace reflectree::render
