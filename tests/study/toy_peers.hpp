// SPDX-License-Identifier: Apache-2.0
// Competitors whose variance, bias and error are known in closed form.
#pragma once

#include "reflectree/study/measure.hpp"

namespace reflectree::study {

struct CosineToy {
  using Value = Spectrum;
  AnyBrdf f;
  float planted = 1;  // every weight times this
  float claimed = 1;  // every density times this
  template <RandomBits U>
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, U& u) const {
    const float r2 = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(r2);
    const Direction wi{r * cos(phi), r * sin(phi), sqrt(1 - r2)};
    return DirectionSample<Spectrum>{wi, wi.z / pi, scaled_value(eval(f, wo, wi), planted * pi)};
  }
  float pdf(Direction, Direction wi) const { return wi.z / pi * claimed; }
};

// Uniform in solid angle with its density, which a fault claims to be that of the cosine lobe.
struct DenseUniformToy {
  using Value = Spectrum;
  AnyBrdf f;
  bool lying = false;
  template <RandomBits U>
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, U& u) const {
    const float z = 1 - to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(max(0.f, 1 - z * z));
    const Direction wi{r * cos(phi), r * sin(phi), z};
    return DirectionSample<Spectrum>{wi, pdf(wo, wi), scaled_value(eval(f, wo, wi), 2 * pi * z)};
  }
  float pdf(Direction, Direction wi) const { return lying ? wi.z / pi : 1 / (2 * pi); }
};

// Uniform in solid angle; loses every direction with phi in the first `lost` of a turn, and has no pdf().
struct UniformToy {
  using Value = Spectrum;
  AnyBrdf f;
  float lost = 0;
  template <RandomBits U>
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, U& u) const {
    const float z = 1 - to_unit_float(u()), turn = to_unit_float(u()), r = sqrt(max(0.f, 1 - z * z));
    if (turn < lost) return std::nullopt;
    const Direction wi{r * cos(2 * pi * turn), r * sin(2 * pi * turn), z};
    return DirectionSample<Spectrum>{wi, 1 / (2 * pi), scaled_value(eval(f, wo, wi), 2 * pi * z)};
  }
};

inline AnyBrdf brdf(const char* text) { return make_brdf(parse_material(text)); }

}  // namespace reflectree::study
