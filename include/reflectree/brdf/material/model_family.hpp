// SPDX-License-Identifier: Apache-2.0
// The family of a model whose parameters have ranges, by the names of its description.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/family.hpp"
#include "reflectree/brdf/material/description.hpp"

namespace reflectree {

// A model some of whose numbers are forms.
template <class M>
class ModelFamilyEnclosure final : public FamilyEnclosure {
 public:
  using Forms = typename WithNumber<M, AffineForm>::type;
  struct Number {
    std::size_t place, parameter;  // in describe() and in the family
  };
  ModelFamilyEnclosure(const M& model, std::vector<Number> numbers) : keeps_(symmetry_of_model(model)) {
    const auto from = M::describe().parameters;
    const auto to = Forms::describe().parameters;
    for (std::size_t i = 0; i < to.size(); ++i) to[i].set(forms_, from[i].get(model));
    for (const Number& n : numbers) parts_.push_back({to[n.place], n.parameter});
  }
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g, const ParameterForms& at) const override {
    Forms member = forms_;
    for (const auto& [part, parameter] : parts_) *part.number_in(member) = at[parameter];
    return member(g);
  }
  ExactSymmetry keeps() const override { return keeps_; }

 private:
  struct Part {
    ModelParameter<Forms> part;
    std::size_t parameter;
  };
  Forms forms_;
  std::vector<Part> parts_;
  ExactSymmetry keeps_;
};

template <class M>
class ModelFamily {
  static_assert(std::is_trivially_copyable_v<M>);

 public:
  explicit ModelFamily(M model) : model_(std::move(model)) {}

  // `part`, a number of the model, follows a parameter of the family; both of a pair of widths may follow one.
  void vary(const ModelParameter<M>& part, std::size_t parameter) {
    if (const float* number = part.number_in(model_)) {
      numbers_.push_back({place_of(number), parameter});
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
  // None of a model without numbers, where an azimuth varies, or where two widths may meet: a round member has
  // another formula.
  std::shared_ptr<const FamilyEnclosure> enclosure(const std::vector<ParameterRange>& ranges) const {
    if constexpr (requires { typename WithNumber<M, AffineForm>::type; }) {
      Parameters lo{}, hi{};
      for (std::size_t i = 0; i < ranges.size(); ++i) lo[i] = ranges[i].lo, hi[i] = ranges[i].hi;
      const M least = at(lo), most = at(hi);
      if (!others_.empty()) return nullptr;
      if constexpr (requires { model_.alpha.round(); }) {
        const bool apart = most.alpha.x < least.alpha.y || most.alpha.y < least.alpha.x;
        if (follows(&model_.alpha.x) != follows(&model_.alpha.y) && !apart) return nullptr;
      }
      const auto description = M::describe().parameters;
      std::vector<typename ModelFamilyEnclosure<M>::Number> numbers;
      for (std::size_t i = 0; i < description.size(); ++i) {
        const std::size_t parameter = follows(description[i].number_in(model_));
        if (parameter < ranges.size()) numbers.push_back({i, parameter});
      }
      return std::make_shared<ModelFamilyEnclosure<M>>(least, std::move(numbers));
    } else {
      return nullptr;
    }
  }
  // Of a member.
  bool may_be_turned(const M& member) const {
    if constexpr (requires { member.alpha.round(); }) {
      return member.alpha.round();
    } else {
      return false;
    }
  }

 private:
  std::size_t place_of(const float* number) const {
    return std::size_t(reinterpret_cast<const std::byte*>(number) -
                       reinterpret_cast<const std::byte*>(&model_));
  }
  // The parameter that a number of the model follows; max_parameters where there is none.
  std::size_t follows(const float* number) const {
    for (const Number& n : numbers_) {
      if (number && n.place == place_of(number)) return n.parameter;
    }
    return max_parameters;
  }

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
