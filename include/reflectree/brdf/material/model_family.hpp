// SPDX-License-Identifier: Apache-2.0
// The family of a model whose parameters have ranges, by the names of its description.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "reflectree/brdf/family.hpp"
#include "reflectree/brdf/material/description.hpp"

namespace reflectree {

template <class M>
class ModelFamily {
  static_assert(std::is_trivially_copyable_v<M>);

 public:
  explicit ModelFamily(M model) : model_(std::move(model)) {}

  // `part`, a number of the model, follows a parameter of the family; both of a pair of widths may follow one.
  void vary(const ModelParameter<M>& part, std::size_t parameter) {
    if (const float* number = part.number_in(model_)) {
      const auto place =
          reinterpret_cast<const std::byte*>(number) - reinterpret_cast<const std::byte*>(&model_);
      numbers_.push_back({std::size_t(place), parameter});
    } else {
      others_.push_back({part, parameter});
    }
  }

  M at(const Parameters& parameters) const {
    M member = model_;
    for (const Number& n : numbers_)
      std::memcpy(reinterpret_cast<std::byte*>(&member) + n.place, &parameters[n.parameter], sizeof(float));
    for (const Other& o : others_) {
      const float value = parameters[o.parameter];
      o.part.set(member, {value, value, value});
    }
    return member;
  }
  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g, const Parameters& parameters) const {
    return at(parameters)(g);
  }
  // In a batch neighbours are often of one member.
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters> parameters,
            std::span<float> out) const {
    for (std::size_t i = 0; i < geometry.size();) {
      const M member = at(parameters[i]);
      for (const Parameters& same = parameters[i]; i < geometry.size() && parameters[i] == same; ++i) {
        const Rgb value = as_value(member(geometry[i]));
        out[3 * i] = value.r, out[3 * i + 1] = value.g, out[3 * i + 2] = value.b;
      }
    }
  }
  BrdfTraits traits(const Parameters& parameters) const { return at(parameters).traits(); }
  // Of a member.
  bool may_be_turned(const M& member) const {
    if constexpr (requires { member.alpha.round(); }) {
      return member.alpha.round();
    } else {
      return false;
    }
  }

 private:
  // A member is made for every sample: floats are written to their places.
  struct Number {
    std::size_t place, parameter;
  };
  struct Other {
    ModelParameter<M> part;
    std::size_t parameter;
  };
  M model_;
  std::vector<Number> numbers_;
  std::vector<Other> others_;
};

// The parameter of that name, or the pair NAME_x, NAME_y; none where the model has none.
template <class M>
std::vector<ModelParameter<M>> parts_named(std::string_view name) {
  std::vector<ModelParameter<M>> parts;
  for (const auto& p : M::describe().parameters) {
    const bool one_of_pair = p.name.size() == name.size() + 2 && p.name.starts_with(name) &&
                             (p.name.ends_with("_x") || p.name.ends_with("_y"));
    if (p.name == name || one_of_pair) parts.push_back(p);
  }
  return parts;
}

// model_family(Plastic{}, {{"alpha", 0.02f, 1}}). Throws Error for a parameter that the model has not, that
// is a colour, or whose range leaves that of the model.
template <class M>
Family<ModelFamily<M>> model_family(M model, const std::vector<ParameterRange>& ranges,
                                    std::string name = "family") {
  const std::string where(M::describe().name);
  check_ranges(ranges, where);
  ModelFamily<M> family(std::move(model));
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const ParameterRange& range = ranges[i];
    const std::vector<ModelParameter<M>> parts = parts_named<M>(range.name);
    if (parts.empty()) throw Error("has no parameter " + range.name, where, "see `list`");
    if (parts.front().is_rgb())
      throw Error(range.name + " is a colour, and families vary numbers", where, "vary another parameter");
    if (!(range.lo >= parts.front().lo && range.hi <= parts.front().hi)) {
      throw Error(
          "the range of " + range.name + " leaves that of the model", where,
          "stay between " + std::to_string(parts.front().lo) + " and " + std::to_string(parts.front().hi));
    }
    for (const ModelParameter<M>& part : parts) family.vary(part, i);
  }
  return {std::move(family), ranges, std::move(name)};
}

}  // namespace reflectree
