// SPDX-License-Identifier: Apache-2.0
// From words to a sampler, for every face alike: a material's text or the path of a sampler file becomes a
// BRDF, and a BRDF with its sampler.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "reflectree/formats/open_brdf.hpp"
#include "reflectree/host.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/family_sampler.hpp"

namespace reflectree {

// What faces work on: a BRDF with its sampler.
struct OpenedSampler {
  std::string text;  // as it was asked for
  AnyBrdf f;
  SamplerData data;
  std::shared_ptr<const PackedSampler> packed;
  Sampler<AnyBrdf> sampler;
  FilePlaces places;                       // where its files are, neighbours of its sampler file included
  std::string sampler_file;                // where it was found; empty: built
  std::optional<std::uint64_t> file_size;  // of the sampler file
  std::optional<double> build_seconds;     // of a sampler that was built
};

// A family with its sampler.
struct OpenedFamily {
  std::string text;
  AnyFamily family;
  SamplerData data;
  std::shared_ptr<const PackedSampler> packed;
  FamilySampler<AnyFamily> sampler;
  FilePlaces places;
  std::string sampler_file;
  std::optional<std::uint64_t> file_size;
  std::optional<double> build_seconds;
};

// Whether the text is of a material with ranges, or names the file of its sampler. Throws Error for what
// names neither material nor sampler.
bool names_family(const std::string& text, const FilePlaces& places);
// Builds or loads it. Throws Error, Cancelled.
OpenedFamily open_family(const std::string& text, const FilePlaces& places = {},
                         const BuildOptions& options = {}, const Host& host = {});
// Of canonical data of a family, which its text names or which is at hand. Throws Error, also where the data
// is of another.
OpenedFamily open_family(SamplerData data, const FilePlaces& places);
OpenedFamily open_family(AnyFamily family, SamplerData data, const FilePlaces& places = {});
// Its member as a sampler like any other (member.hpp). Throws Error outside of the ranges.
OpenedSampler open_member(const OpenedFamily& family, const Parameters& at);
// "alpha=0.3" or "alpha_x=0.1,alpha_y=0.3": a number for each parameter, in any order. Throws Error.
Parameters parse_parameters(const std::string& text, const std::vector<ParameterRange>& ranges);

// Builds the sampler of `f`, which `text` names. Throws Error, Cancelled.
OpenedSampler build_named_sampler(const std::string& text, AnyBrdf f, const FilePlaces& places,
                                  const BuildOptions& options, const Host& host);
// Loads a sampler file with its material, and checks that they belong together. Throws Error.
OpenedSampler open_sampler_file(const std::string& text, const FilePlaces& places);
// Either, by what the text names; a sampler file takes no options.
OpenedSampler open_sampler(const std::string& text, const FilePlaces& places = {},
                           const BuildOptions& options = {}, const Host& host = {});

}  // namespace reflectree
