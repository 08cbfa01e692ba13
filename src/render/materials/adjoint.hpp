// SPDX-License-Identifier: Apache-2.0
// Light's side of a function that has a sampler of the viewer's side alone.
#pragma once

#include "cosine_lobe.hpp"

namespace reflectree::render {

// A direction wo in which light from wi goes on: drawn as if wi were the viewer's, or, `cosine` of the time,
// from a cosine lobe, which reaches what the ordinary sampler may miss. `draw(u)` gives a direction or none;
// `pdf(wo)` is its density per solid angle; `f(wo)` the function's value from wo to wi.
template <class Draw, class Pdf, class Value>
std::optional<Scattered> draw_adjoint(float cosine, PathBits& u, const Draw& draw, const Pdf& pdf,
                                      const Value& f) {
  Direction wo;
  if (to_unit_float(u()) < cosine) {
    wo = cosine_direction(u);
  } else {
    UniformBits bits = u.lend();
    const auto drawn = draw(bits);
    u.take_back(bits);
    if (!drawn) return std::nullopt;
    wo = drawn->wi;
  }
  const float density = cosine * cosine_pdf(wo) + (1 - cosine) * pdf(wo);
  if (!(density > 0)) return std::nullopt;
  return Scattered{wo, density, (wo.z / density) * f(wo)};
}

}  // namespace reflectree::render
