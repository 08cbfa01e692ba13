// SPDX-License-Identifier: Apache-2.0
// Every model, by name: the analytic ones of models/all.hpp and the baked tables.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "reflectree/brdf/family.hpp"
#include "reflectree/brdf/material/description.hpp"

namespace reflectree {

// A ModelParameter whose model is erased. Values are Rgb; a float parameter (channels = 1) uses r alone.
struct ParameterInfo {
  std::string_view name;
  int channels = 1;  // 1 or 3
  float lo = 0, hi = 1;
  Rgb initial;  // default
  std::string_view unit, meaning;
  bool quiet = false;  // left out of the canonical text where it is 0
};

// Values of a model, one after the other, that follow one parameter of a family.
struct VariedValues {
  std::size_t first = 0, count = 1;
  std::size_t parameter = 0;
};

struct ModelInfo {
  std::string_view name;
  ModelClass model_class;
  std::string_view summary, source;
  std::vector<ParameterInfo> parameters;
  // What is wrong with a combination of values that are each in range, or nullptr.
  const char* (*fault)(std::span<const Rgb> values);
  // The model with one value per parameter, in the order of `parameters`.
  AnyBrdf (*make)(std::span<const Rgb> values);
  // The family in which some of the values follow parameters of it; `ranges` and `name` are the family's.
  AnyFamily (*make_family)(std::span<const Rgb> values, std::span<const VariedValues> varied,
                           const std::vector<ParameterRange>& ranges, const std::string& name);
};

// In the order in which `list` shows them.
std::span<const ModelInfo> models();
// nullptr where there is none of that name.
const ModelInfo* find_model(std::string_view name);
// The known model whose name is nearest by edit distance.
const ModelInfo& nearest_model(std::string_view name);

}  // namespace reflectree
