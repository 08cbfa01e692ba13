// SPDX-License-Identifier: Apache-2.0
// How a model describes itself. Each model struct has a static describe(), next to its formula; the
// parser, the printer, the registry and the documentation all read it, so that they cannot disagree.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/brdf/models/widths.hpp"

namespace reflectree {

// physical: reciprocal and energy-conserving for all allowed parameters; approximate: breaks one of
// them for some; experimental: serves tests.
enum class ModelClass { physical, approximate, experimental };
const char* name_of(ModelClass model_class);

// The numbers of a model: floats, or what its template was given.
template <class M>
struct NumberIn {
  using type = float;
};
template <template <class> class Model, class N>
struct NumberIn<Model<N>> {
  using type = N;
};
// The same model with other numbers.
template <class M, class N>
struct WithNumber {};
template <template <class> class Model, class Old, class N>
struct WithNumber<Model<Old>, N> {
  using type = Model<N>;
};

// A parameter of model M: a member, float or Rgb, with its range (per channel, borders included).
// The default is the member's initialiser. A pair NAME_x, NAME_y, one after the other, can be given together
// as NAME, and is printed so where both are equal.
template <class M>
struct ModelParameter {
  using Number = typename NumberIn<M>::type;
  std::string_view name;
  // A number, a colour, one of two widths, or an azimuth.
  struct Width {
    WidthsOf<Number> M::*widths;
    Number WidthsOf<Number>::*along;
  };
  std::variant<Number M::*, Rgb M::*, Width, Azimuth M::*> member;
  float lo = 0, hi = 1;
  std::string_view unit;  // "" where there is none
  std::string_view meaning;

  bool is_rgb() const { return member.index() == 1; }
  // An azimuth of 0 goes without saying in the canonical text.
  bool is_quiet() const { return member.index() == 3; }
  Rgb get(const M& model) const {
    if (const auto* colour = std::get_if<1>(&member)) return model.**colour;
    if (const auto* width = std::get_if<2>(&member)) return to_rgb((model.*(width->widths)).*(width->along));
    if (const auto* azimuth = std::get_if<3>(&member)) return to_rgb((model.**azimuth).degrees);
    return to_rgb(model.**std::get_if<0>(&member));
  }
  // The number itself; null of a colour, and of an azimuth, which keeps more than its number.
  const Number* number_in(const M& model) const {
    if (const auto* width = std::get_if<2>(&member)) return &((model.*(width->widths)).*(width->along));
    if (const auto* number = std::get_if<0>(&member)) return &(model.**number);
    return nullptr;
  }
  Number* number_in(M& model) const { return const_cast<Number*>(number_in(std::as_const(model))); }
  void set(M& model, Rgb value) const {
    if (const auto* colour = std::get_if<1>(&member)) {
      model.** colour = value;
    } else if (const auto* width = std::get_if<2>(&member)) {
      (model.*(width->widths)).*(width->along) = Number(value.r);
    } else if (const auto* azimuth = std::get_if<3>(&member)) {
      model.** azimuth = Azimuth(value.r);
    } else {
      model.**std::get_if<0>(&member) = Number(value.r);
    }
  }
};

template <class M>
struct ModelDescription {
  std::string_view name;  // as written in material text
  ModelClass model_class;
  std::string_view summary, source;
  std::vector<ModelParameter<M>> parameters;
};

// The model with a value for each of its parameters, in the order of describe().
template <class M>
M model_from_values(std::span<const Rgb> values) {
  const auto description = M::describe();
  M model;
  for (std::size_t i = 0; i < description.parameters.size(); ++i)
    description.parameters[i].set(model, values[i]);
  return model;
}

// For models whose parts share the energy; a rounding above 1 is let pass.
inline bool sum_above_one(Rgb a, Rgb b) {
  const Rgb sum = a + b;
  return max(sum.r, max(sum.g, sum.b)) > 1.000001f;
}

// "ggx:alpha=0.1,f0=1/0.8/0.3", the canonical text of one model.
struct NamedValue {
  std::string_view name;
  Rgb value;
  bool quiet = false;                                  // left out where it is 0
  float up_to = std::numeric_limits<float>::lowest();  // above `value`: a range, NAME=value..up_to
  bool joined = false;                                 // with its twin of a pair: they vary together
};
std::string model_text(std::string_view model, std::span<const NamedValue> values);

// Isotropic where the formula is; an anisotropic one is mirrored in the plane at its azimuth.
template <class M>
BrdfTraits model_traits(const M& model, bool isotropic = true) {
  const auto description = M::describe();
  std::vector<NamedValue> values;
  for (const auto& p : description.parameters) values.push_back({p.name, p.get(model), p.is_quiet()});
  BrdfTraits traits;
  traits.name = model_text(description.name, values);
  traits.isotropic = traits.isotropic_by_formula = isotropic;
  if constexpr (requires { model.phi; }) {
    if (!isotropic) traits.axis = float(double(model.phi.degrees) * pi_v<double> / 180);
  }
  return traits;
}

}  // namespace reflectree
