// SPDX-License-Identifier: Apache-2.0
#include "callback.hpp"

#include <cmath>
#include <vector>

#include "reflectree/text/number_text.hpp"

namespace reflectree::c {

namespace {

// Pairs above the surface, gathered for one call; each thread keeps the memory.
struct Gathered {
  std::vector<float> wo, wi, values;
  std::vector<std::size_t> place;
  void clear() { wo.clear(), wi.clear(), place.clear(); }
  void add(Direction o, Direction i, std::size_t at) {
    wo.insert(wo.end(), {o.x, o.y, o.z});
    wi.insert(wi.end(), {i.x, i.y, i.z});
    place.push_back(at);
  }
};

std::string text_of(const float* w) {
  std::string text = "(";
  for (int k = 0; k < 3; ++k) text += (k ? ", " : "") + shortest_text(w[k]);
  return text + ")";
}

void check_values(const Callback& callback, const Gathered& pairs) {
  const auto channels = std::size_t(callback.channels);
  for (std::size_t i = 0; i < pairs.values.size(); ++i) {
    const float value = pairs.values[i];
    if (value >= 0 && std::isfinite(value)) continue;
    const std::string is = std::isfinite(value) ? shortest_text(value)
                           : std::isnan(value)  ? "NaN"
                                                : "infinite";
    throw CallbackError("channel " + std::to_string(i % channels) + " is " + is + " at wo " +
                            text_of(&pairs.wo[3 * (i / channels)]) + ", wi " +
                            text_of(&pairs.wi[3 * (i / channels)]),
                        callback.name, "return a number that is finite and not negative");
  }
}

// `pairs` is not the thread's own any more while the callback runs: it may call us again.
void call(const CallbackBrdf& f, Gathered& pairs, std::span<float> out) {
  const Callback& callback = *f.callback;
  const auto channels = std::size_t(callback.channels);
  const std::size_t n = pairs.place.size();
  std::fill(out.begin(), out.end(), 0.f);
  if (n == 0) return;
  // What a callback forgets to write is seen.
  pairs.values.assign(n * channels, std::nanf(""));
  int failed = 0;
  const auto run = [&] {
    failed = callback.f(callback.user, n, pairs.wo.data(), pairs.wi.data(), pairs.values.data());
  };
  if (callback.flags & REFLECTREE_CONCURRENT) {
    run();
  } else {
    const std::lock_guard<std::recursive_mutex> lock(callback.mutex);
    run();
  }
  if (failed != 0) {
    throw CallbackError("the function returned " + std::to_string(failed) + " for " + std::to_string(n) +
                            " pairs, the first with wo " + text_of(pairs.wo.data()) + ", wi " +
                            text_of(pairs.wi.data()),
                        callback.name, "return 0 when all values are written");
  }
  if (f.checks) check_values(callback, pairs);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t c = 0; c < channels; ++c)
      out[pairs.place[k] * channels + c] = pairs.values[k * channels + c];
  }
}

template <class Fill>
void gather_and_call(const CallbackBrdf& f, std::span<float> out, const Fill& fill) {
  thread_local Gathered kept;
  Gathered pairs;
  std::swap(pairs, kept);
  pairs.clear();
  fill(pairs);
  call(f, pairs, out);
  std::swap(pairs, kept);
}

}  // namespace

void CallbackBrdf::eval(std::span<const Direction> wo, std::span<const Direction> wi,
                        std::span<float> out) const {
  gather_and_call(*this, out, [&](Gathered& pairs) {
    for (std::size_t i = 0; i < wo.size(); ++i) {
      if (wo[i].z > 0 && wi[i].z > 0) pairs.add(wo[i], wi[i], i);
    }
  });
}

void CallbackBrdf::eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
  gather_and_call(*this, out, [&](Gathered& pairs) {
    for (std::size_t i = 0; i < geometry.size(); ++i) pairs.add(geometry[i].wo, geometry[i].wi, i);
  });
}

BrdfTraits CallbackBrdf::traits() const {
  BrdfTraits traits;
  traits.name = callback->name;
  traits.channels = callback->channels;
  traits.isotropic_by_formula = (callback->flags & REFLECTREE_ISOTROPIC) != 0;
  traits.concurrent = (callback->flags & REFLECTREE_CONCURRENT) != 0;
  return traits;
}

}  // namespace reflectree::c
