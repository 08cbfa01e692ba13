// SPDX-License-Identifier: Apache-2.0
// What Python calls a Sampler: a BRDF, the canonical data, and both modes.
#pragma once

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

// Densities of a mode per solid angle at pairs, from the values of f there, which one-shot mode does not read.
void densities_into(const PySampler& s, bool one_shot, std::span<const Direction> wo,
                    std::span<const Direction> wi, std::span<const float> values, std::span<float> out);

}  // namespace reflectree::python
