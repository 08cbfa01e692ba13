/* SPDX-License-Identifier: Apache-2.0
 * Functions that the tests in C hand to the library. */
#ifndef REFLECTREE_TESTS_C_FUNCTIONS_H
#define REFLECTREE_TESTS_C_FUNCTIONS_H

#include <math.h>
#include <stddef.h>

/* A matt ground and a lobe about the half vector, three channels; `user` is its height. */
static int glossy(void* user, size_t n, const float* wo, const float* wi, float* values) {
  const float height = *(const float*)user;
  for (size_t i = 0; i < n; ++i) {
    const float hx = wo[3 * i] + wi[3 * i], hy = wo[3 * i + 1] + wi[3 * i + 1],
                hz = wo[3 * i + 2] + wi[3 * i + 2];
    const float cosine = hz / sqrtf(hx * hx + hy * hy + hz * hz);
    const float lobe = height * powf(cosine, 40);
    values[3 * i] = 0.1f + lobe;
    values[3 * i + 1] = 0.05f + lobe;
    values[3 * i + 2] = 0.02f + 0.5f * lobe;
  }
  return 0;
}

/* 1 / pi in one channel: albedo 1 for every viewer. */
static int matt(void* user, size_t n, const float* wo, const float* wi, float* values) {
  (void)user, (void)wo, (void)wi;
  for (size_t i = 0; i < n; ++i) values[i] = 0.31830988618f;
  return 0;
}

#endif
