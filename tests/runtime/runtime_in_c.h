/* SPDX-License-Identifier: Apache-2.0
 * The runtime as a C compiler makes it, for tests in C++. */
#ifndef REFLECTREE_TESTS_RUNTIME_IN_C_H
#define REFLECTREE_TESTS_RUNTIME_IN_C_H

#include "reflectree_load.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As their namesakes with rfl_; those that need a viewer take wo, and return 0 for no sample. */
const char* c_load(rfl_sampler* s, const void* bytes, size_t size);
typedef uint32_t (*c_bits)(void* state);
typedef void (*c_function)(void* user, rfl_vec wo, rfl_vec wi, float* f);
int c_one_shot(const rfl_sampler* s, rfl_vec wo, c_bits next, void* state, rfl_draw* out);
int c_one_shot_uniforms(const rfl_sampler* s, rfl_vec wo, double u1, double u2, rfl_draw* out);
int c_one_shot_invert(const rfl_sampler* s, rfl_vec wo, rfl_vec wi, double* u);
float c_one_shot_pdf(const rfl_sampler* s, rfl_vec wo, rfl_vec wi);
int c_exact(const rfl_sampler* s, rfl_vec wo, c_function f, void* user, int channels, c_bits next,
            void* state, rfl_draw* out, float* value);
float c_exact_pdf(const rfl_sampler* s, rfl_vec wo, rfl_vec wi, const float* f, int channels);

#ifdef __cplusplus
}
#endif

#endif
