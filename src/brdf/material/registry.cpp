// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/registry.hpp"

#include <algorithm>

#include "reflectree/brdf/material/baked_tables.hpp"
#include "reflectree/text/edit_distance.hpp"
#include "reflectree/brdf/models/ashikhmin_shirley.hpp"
#include "reflectree/brdf/models/cook_torrance.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lafortune.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/low_smooth.hpp"
#include "reflectree/brdf/models/oren_nayar.hpp"
#include "reflectree/brdf/models/phong.hpp"
#include "reflectree/brdf/models/plastic.hpp"
#include "reflectree/brdf/models/retro_reflector.hpp"
#include "reflectree/brdf/models/ward.hpp"

namespace reflectree {
namespace {

template <class M>
M with_values(std::span<const Rgb> values) {
  const auto description = M::describe();
  M model;
  for (std::size_t i = 0; i < description.parameters.size(); ++i)
    description.parameters[i].set(model, values[i]);
  return model;
}

template <class M>
ModelInfo entry() {
  const auto description = M::describe();
  ModelInfo info{
      description.name, description.model_class, description.summary, description.source, {}, {}, {}};
  for (const auto& p : description.parameters) {
    info.parameters.push_back({p.name, p.is_rgb() ? 3 : 1, p.lo, p.hi, p.get(M{}), p.unit, p.meaning});
  }
  info.fault = [](std::span<const Rgb> values) -> const char* {
    if constexpr (requires(const M& m) { m.fault(); }) return with_values<M>(values).fault();
    return nullptr;
  };
  info.make = [](std::span<const Rgb> values) -> AnyBrdf { return with_values<M>(values); };
  return info;
}

// A table without parameters, computed when it is asked for.
template <std::size_t index>
ModelInfo baked_entry() {
  const BakedTable& table = baked_tables()[index];
  ModelInfo info{table.name, ModelClass::approximate, table.summary, "computed", {}, {}, {}};
  info.fault = [](std::span<const Rgb>) -> const char* { return nullptr; };
  info.make = [](std::span<const Rgb>) -> AnyBrdf { return bake_table(baked_tables()[index].name); };
  return info;
}

}  // namespace

const char* name_of(ModelClass model_class) {
  switch (model_class) {
    case ModelClass::physical:
      return "physical";
    case ModelClass::approximate:
      return "approximate";
    case ModelClass::experimental:
      return "experimental";
  }
  return "unknown";
}

std::span<const ModelInfo> models() {
  // clang-format off
  static const std::vector<ModelInfo> all = {
      entry<Lambert>(),
      entry<OrenNayar>(),
      entry<Phong>(),
      entry<Lafortune>(),
      entry<Ward>(),
      entry<AshikhminShirley>(),
      entry<CookTorrance>(),
      entry<Ggx>(),
      entry<Plastic>(),
      entry<RetroReflector>(),
      entry<LowSmooth>(),
      baked_entry<0>(),
      baked_entry<1>(),
      baked_entry<2>(),
  };
  // clang-format on
  return all;
}

const ModelInfo* find_model(std::string_view name) {
  for (const ModelInfo& model : models()) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

const ModelInfo& nearest_model(std::string_view name) {
  const auto all = models();
  return *std::min_element(all.begin(), all.end(), [name](const ModelInfo& a, const ModelInfo& b) {
    return edit_distance(name, a.name) < edit_distance(name, b.name);
  });
}

}  // namespace reflectree
