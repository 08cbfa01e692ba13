// SPDX-License-Identifier: Apache-2.0
// A material that answers about many pairs one by one, but with one virtual call for all of them: `Self` is
// final, and its own functions are called by name.
#pragma once

#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

template <class Self>
struct Each : Scattering {
  const Self& self() const { return static_cast<const Self&>(*this); }
  Value value(Direction wo, Direction wi, Place place) const override {
    return {self().Self::f_cos(wo, wi, place), self().Self::pdf(wo, wi, place)};
  }
  void values(std::span<const View> views, std::span<const Direction> wi, std::span<Value> out) const final {
    for (std::size_t i = 0; i < views.size(); ++i)
      out[i] = self().Self::value(views[i].wo, wi[i], views[i].place);
  }
  void samples(std::span<const View> views, std::span<PathBits* const> u,
               std::span<std::optional<Scattered>> out) const final {
    for (std::size_t i = 0; i < views.size(); ++i)
      out[i] = self().Self::sample(views[i].wo, views[i].place, *u[i]);
  }
};

}  // namespace reflectree::render
