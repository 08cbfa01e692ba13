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

// The run-time arrays of a mode, as bytes by name.
nb::dict tables_of(const PySampler& s, bool one_shot);

}  // namespace reflectree::python
