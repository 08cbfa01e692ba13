// SPDX-License-Identifier: Apache-2.0
// The scenes of the study in pictures, each with every sampler that takes its materials.
#pragma once

#include <optional>
#include <span>

#include "reflectree/render/scene.hpp"

namespace reflectree::pictures {

struct Setting {
  const char* name;
  const char* file;
  const char* words;
  bool measured;  // needs REFLECTREE_DATA
  bool pictured;  // its pictures are shown, not its figures alone
  bool combined;  // with other ways of reducing variance
  // Pairs of names and values; of a value that begins with '/', a file of REFLECTREE_DATA.
  std::span<const char* const> defines;
};
std::span<const Setting> settings();

// Empty where REFLECTREE_DATA is not set.
std::string data_folder();

// Throws Error, Cancelled.
render::Scene load(const Setting& setting, const std::string& folder, const std::string& sampler,
                   const Host& host);

// The same scene, seen as 1 where a material is drawn from by the sampler and 0 elsewhere.
render::Scene sampled_part(const render::Scene& scene);
// The same, whose materials draw N directions independently of each other.
render::Scene undivided(render::Scene scene);

}  // namespace reflectree::pictures
