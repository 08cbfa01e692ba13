/* SPDX-License-Identifier: Apache-2.0
 * The C interface from C: what it computes, and that what it offers agrees with itself.
 * tests/c/agreement_test.cpp compares it with the C++ samplers bit by bit. */
#include "check.h"
#include "functions.h"
#include "reflectree.h"

#include <stdlib.h>

#define N 4000

static float wo[3 * N], wi[3 * N], pdf[N], weight[3 * N], values[3 * N], other[N];
static double u[2 * N], back[2 * N];

/* Viewers over the hemisphere, each its own. */
static void fill_viewers(void) {
  for (int i = 0; i < N; ++i) {
    const float z = 0.02f + 0.97f * (float)i / N, r = sqrtf(1 - z * z), phi = 2.4f * (float)i;
    wo[3 * i] = r * cosf(phi), wo[3 * i + 1] = r * sinf(phi), wo[3 * i + 2] = z;
  }
}

static void samples_are_consistent(const reflectree_sampler* s, int mode) {
  reflectree_pcg32 random;
  reflectree_pcg32_seed(&random, 7, 0);
  if (mode == REFLECTREE_EXACT) {
    CHECK_OK(reflectree_sample_exact(s, N, wo, reflectree_pcg32_next, &random, wi, pdf, weight));
  } else {
    CHECK_OK(reflectree_sample_one_shot(s, N, wo, reflectree_pcg32_next, &random, wi, pdf, weight));
  }
  CHECK_OK(reflectree_eval(s, N, wo, wi, values));
  CHECK_OK(reflectree_pdf(s, mode, N, wo, wi, other));
  int drawn = 0;
  for (int i = 0; i < N; ++i) {
    if (!(pdf[i] > 0)) continue;
    ++drawn;
    CHECK(fabsf(other[i] / pdf[i] - 1) < 2e-3f);
    for (int c = 0; c < 3; ++c)
      CHECK(fabsf(weight[3 * i + c] * pdf[i] - values[3 * i + c] * wi[3 * i + 2]) <=
            2e-3f * values[3 * i + c] * wi[3 * i + 2]);
  }
  CHECK(drawn > N - 5);
}

/* The mean weight of channel 0 for one viewer is the albedo of that channel: two modes and the points agree
 * within five standard errors. `bend` plants a fault in one of them: the twin. */
static double z_of_two_means(const reflectree_sampler* s, float bend) {
  float one[3 * N];
  double mean[2], square[2];
  reflectree_pcg32 random;
  reflectree_pcg32_seed(&random, 11, 0);
  for (int i = 0; i < N; ++i) one[3 * i] = 0.6f, one[3 * i + 1] = 0, one[3 * i + 2] = 0.8f;
  for (int way = 0; way < 2; ++way) {
    mean[way] = square[way] = 0;
    for (int round = 0; round < 20; ++round) {
      if (way == 0)
        CHECK_OK(reflectree_sample_exact(s, N, one, reflectree_pcg32_next, &random, wi, pdf, weight));
      if (way == 1)
        CHECK_OK(reflectree_sample_one_shot(s, N, one, reflectree_pcg32_next, &random, wi, pdf, weight));
      for (int i = 0; i < N; ++i) {
        /* The light is bright on one side, so that the weights of exact mode differ, too. */
        const double x = weight[3 * i] * (1.0 + wi[3 * i + 1]) * (way == 1 ? bend : 1);
        mean[way] += x / (20.0 * N), square[way] += x * x / (20.0 * N);
      }
    }
  }
  const double variance = (square[0] - mean[0] * mean[0] + square[1] - mean[1] * mean[1]) / (20.0 * N);
  return fabs(mean[0] - mean[1]) / sqrt(variance);
}

static void points_and_back(const reflectree_sampler* s) {
  for (int i = 0; i < N; ++i) u[2 * i] = (i + 0.5) / N, u[2 * i + 1] = fmod(0.6180339887 * i, 1);
  CHECK_OK(reflectree_sample_uniforms(s, N, wo, u, wi, pdf, weight));
  CHECK_OK(reflectree_invert(s, N, wo, wi, back));
  int close = 0;
  for (int i = 0; i < N; ++i)
    close += fabs(back[2 * i] - u[2 * i]) < 2e-3 && fabs(back[2 * i + 1] - u[2 * i + 1]) < 2e-3;
  CHECK(close > N * 99 / 100);
  u[0] = 1.5;
  CHECK_OK(reflectree_sample_uniforms(s, 1, wo, u, wi, pdf, weight));
  CHECK(pdf[0] == 0 && weight[0] == 0 && wi[2] == 0);
  const float below[3] = {0, 0.6f, -0.8f};
  CHECK_OK(reflectree_invert(s, 1, wo, below, back));
  CHECK(back[0] == -1 && back[1] == -1);
}

static void albedo_of_matt(void) {
  reflectree_function* f;
  reflectree_sampler* s;
  CHECK_OK(reflectree_function_callback("matt", 1, REFLECTREE_CONCURRENT | REFLECTREE_ISOTROPIC, matt, NULL,
                                        NULL, &f));
  CHECK_OK(reflectree_build(f, NULL, &s));
  reflectree_function_free(f);
  CHECK_OK(reflectree_albedo(s, N, wo, pdf));
  CHECK_OK(reflectree_expected_trials(s, N, wo, other));
  for (int i = 0; i < N; ++i) CHECK(fabsf(pdf[i] - 1) < 2e-4f && other[i] >= 0.999f && other[i] < 1.26f);
  CHECK(reflectree_sampler_channels(s) == 1);
  reflectree_sampler_free(s);
}

