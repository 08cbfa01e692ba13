// SPDX-License-Identifier: Apache-2.0
// The one list of the analytic models. Registry, `list`, textbook samplers and tests read it: a new model is
// a header beside this one, and its name in the list below.
#pragma once

#include <type_traits>

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

template <class... M>
struct ModelList {
  // The same types as arguments of another template, such as testing::Types.
  template <template <class...> class Other>
  using as = Other<M...>;

  template <class Visit>
  static void for_each(const Visit& visit) {
    (visit(std::type_identity<M>()), ...);
  }
};

// In the order in which `list` shows them.
// clang-format off
using AllModels = ModelList<
    Lambert,
    OrenNayar,
    Phong,
    Lafortune,
    Ward,
    AshikhminShirley,
    CookTorrance,
    Ggx,
    Plastic,
    RetroReflector,
    LowSmooth>;
// clang-format on

// for_each_model([]<class M>(std::type_identity<M>) { ... })
template <class Visit>
void for_each_model(const Visit& visit) {
  AllModels::for_each(visit);
}

}  // namespace reflectree
