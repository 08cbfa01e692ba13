// SPDX-License-Identifier: Apache-2.0
// The options of building, and what a subcommand works on: a BRDF with its sampler.
#pragma once

#include <CLI/CLI.hpp>

#include "context.hpp"
#include "reflectree/formats/open.hpp"
#include "reflectree/sampler/certify.hpp"
#include "reflectree/sampler/prove_albedo.hpp"

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

// As reflectree::open_sampler, with the user's choices. `at`: of a family, the parameters of its member that is
// meant. Throws Error, Cancelled.
OpenedSampler open_sampler(const Context& context, const std::string& text, const BuildChoices& choices,
                           const std::string& at = "");
OpenedFamily open_family(const Context& context, const std::string& text, const BuildChoices& choices);
// The option --at.
void add_member_choice(CLI::App& command, std::string& at);

// Throws Error where a file cannot be written there.
void check_output(const std::string& path);

// Proves what can be proved of the subject's bounds, says what was, and packs it again. Throws Error, Cancelled.
OpenedSampler certified(const Context& context, OpenedSampler subject, const CertifyOptions& options);
OpenedFamily certified(const Context& context, OpenedFamily subject, const CertifyOptions& options);
// Proves the albedo to within a relative error, or as far as that is possible, and says so. Throws likewise.
void prove_albedo_of(const Context& context, OpenedSampler& subject, double relative_error);

}  // namespace reflectree::cli