static int no_progress_backwards(void* user, float fraction, const char* stage) {
  float* last = user;
  CHECK(fraction >= *last && fraction <= 1 && stage[0] != 0);
  *last = fraction;
  return 0;
}
static int stop(void* user, float fraction, const char* stage) {
  (void)stage;
  ++*(int*)user;
  return fraction > 0.05f;
}

static void saved_and_loaded(const reflectree_function* f, const reflectree_sampler* s, const char* path) {
  reflectree_sampler* again;
  CHECK_OK(reflectree_save(s, path));
  CHECK_OK(reflectree_load(path, f, NULL, &again));
  reflectree_pcg32 a, b;
  reflectree_pcg32_seed(&a, 3, 1), reflectree_pcg32_seed(&b, 3, 1);
  CHECK_OK(reflectree_sample_exact(s, N, wo, reflectree_pcg32_next, &a, wi, NULL, NULL));
  CHECK_OK(reflectree_sample_exact(again, N, wo, reflectree_pcg32_next, &b, values, NULL, NULL));
  CHECK(memcmp(wi, values, sizeof wi) == 0);
  CHECK(strcmp(reflectree_info_text(s), reflectree_info_text(again)) == 0);
  reflectree_sampler_free(again);
  /* Its material is a name that no text knows; another function is refused. */
  CHECK_STATUS(reflectree_load(path, NULL, NULL, &again), REFLECTREE_ERROR_REFUSED, "glossy");
  CHECK(again == NULL);
  float height = 9;
  reflectree_function* wrong;
  CHECK_OK(reflectree_function_callback("other", 3, 0, glossy, &height, NULL, &wrong));
  CHECK_STATUS(reflectree_load(path, wrong, NULL, &again), REFLECTREE_ERROR_REFUSED, path == NULL ? "" : "");
  reflectree_function_free(wrong);
  remove(path);
}

static void material_text(const char* path) {
  reflectree_function *f, *from_file;
  reflectree_sampler *s, *again;
  CHECK_OK(reflectree_function_open("0.5*lambert:rho=0.5 + ggx:alpha=0.3", NULL, &f));
  CHECK(reflectree_function_channels(f) == 3);
  CHECK_OK(reflectree_build(f, NULL, &s));
  CHECK_OK(reflectree_save(s, path));
  CHECK_OK(reflectree_load(path, NULL, NULL, &again));
  CHECK(strcmp(reflectree_info_json(s), reflectree_info_json(again)) == 0);
  CHECK(strstr(reflectree_info_json(s), "\"channels\": 3") != NULL);
  CHECK_OK(reflectree_function_open(path, NULL, &from_file));
  CHECK_OK(reflectree_function_eval(from_file, N, wo, wo, values));
  CHECK_OK(reflectree_eval(again, N, wo, wo, weight));
  CHECK(memcmp(values, weight, sizeof values) == 0 && values[0] > 0);
  samples_are_consistent(again, REFLECTREE_EXACT);
  reflectree_function_free(f), reflectree_function_free(from_file);
  reflectree_sampler_free(s), reflectree_sampler_free(again);
  remove(path);
}

int main(void) {
  float height = 2;
  reflectree_function* f;
  reflectree_sampler *s, *one_thread;
  CHECK(reflectree_interface_version() == REFLECTREE_INTERFACE_VERSION);
  CHECK(strlen(reflectree_version()) >= 5);
  fill_viewers();
  CHECK_OK(reflectree_function_callback("glossy", 3, REFLECTREE_CONCURRENT, glossy, &height, NULL, &f));
  float last = 0;
  reflectree_build_options options;
  CHECK_OK(reflectree_build_options_init(&options, sizeof options));
  options.progress = no_progress_backwards;
  options.progress_user = &last;
  options.threads = 2;
  CHECK_OK(reflectree_build(f, &options, &s));
  CHECK(last == 1);
  /* The result does not depend on the threads. */
  options.threads = 1;
  options.progress = NULL;
  CHECK_OK(reflectree_build(f, &options, &one_thread));
  CHECK(strcmp(reflectree_info_text(s), reflectree_info_text(one_thread)) == 0);
  reflectree_sampler_free(one_thread);
  int calls = 0;
  options.progress = stop;
  options.progress_user = &calls;
  CHECK_STATUS(reflectree_build(f, &options, &one_thread), REFLECTREE_CANCELLED, "cancelled");
  CHECK(one_thread == NULL && calls > 0);

  samples_are_consistent(s, REFLECTREE_EXACT);
  samples_are_consistent(s, REFLECTREE_ONE_SHOT);
  CHECK(z_of_two_means(s, 1) < 5);
  CHECK(z_of_two_means(s, 1.02f) > 5); /* the twin: weights of one-shot mode 2 % too heavy */
  points_and_back(s);
  saved_and_loaded(f, s, "c_interface_test.rfl");
  reflectree_function_free(f);
  samples_are_consistent(s, REFLECTREE_EXACT); /* the sampler lives on */
  reflectree_sampler_free(s);
  albedo_of_matt();
  material_text("c_interface_text_test.rfl");
  return check_result("c_interface");
}
