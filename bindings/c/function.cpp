// SPDX-License-Identifier: Apache-2.0
// Functions of the C interface: from a pointer, a text, a file.
#include <algorithm>
#include <array>

#include "callback.hpp"
#include "directions.hpp"
#include "handles.hpp"

using namespace reflectree;
using namespace reflectree::c;

extern "C" {

reflectree_status reflectree_function_callback(const char* name, int channels, uint32_t flags,
                                               reflectree_callback f, void* user, void (*release)(void* user),
                                               reflectree_function** out) {
  return at_border([&] {
    constexpr const char* where = "reflectree_function_callback";
    *needed(out, where, "out") = nullptr;
    needed(name, where, "name");
    if (!f) refuse(where, "f is null", "pass a function");
    if (channels < 1 || channels > max_channels)
      refuse(where, "channels is " + std::to_string(channels), "pass 1 to 256");
    if (flags & ~std::uint32_t(REFLECTREE_CONCURRENT | REFLECTREE_ISOTROPIC))
      refuse(where, "flags has unknown bits", "pass REFLECTREE_CONCURRENT, REFLECTREE_ISOTROPIC, both or 0");
    const auto callback = std::make_shared<Callback>();
    callback->name = name, callback->channels = channels, callback->flags = flags;
    callback->f = f, callback->user = user;
    *out = new reflectree_function{.building = AnyBrdf(CallbackBrdf{callback, false}),
                                   .f = AnyBrdf(CallbackBrdf{callback, true})};
    callback->release = release;  // from now on the handle answers for it
  });
}

reflectree_status reflectree_function_open(const char* text, const char* data, reflectree_function** out) {
  return at_border([&] {
    constexpr const char* where = "reflectree_function_open";
    *needed(out, where, "out") = nullptr;
    FilePlaces places;
    if (data) places.data = data;
    const AnyBrdf f = open_brdf(needed(text, where, "text"), places);
    *out = new reflectree_function{.building = f, .f = f};
  });
}

void reflectree_function_free(reflectree_function* f) {
  if (f && f->kind == reflectree_function::own_kind) delete f;
}

int reflectree_function_channels(const reflectree_function* f) {
  return f && f->kind == reflectree_function::own_kind ? f->f.channels() : 0;
}

reflectree_status reflectree_function_eval(const reflectree_function* f, size_t n, const float* wo,
                                           const float* wi, float* values) {
  return at_border([&] {
    constexpr const char* where = "reflectree_function_eval";
    const AnyBrdf& brdf = checked(f, where, "f").f;
    eval_pairs(brdf, n, wo, wi, values, where);
  });
}
}
