// SPDX-License-Identifier: Apache-2.0
// <bsdf> and <texture>.
#pragma once

#include "xml_reader.hpp"

namespace reflectree::render {

class MaterialReader {
 public:
  MaterialReader(const XmlReader& xml, const Host& host) : xml_(xml), host_(host) {}
  ScatteringPtr read(Node n) { return read(n, 0); }

 private:
  ScatteringPtr read(Node n, int depth);
  ScatteringPtr make(Node n, int depth);
  ScatteringPtr from_file(Node n);
  ScatteringPtr from_text(Node n);
  ScatteringPtr with_sampler(const AnyBrdf& f, const std::string& text);
  std::vector<ScatteringPtr> inside(Node n, int depth);
  Texture texture(Node n, const char* name, Rgb otherwise);
  // A number that may vary over the surface: a colour's mean, a picture's luminance, as in Mitsuba.
  Texture number(Node n, const char* name, double otherwise);
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
};

}  // namespace reflectree::render
