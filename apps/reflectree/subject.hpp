// SPDX-License-Identifier: Apache-2.0
// What a subcommand works on: a BRDF with its sampler, from a material's text or from a sampler file.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "context.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/sampler/sampler.hpp"

namespace reflectree::cli {

// The options of building, for every subcommand that may build.
struct BuildChoices {
  float trials = BuildOptions{}.expected_trials;
  float variance = BuildOptions{}.one_shot_variance;
  std::string target = "norm", domain = "auto";
  bool given = false;  // any of them, by the user
};
void add_build_choices(CLI::App& command, BuildChoices& choices);
// Throws Error for words that mean nothing.
BuildOptions build_options(const Context& context, const BuildChoices& choices);

struct Subject {
  std::string text;    // as the user wrote it
  std::string beside;  // the sampler file, beside which its material may lie; empty: none
  AnyBrdf f;
  SamplerData data;
  std::shared_ptr<const PackedSampler> packed;
  Sampler<AnyBrdf> sampler;
  std::optional<double> build_seconds;     // of a material
  std::optional<std::uint64_t> file_size;  // of a sampler file
};

// Files are looked for in the current folder, beside `beside` where that is given, and in the data folder.
Material parse(const Context& context, const std::string& text, const std::string& beside = "");
AnyBrdf load_material(const Context& context, const Material& material, const std::string& beside = "");
// Where a material's file is, and its bytes.
Bytes read_material_file(const Context& context, const std::string& path, const std::string& beside);
bool names_sampler_file(const Context& context, const std::string& text);

// Builds a material's sampler, or loads a sampler file with its material. Throws Error, Cancelled.
Subject open_subject(const Context& context, const std::string& text, const BuildChoices& choices);

}  // namespace reflectree::cli
