// SPDX-License-Identifier: Apache-2.0
// A function of the caller's, known by a pointer, as a BRDF.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "border.hpp"
#include "reflectree/brdf/brdf.hpp"

namespace reflectree::c {

// What the caller handed over; released with the last that holds it.
struct Callback {
  std::string name;
  int channels = 0;
  std::uint32_t flags = 0;
  reflectree_callback f = nullptr;
  void* user = nullptr;
  void (*release)(void*) = nullptr;
  mutable std::recursive_mutex mutex;  // of functions that are not concurrent

  ~Callback() {
    if (release) release(user);
  }
};

// Throws CallbackError where the callback says so. `checks`: also where it returns what no BRDF is; for
// whoever evaluates without the builder, which looks at values itself and knows better words.
struct CallbackBrdf {
  std::shared_ptr<const Callback> callback;
  bool checks = true;

  // Zero below the surface, as every batch of channels.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const;
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const;
  Spectrum operator()(Direction wo, Direction wi) const {
    Spectrum value(callback->channels);
    eval({&wo, 1}, {&wi, 1}, {value.data(), std::size_t(callback->channels)});
    return value;
  }
  BrdfTraits traits() const;
};

}  // namespace reflectree::c
