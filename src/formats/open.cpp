// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/open.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/member.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {

namespace fs = std::filesystem;

namespace {

OpenedSampler assemble(const std::string& text, AnyBrdf f, SamplerData data, const FilePlaces& places) {
  auto packed = std::make_shared<const PackedSampler>(pack(data));
  Sampler<AnyBrdf> sampler{ExactSampler<AnyBrdf>(f, packed), OneShotSampler<AnyBrdf>(f, packed)};
  return {text, std::move(f), std::move(data), std::move(packed), std::move(sampler), places, "", {}, {}};
}

AnyFamily family_of(const std::string& text, const FilePlaces& places) {
  return make_family(parse_material(text, places), [&](const std::string& file, const std::string& member) {
    return read_brdf(read_material_file(file, places), file, member);
  });
}

OpenedFamily assemble(const std::string& text, AnyFamily family, SamplerData data, const FilePlaces& places) {
  auto packed = std::make_shared<const PackedSampler>(pack(data));
  auto shared = std::make_shared<const Family<AnyFamily>>(
      Family<AnyFamily>{family, family.ranges(), family.traits().name});
  FamilySampler<AnyFamily> sampler{{shared, packed}, {shared, packed}};
  return {text, std::move(family), std::move(data), std::move(packed), std::move(sampler), places, "", {},
          {}};
}

}  // namespace

OpenedSampler build_named_sampler(const std::string& text, AnyBrdf f, const FilePlaces& places,
                                  const BuildOptions& options, const Host& host) {
  const auto start = std::chrono::steady_clock::now();
  SamplerData data = build(f, options, host);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  OpenedSampler subject = assemble(text, std::move(f), std::move(data), places);
  subject.build_seconds = took.count();
  return subject;
}

bool names_family(const std::string& text, const FilePlaces& places) {
  if (names_sampler_file(text, places)) return !load_sampler(places.find(text)).parameters.empty();
  return is_family(parse_material(text, places));
}

OpenedFamily open_family(SamplerData data, const FilePlaces& places) {
  AnyFamily family = family_of(data.material, places);
  return open_family(std::move(family), std::move(data), places);
}

OpenedFamily open_family(AnyFamily family, SamplerData data, const FilePlaces& places) {
  check_identity(data, family);
  const std::string text = data.material;
  return assemble(text, std::move(family), std::move(data), places);
}

OpenedFamily open_family(const std::string& text, const FilePlaces& places, const BuildOptions& options,
                         const Host& host) {
  if (names_sampler_file(text, places)) {
    const std::string path = places.find(text);
    OpenedFamily opened = open_family(load_sampler(path), places.with_neighbours_of(path));
    opened.text = text, opened.sampler_file = path, opened.file_size = fs::file_size(path);
    return opened;
  }
  AnyFamily family = family_of(text, places);
  const auto start = std::chrono::steady_clock::now();
  SamplerData data = build(family, options, host);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  OpenedFamily opened = assemble(text, std::move(family), std::move(data), places);
  opened.build_seconds = took.count();
  return opened;
}

OpenedSampler open_member(const OpenedFamily& family, const Parameters& at) {
  const Material material = member_of(parse_material(family.data.material, family.places), at);
  AnyBrdf f = make_brdf(material, family.places);
  SamplerData data = member_data(family.data, at, f.traits().name, probe_identity(f, family.data.target));
  const std::string text = data.material;
  OpenedSampler member = assemble(text, std::move(f), std::move(data), family.places);
  member.build_seconds = family.build_seconds;
  return member;
}

Parameters parse_parameters(const std::string& text, const std::vector<ParameterRange>& ranges) {
  const std::string where = "'" + text + "'";
  std::string how;
  for (const ParameterRange& r : ranges)
    how += (how.empty() ? "" : ",") + r.name + "=" + shortest_text(r.lo) + ".." + shortest_text(r.hi);
  Parameters at{};
  std::vector<bool> given(ranges.size(), false);
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t equals = rest.find('=');
    const std::string name(rest.substr(0, equals));
    const auto found =
        std::find_if(ranges.begin(), ranges.end(), [&](const ParameterRange& r) { return r.name == name; });
    if (equals == std::string_view::npos || found == ranges.end())
      throw Error("no parameter '" + name + "' has a range", where, "give numbers within " + how);
    rest.remove_prefix(equals + 1);
    const auto value = take_number(rest);
    const auto i = std::size_t(found - ranges.begin());
    if (!value || (!rest.empty() && rest.front() != ',') || given[i])
      throw Error("expected one number for " + name, where, "give numbers within " + how);
    if (!found->contains(*value))
      throw Error(name + " is outside of its range", where, "give numbers within " + how);
    at[i] = *value, given[i] = true;
    if (!rest.empty()) rest.remove_prefix(1);
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (!given[i]) throw Error("no number for " + ranges[i].name, where, "give numbers within " + how);
  }
  return at;
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
