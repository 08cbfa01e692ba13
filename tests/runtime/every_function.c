/* SPDX-License-Identifier: Apache-2.0
 * Calls every function of the runtime, so that compilers look at all of it; also as C++. */
#include "reflectree_load.h"

float every_function(const char* path, const uint32_t* words, size_t count, const uint32_t* bits);
float every_function(const char* path, const uint32_t* words, size_t count, const uint32_t* bits) {
  const float f[3] = {0.25f, 0.5f, 0.125f};
  float sum = 0;
  double u[2];
  rfl_sampler s;
  rfl_viewer v;
  rfl_draw d;
  rfl_candidate c;
  if (rfl_open(&s, words, count) != NULL && rfl_load(&s, path) != NULL) return -1;
  if (rfl_view(&s, rfl_vec3(0.6f, 0, 0.8f), &v)) {
    rfl_one_shot(&s, &v, bits, &d), sum += d.pdf;
    if (rfl_one_shot_uniforms(&s, &v, 0.25, 0.75, &d)) sum += d.pdf;
    sum += rfl_one_shot_pdf(&s, &v, d.wi) + rfl_one_shot_invert(&s, &v, d.wi, u);
    rfl_propose(&s, &v, bits, &c);
    if (rfl_accept(&v, &c, rfl_target(&s, f, 3), bits[4], &d)) sum += rfl_exact_pdf(&v, d.wi, 0.1f);
  }
  rfl_free(&s);
  return sum;
}
