// SPDX-License-Identifier: Apache-2.0
// Every sampler that can be chosen by name: ours and the competitors, each from its paper. One enters with
// one line in registry.cpp.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/host.hpp"
#include "reflectree/sampler/any_sampler.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

// What a method is given. Its own textbook sampler needs the material's text; every other the function alone.
struct PeerSubject {
  AnyBrdf f;
  Material material;
  Target target;
  std::shared_ptr<const PackedSampler> packed = nullptr;  // ours, if it has been built: not built again
};

struct SamplerInfo {
  std::string_view name;     // of the command line: exact, one-shot, paper, cosine, ...
  std::string_view summary;  // in a line
  std::string_view source;   // paper
  bool general;              // takes any BRDF
  bool unbiased;             // false: the published method itself is biased
  // nullopt: not for this material. Throws Error, Cancelled.
  std::optional<AnySampler<Spectrum>> (*make)(const PeerSubject&, const Host&);
};

// In the order in which tables show them.
std::span<const SamplerInfo> samplers();
// nullptr where there is none of that name.
const SamplerInfo* find_sampler(std::string_view name);

}  // namespace reflectree
