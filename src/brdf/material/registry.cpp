// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/registry.hpp"

#include <algorithm>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/material/baked_tables.hpp"
#include "reflectree/brdf/material/model_family.hpp"
#include "reflectree/brdf/models/all.hpp"
#include "reflectree/text/edit_distance.hpp"

namespace reflectree {
namespace {

template <class M>
ModelInfo entry() {
  const auto description = M::describe();
  ModelInfo info{
      description.name, description.model_class, description.summary, description.source, {}, {}, {}, {}};
  for (const auto& p : description.parameters) {
    info.parameters.push_back(
        {p.name, p.is_rgb() ? 3 : 1, p.lo, p.hi, p.get(M{}), p.unit, p.meaning, p.is_quiet()});
  }
  info.fault = [](std::span<const Rgb> values) -> const char* {
    if constexpr (requires(const M& m) { m.fault(); }) return model_from_values<M>(values).fault();
    return nullptr;
  };
  // The model's own formula encloses itself.
  info.make = [](std::span<const Rgb> values) -> AnyBrdf {
    const M model = model_from_values<M>(values);
    return Enclosed<M>(model, symmetry_of_model(model));
  };
  info.make_family = [](std::span<const Rgb> values, std::span<const VariedValues> varied,
                        const std::vector<ParameterRange>& ranges, const std::string& name) -> AnyFamily {
    ModelFamily<M> family(model_from_values<M>(values));
    const auto parameters = M::describe().parameters;
    for (const VariedValues& v : varied) {
      for (std::size_t i = 0; i < v.count; ++i) family.vary(parameters[v.first + i], v.parameter);
    }
    return Family<ModelFamily<M>>{std::move(family), ranges, name};
  };
  return info;
}

// A table without parameters, computed when it is asked for.
template <std::size_t index>
ModelInfo baked_entry() {
  const BakedTable& table = baked_tables()[index];
  ModelInfo info{table.name, ModelClass::approximate, table.summary, "computed", {}, {}, {}, {}};
  info.fault = [](std::span<const Rgb>) -> const char* { return nullptr; };
  info.make = [](std::span<const Rgb>) -> AnyBrdf {
    return enclosed(bake_table(baked_tables()[index].name));
  };
  info.make_family = [](std::span<const Rgb>, std::span<const VariedValues>,
                        const std::vector<ParameterRange>&, const std::string& name) -> AnyFamily {
    throw Error("a table has no parameters", name, "give ranges to a model");
  };
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
  static const std::vector<ModelInfo> all = [] {
    std::vector<ModelInfo> list;
    for_each_model([&list]<class M>(std::type_identity<M>) { list.push_back(entry<M>()); });
    for (const auto make : {baked_entry<0>, baked_entry<1>, baked_entry<2>}) list.push_back(make());
    return list;
  }();
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
