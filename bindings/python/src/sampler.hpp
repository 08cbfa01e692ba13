// SPDX-License-Identifier: Apache-2.0
// What Python calls a Sampler: a BRDF, the canonical data, and both modes.
#pragma once

#include <array>

#include "brdf.hpp"
#include "reflectree/sampler/sampler.hpp"

namespace reflectree::python {

struct PySampler {
  // Throws Error if the data was built for another BRDF.
  PySampler(PyBrdf brdf, SamplerData data);

  PyBrdf brdf;
  SamplerData data;
  Sampler<AnyBrdf> sampler;
};

// What a build is asked for: reflectree::BuildOptions in Python's words. Throws Error.
BuildOptions build_options(const std::string& target, int channel, float expected_trials,
                           float one_shot_variance, float albedo_error, std::uint64_t seed,
                           std::uint64_t max_evaluations);
nb::dict report_of(const BuildReport& report);

// Densities of a mode per solid angle at pairs, from the values of f there, which one-shot mode does not read.
void densities_into(const PySampler& s, bool one_shot, std::span<const Direction> wo,
                    std::span<const Direction> wi, std::span<const float> values, std::span<float> out);
// The run-time arrays of a mode, as bytes by name.
nb::dict tables_of(const PackedSampler& packed, const SamplerData& data, bool one_shot);
// wi and its density by one-shot mode, 0 for no sample; that density. f is not evaluated.
std::array<float, 4> draw_one(const PySampler& s, const std::array<float, 3>& wo, double u1, double u2);
float density_one(const PySampler& s, const std::array<float, 3>& wo, const std::array<float, 3>& wi);

}  // namespace reflectree::python
