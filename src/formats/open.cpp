// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/open.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>

#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/sampler_file.hpp"

namespace reflectree {

namespace fs = std::filesystem;

namespace {

OpenedSampler assemble(const std::string& text, AnyBrdf f, SamplerData data, const FilePlaces& places) {
  auto packed = std::make_shared<const PackedSampler>(pack(data));
  Sampler<AnyBrdf> sampler{ExactSampler<AnyBrdf>(f, packed), OneShotSampler<AnyBrdf>(f, packed)};
  return {text, std::move(f), std::move(data), std::move(packed), std::move(sampler), places, "", {}, {}};
}

// The material of a sampler's data.
AnyBrdf brdf_of(const SamplerData& data, const FilePlaces& places) {
  AnyBrdf f = make_brdf(parse_material(data.material, places), places);
  check_identity(data, f);
  return f;
}

}  // namespace

std::string FilePlaces::find(const std::string& path) const {
  std::error_code ignored;
  if (fs::exists(path, ignored) || !fs::path(path).is_relative()) return path;
  for (const fs::path& folder : {fs::path(beside).parent_path(), fs::path(data)}) {
    if (folder.empty()) continue;
    const fs::path other = folder / path;
    if (fs::exists(other, ignored)) return other.string();
  }
  return path;
}

FilePlaces FilePlaces::with_neighbours_of(const std::string& file) const {
  FilePlaces places = *this;
  places.beside = file;
  return places;
}

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

AnyBrdf open_brdf(const std::string& text, const FilePlaces& places) {
  if (!names_sampler_file(text, places)) return make_brdf(parse_material(text, places), places);
  const std::string path = places.find(text);
  return brdf_of(load_sampler(path), places.with_neighbours_of(path));
}

OpenedSampler build_named_sampler(const std::string& text, AnyBrdf f, const FilePlaces& places,
                                  const BuildOptions& options, const Host& host) {
  const auto start = std::chrono::steady_clock::now();
  SamplerData data = build(f, options, host);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  OpenedSampler subject = assemble(text, std::move(f), std::move(data), places);
  subject.build_seconds = took.count();
  return subject;
}

OpenedSampler open_sampler_file(const std::string& text, const FilePlaces& places) {
  const std::string path = places.find(text);
  const FilePlaces neighbours = places.with_neighbours_of(path);
  SamplerData data = load_sampler(path);
  AnyBrdf f = brdf_of(data, neighbours);
  OpenedSampler subject = assemble(text, std::move(f), std::move(data), neighbours);
  subject.sampler_file = path;
  subject.file_size = fs::file_size(path);
  return subject;
}

OpenedSampler open_sampler(const std::string& text, const FilePlaces& places, const BuildOptions& options,
                           const Host& host) {
  if (names_sampler_file(text, places)) return open_sampler_file(text, places);
  return build_named_sampler(text, open_brdf(text, places), places, options, host);
}

}  // namespace reflectree
