// SPDX-License-Identifier: Apache-2.0
// Samplers that were built, and their copies with one thing spoiled, for the tests of the checks.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "reflectree/brdf/models/plastic.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

// A coloured material, small, of known type: batches are computed in lanes.
inline const Plastic& coloured() {
  static const Plastic f = [] {
    Plastic p;
    p.kd = {0.5f, 0.2f, 0.1f};
    p.alpha = 0.3f;
    return p;
  }();
  return f;
}

struct Built {
  SamplerData data;
  Sampler<Plastic> sampler;
  Suspect suspect() const;
};
const Built& built();

// The same from data or a packed form of one's own.
Sampler<Plastic> sampler_of(PackedSampler packed);
Suspect suspect_of(const Sampler<Plastic>& sampler, const SamplerData* data = nullptr);

inline bool fails(std::span<const CheckResult> results, const std::string& name) {
  bool found = false, failed = false;
  for (const CheckResult& r : results) {
    found = found || r.name == name;
    failed = failed || (r.name == name && !r.passed);
  }
  EXPECT_TRUE(found) << "no check named " << name;
  return failed;
}
inline void expect_all_pass(std::span<const CheckResult> results) {
  for (const CheckResult& r : results) EXPECT_TRUE(r.passed) << to_line(r);
}

}  // namespace reflectree
