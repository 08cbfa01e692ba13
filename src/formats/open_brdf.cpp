// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/open_brdf.hpp"

#include <filesystem>
#include <fstream>

#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/identity.hpp"

namespace reflectree {

namespace fs = std::filesystem;

bool names_sampler_file(const std::string& text, const FilePlaces& places) {
  std::error_code ignored;
  const std::string path = places.find(text);
  if (!fs::is_regular_file(path, ignored)) return false;
  std::ifstream in(path, std::ios::binary);
  Bytes start(8);
  in.read(reinterpret_cast<char*>(start.data()), std::streamsize(start.size()));
  return in.gcount() == 8 && is_sampler_file(start);
}

Material parse_material(const std::string& text, const FilePlaces& places) {
  return parse_material(text, [&](const std::string& path) {
    std::error_code ignored;
    return fs::exists(places.find(path), ignored);  // reading tells what is no file of a material
  });
}

Bytes read_material_file(const std::string& path, const FilePlaces& places) {
  const std::string found = places.find(path);
  if (found != path && places.elsewhere) places.elsewhere(path, found);
  return read_file(found, max_material_bytes());
}

AnyBrdf make_brdf(const Material& material, const FilePlaces& places) {
  return make_brdf(material, [&](const std::string& path, const std::string& member) {
    return read_brdf(read_material_file(path, places), path, member);
  });
}

AnyBrdf brdf_of(const SamplerData& sampler, const FilePlaces& places) {
  AnyBrdf f = make_brdf(parse_material(sampler.material, places), places);
  check_identity(sampler, f);
  return f;
}

AnyBrdf open_brdf(const std::string& text, const FilePlaces& places) {
  if (!names_sampler_file(text, places)) return make_brdf(parse_material(text, places), places);
  const std::string path = places.find(text);
  return brdf_of(load_sampler(path), places.with_neighbours_of(path));
}

}  // namespace reflectree
