// SPDX-License-Identifier: Apache-2.0
// Materials as text:  0.3*lambert:rho=0.5 + ggx:alpha=0.1,f0=1/0.8/0.3
//
//   material  = term { "+" term }                       up to 16 terms, 4096 bytes
//   term      = [ weight "*" ] ( model [ ":" parameter { "," parameter } ] | path [ "#" member ] )
//   parameter = name "=" number [ "/" number "/" number ]       one number serves r, g and b
//             | name "=" number ".." number                     a range: a family (family.hpp)
//
// A word that contains "." or "/" or is followed by "#" is a path; any other must be a model of the registry.
// A path or member in double quotes may hold anything (\" and \\ inside). `alpha=0.1` sets a model's
// alpha_x and alpha_y. Parameters left out take their defaults. Blanks between tokens do not matter. One or
// two ranges in all; their names are those of the family's parameters.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "reflectree/brdf/family.hpp"

namespace reflectree {

// Values of a term that vary together, from `lo` to `hi`.
struct VariedRange {
  std::size_t first = 0, count = 1;
  float lo = 0, hi = 1;
  friend bool operator==(const VariedRange&, const VariedRange&) = default;
};

// A model of the registry with a value for each of its parameters, in order; or a file (`model` empty).
struct MaterialTerm {
  float weight = 1;
  std::string model;
  std::vector<Rgb> values;  // of those that vary, the lower ends
  std::string path, member;
  std::vector<VariedRange> varied = {};
  friend bool operator==(const MaterialTerm&, const MaterialTerm&) = default;
};

struct Material {
  std::vector<MaterialTerm> terms;
  friend bool operator==(const Material&, const Material&) = default;
};

// Throws Error with the column of what it cannot read. Where `exists` is given, a text (or PATH#member) that
// names an existing file as a whole is that file, whatever it contains.
using FileExists = std::function<bool(const std::string& path)>;
Material parse_material(std::string_view text, const FileExists& exists = nullptr);

// Whether any of its parameters has a range.
bool is_family(const Material& material);

// The canonical text: every parameter named, shortest numbers. parse_material(to_text(m)) == m.
std::string to_text(const Material& material);

// The canonical text of a file's member ("" where there is none): PATH#MEMBER, quoted where need be.
std::string file_text(const std::string& path, const std::string& member);

// Loads the BRDF of a file's member ("" where the file is one BRDF); throws Error.
using FileLoader = std::function<AnyBrdf(const std::string& path, const std::string& member)>;

// The BRDF that a material describes; its traits().name is the canonical text. Throws Error for an unknown
// model, a value out of range, a file without a loader, terms whose channels disagree, or a family.
AnyBrdf make_brdf(const Material& material, const FileLoader& load_file = nullptr);
// The family that a material with ranges describes, likewise.
AnyFamily make_family(const Material& material, const FileLoader& load_file = nullptr);
// The member of a material with ranges at fixed parameters, as a material. Throws Error outside of the ranges.
Material member_of(const Material& material, const Parameters& at);

}  // namespace reflectree
