/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime_in_c.h"

const char* c_load(rfl_sampler* s, const void* bytes, size_t size) { return rfl_load_bytes(s, bytes, size); }

int c_one_shot(const rfl_sampler* s, rfl_vec wo, c_bits next, void* state, rfl_draw* out) {
  rfl_viewer v;
  uint32_t bits[4];
  if (!rfl_view(s, wo, &v)) return 0;
  for (int i = 0; i < 4; ++i) bits[i] = next(state);
  rfl_one_shot(s, &v, bits, out);
  return 1;
}

int c_one_shot_uniforms(const rfl_sampler* s, rfl_vec wo, double u1, double u2, rfl_draw* out) {
  rfl_viewer v;
  return rfl_view(s, wo, &v) && rfl_one_shot_uniforms(s, &v, u1, u2, out);
}

int c_one_shot_invert(const rfl_sampler* s, rfl_vec wo, rfl_vec wi, double* u) {
  rfl_viewer v;
  return rfl_view(s, wo, &v) && rfl_one_shot_invert(s, &v, wi, u) > 0;
}

float c_one_shot_pdf(const rfl_sampler* s, rfl_vec wo, rfl_vec wi) {
  rfl_viewer v;
  return rfl_view(s, wo, &v) ? rfl_one_shot_pdf(s, &v, wi) : 0;
}

int c_exact(const rfl_sampler* s, rfl_vec wo, c_function f, void* user, int channels, c_bits next,
            void* state, rfl_draw* out, float* value) {
  rfl_viewer v;
  rfl_candidate c;
  uint32_t bits[4];
  if (!rfl_view(s, wo, &v)) return 0;
  for (int trial = 0; trial < RFL_MAX_TRIALS; ++trial) {
    for (int i = 0; i < 4; ++i) bits[i] = next(state);
    rfl_propose(s, &v, bits, &c);
    f(user, v.known, c.wi, value);
    if (rfl_accept(&v, &c, rfl_target(s, value, channels), next(state), out)) return 1;
  }
  return 0;
}

float c_exact_pdf(const rfl_sampler* s, rfl_vec wo, rfl_vec wi, const float* f, int channels) {
  rfl_viewer v;
  return rfl_view(s, wo, &v) ? rfl_exact_pdf(&v, wi, rfl_target(s, f, channels)) : 0;
}
