/* SPDX-License-Identifier: Apache-2.0
 * Eight threads share one sampler of a function that must not be called at once, and one that may; each
 * thread has its own sentence. Results are those of one thread. */
#include "check.h"
#include "functions.h"
#include "reflectree.h"

#include <pthread.h>

#define THREADS 8
#define N 2000

static int inside = 0; /* calls that are under way: written without a lock, as a careless function would */

static int alone(void* user, size_t n, const float* wo, const float* wi, float* values) {
  const int before = inside++;
  const int failed = glossy(user, n, wo, wi, values);
  --inside;
  return before == 0 ? failed : 99;
}

static float wo[3 * N];

struct work {
  const reflectree_sampler* samplers[2];
  int number, failures;
  float wi[2][3 * N], weight[2][3 * N];
};

static void* run(void* argument) {
  struct work* w = argument;
  for (int k = 0; k < 2; ++k) {
    reflectree_pcg32 random;
    reflectree_pcg32_seed(&random, 5, (uint64_t)w->number);
    const reflectree_status status =
        k == 0 ? reflectree_sample_exact(w->samplers[k], N, wo, reflectree_pcg32_next, &random, w->wi[k],
                                         NULL, w->weight[k])
               : reflectree_sample_one_shot(w->samplers[k], N, wo, reflectree_pcg32_next, &random, w->wi[k],
                                            NULL, w->weight[k]);
    w->failures += status != REFLECTREE_OK;
    char words[32];
    snprintf(words, sizeof words, "mode is %d;", 100 + w->number);
    reflectree_pdf(w->samplers[k], 100 + w->number, 1, wo, wo, w->wi[0]);
    w->failures += strstr(reflectree_last_error(), words) == NULL;
  }
  /* Building in every thread, too. */
  reflectree_function* f;
  reflectree_sampler* s;
  w->failures +=
      reflectree_function_callback("matt", 1, REFLECTREE_CONCURRENT, matt, NULL, NULL, &f) != REFLECTREE_OK;
  w->failures += reflectree_build(f, NULL, &s) != REFLECTREE_OK;
  reflectree_function_free(f), reflectree_sampler_free(s);
  return NULL;
}

static struct work threads[THREADS], serial;

int main(void) {
  float height = 2;
  reflectree_function* f[2];
  reflectree_sampler* s[2];
  for (int i = 0; i < N; ++i) {
    const float z = 0.05f + 0.9f * (float)i / N;
    wo[3 * i] = sqrtf(1 - z * z), wo[3 * i + 1] = 0, wo[3 * i + 2] = z;
  }
  CHECK_OK(reflectree_function_callback("alone", 3, 0, alone, &height, NULL, &f[0]));
  CHECK_OK(reflectree_function_callback("glossy", 3, REFLECTREE_CONCURRENT, glossy, &height, NULL, &f[1]));
  for (int k = 0; k < 2; ++k) CHECK_OK(reflectree_build(f[k], NULL, &s[k]));
  pthread_t ids[THREADS];
  for (int t = 0; t < THREADS; ++t) {
    threads[t] = (struct work){.samplers = {s[0], s[1]}, .number = t};
    CHECK(pthread_create(&ids[t], NULL, run, &threads[t]) == 0);
  }
  for (int t = 0; t < THREADS; ++t) pthread_join(ids[t], NULL);
  for (int t = 0; t < THREADS; ++t) {
    serial = (struct work){.samplers = {s[0], s[1]}, .number = t};
    run(&serial);
    CHECK(threads[t].failures == 0 && serial.failures == 0);
    CHECK(memcmp(threads[t].wi, serial.wi, sizeof serial.wi) == 0);
    CHECK(memcmp(threads[t].weight, serial.weight, sizeof serial.weight) == 0);
    CHECK(serial.weight[1][0] > 0);
  }
  for (int k = 0; k < 2; ++k) reflectree_function_free(f[k]), reflectree_sampler_free(s[k]);
  return check_result("c_threads");
}
