/* SPDX-License-Identifier: Apache-2.0
 * Misuse of the C interface: each gives its code and a sentence, and nothing else happens. */
#include "check.h"
#include "functions.h"
#include "reflectree.h"

#include <stdint.h>

static float nan_from_now_on = 0;

/* Good while the sampler is built; then NaN, or -1, or an error. */
static int spoilt(void* user, size_t n, const float* wo, const float* wi, float* values) {
  glossy(user, n, wo, wi, values);
  if (nan_from_now_on == 1) values[3 * (n - 1) + 1] = NAN;
  if (nan_from_now_on == 2) values[0] = -1;
  if (nan_from_now_on == 3) values[0] = INFINITY;
  return nan_from_now_on == 4 ? 17 : 0;
}
static int always_nan(void* user, size_t n, const float* wo, const float* wi, float* values) {
  (void)user, (void)wo, (void)wi;
  for (size_t i = 0; i < n; ++i) values[i] = NAN;
  return 0;
}
static int negative(void* user, size_t n, const float* wo, const float* wi, float* values) {
  (void)user, (void)wo;
  for (size_t i = 0; i < n; ++i) values[i] = wi[3 * i] < 0.3f ? 1 : -1.f;
  return 0;
}
static int forgetful(void* user, size_t n, const float* wo, const float* wi, float* values) {
  (void)user, (void)n, (void)wo, (void)wi, (void)values;
  return 0;
}
static int fails(void* user, size_t n, const float* wo, const float* wi, float* values) {
  (void)user, (void)n, (void)wo, (void)wi, (void)values;
  return 5;
}
static int released = 0;
static void release(void* user) { released += *(int*)user; }

static void functions(void) {
  reflectree_function* f = NULL;
  reflectree_sampler* s = NULL;
  CHECK_STATUS(reflectree_function_callback(NULL, 1, 0, matt, NULL, NULL, &f), REFLECTREE_ERROR_ARGUMENT,
               "name is null");
  CHECK_STATUS(reflectree_function_callback("f", 1, 0, NULL, NULL, NULL, &f), REFLECTREE_ERROR_ARGUMENT,
               "f is null");
  CHECK_STATUS(reflectree_function_callback("f", 1, 0, matt, NULL, NULL, NULL), REFLECTREE_ERROR_ARGUMENT,
               "out is null");
  CHECK_STATUS(reflectree_function_callback("f", 0, 0, matt, NULL, NULL, &f), REFLECTREE_ERROR_ARGUMENT,
               "channels is 0");
  CHECK_STATUS(reflectree_function_callback("f", 257, 0, matt, NULL, NULL, &f), REFLECTREE_ERROR_ARGUMENT,
               "channels is 257");
  CHECK_STATUS(reflectree_function_callback("f", 1, 8, matt, NULL, NULL, &f), REFLECTREE_ERROR_ARGUMENT,
               "flags");
  CHECK(f == NULL);
  CHECK_STATUS(reflectree_function_open(NULL, NULL, &f), REFLECTREE_ERROR_ARGUMENT, "text is null");
  CHECK_STATUS(reflectree_function_open("gxg:alpha=0.1", NULL, &f), REFLECTREE_ERROR_REFUSED, "gxg");
  CHECK_STATUS(reflectree_function_open("nowhere.bsdf", NULL, &f), REFLECTREE_ERROR_REFUSED, "nowhere.bsdf");
  CHECK(f == NULL && reflectree_function_channels(NULL) == 0);
  reflectree_function_free(NULL);

  const struct {
    reflectree_callback f;
    reflectree_status status;
    const char* words;
  } bad[] = {{always_nan, REFLECTREE_ERROR_REFUSED, "nan"},
             {negative, REFLECTREE_ERROR_REFUSED, "negative"},
             {forgetful, REFLECTREE_ERROR_REFUSED, "nan"},
             {fails, REFLECTREE_ERROR_CALLBACK, "returned 5"}};
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
    int one = 1;
    CHECK_OK(reflectree_function_callback("bad", 1, 0, bad[k].f, &one, release, &f));
    CHECK_STATUS(reflectree_build(f, NULL, &s), bad[k].status, bad[k].words);
    CHECK(s == NULL && released == (int)k);
    reflectree_function_free(f);
    CHECK(released == (int)k + 1);
  }
}

static void options(void) {
  float height = 1;
  reflectree_function* f;
  reflectree_sampler* s = NULL;
  reflectree_build_options o;
  CHECK_OK(reflectree_function_callback("glossy", 3, 0, glossy, &height, NULL, &f));
  CHECK_STATUS(reflectree_build_options_init(NULL, sizeof o), REFLECTREE_ERROR_ARGUMENT, "options is null");
  CHECK_STATUS(reflectree_build_options_init(&o, 4), REFLECTREE_ERROR_ARGUMENT, "size is 4");
  memset(&o, 0, sizeof o);
  CHECK_STATUS(reflectree_build(f, &o, &s), REFLECTREE_ERROR_ARGUMENT, "size is 0");
  CHECK_STATUS(reflectree_build(NULL, NULL, &s), REFLECTREE_ERROR_ARGUMENT, "f is null");
  CHECK_STATUS(reflectree_build(f, NULL, NULL), REFLECTREE_ERROR_ARGUMENT, "out is null");
  CHECK_OK(reflectree_build_options_init(&o, sizeof o));
  o.target = 4;
  CHECK_STATUS(reflectree_build(f, &o, &s), REFLECTREE_ERROR_ARGUMENT, "target is 4");
  o.target = REFLECTREE_CHANNEL, o.target_channel = -1;
  CHECK_STATUS(reflectree_build(f, &o, &s), REFLECTREE_ERROR_ARGUMENT, "target_channel is -1");
  o.target_channel = 3;
  CHECK_STATUS(reflectree_build(f, &o, &s), REFLECTREE_ERROR_REFUSED, "channel 3 of 3");
  o.target = REFLECTREE_NORM, o.threads = 100000;
  CHECK_STATUS(reflectree_build(f, &o, &s), REFLECTREE_ERROR_ARGUMENT, "threads is 100000");
  o.threads = 1, o.expected_trials = NAN;
  CHECK_STATUS(reflectree_build(f, &o, &s), REFLECTREE_ERROR_REFUSED, "expected_trials");
  CHECK(s == NULL);
  reflectree_function_free(f);
}

static void files(void) {
  reflectree_sampler* s = NULL;
  CHECK_STATUS(reflectree_load(NULL, NULL, NULL, &s), REFLECTREE_ERROR_ARGUMENT, "path is null");
  CHECK_STATUS(reflectree_load("nowhere.rfl", NULL, NULL, &s), REFLECTREE_ERROR_REFUSED, "nowhere.rfl");
  CHECK_STATUS(reflectree_load("nowhere.rfl", NULL, NULL, NULL), REFLECTREE_ERROR_ARGUMENT, "out is null");
  FILE* file = fopen("c_misuse_test.rfl", "wb");
  CHECK(file != NULL);
  if (file) fputs("no sampler", file), fclose(file);
  CHECK_STATUS(reflectree_load("c_misuse_test.rfl", NULL, NULL, &s), REFLECTREE_ERROR_REFUSED,
               "not a sampler file");
  remove("c_misuse_test.rfl");
  CHECK(s == NULL);
}

static void sampling(void) {
  float height = 1, wo[3] = {0.6f, 0, 0.8f}, wi[3] = {0, 0, 1}, pdf[1], weight[3], values[3];
  double u[2] = {0.5, 0.5};
  reflectree_function* f;
  reflectree_sampler* s;
  reflectree_pcg32 random;
  reflectree_pcg32_seed(&random, 1, 0);
  reflectree_pcg32_seed(NULL, 1, 0);
  CHECK_OK(reflectree_function_callback("spoilt", 3, 0, spoilt, &height, NULL, &f));
  CHECK_OK(reflectree_build(f, NULL, &s));
  const reflectree_bits next = reflectree_pcg32_next;
  CHECK_STATUS(reflectree_sample_exact(NULL, 1, wo, next, &random, wi, pdf, weight),
               REFLECTREE_ERROR_ARGUMENT, "s is null");
  CHECK_STATUS(reflectree_sample_exact(s, 1, NULL, next, &random, wi, pdf, weight), REFLECTREE_ERROR_ARGUMENT,
               "wo is null");
  CHECK_STATUS(reflectree_sample_exact(s, 1, wo, NULL, &random, wi, pdf, weight), REFLECTREE_ERROR_ARGUMENT,
               "bits is null");
  CHECK_STATUS(reflectree_sample_exact(s, 1, wo, next, NULL, wi, pdf, weight), REFLECTREE_ERROR_ARGUMENT,
               "state is null");
  CHECK_STATUS(reflectree_sample_one_shot(s, 1, wo, next, &random, NULL, pdf, weight),
               REFLECTREE_ERROR_ARGUMENT, "wi is null");
  CHECK_STATUS(reflectree_sample_exact(s, SIZE_MAX, wo, next, &random, wi, pdf, weight),
               REFLECTREE_ERROR_ARGUMENT, "more than fits");
  CHECK_STATUS(reflectree_sample_uniforms(s, 1, wo, NULL, wi, pdf, weight), REFLECTREE_ERROR_ARGUMENT,
               "u is null");
  CHECK_STATUS(reflectree_pdf(s, 2, 1, wo, wi, pdf), REFLECTREE_ERROR_ARGUMENT, "mode is 2");
  CHECK_STATUS(reflectree_pdf(s, 0, 1, wo, wi, NULL), REFLECTREE_ERROR_ARGUMENT, "pdf is null");
  CHECK_STATUS(reflectree_eval(s, 1, wo, wi, NULL), REFLECTREE_ERROR_ARGUMENT, "values is null");
  CHECK_STATUS(reflectree_invert(s, 1, wo, NULL, u), REFLECTREE_ERROR_ARGUMENT, "wi is null");
  CHECK_STATUS(reflectree_albedo(s, 1, NULL, pdf), REFLECTREE_ERROR_ARGUMENT, "wo is null");
  CHECK_STATUS(reflectree_expected_trials(NULL, 1, wo, pdf), REFLECTREE_ERROR_ARGUMENT, "s is null");
  CHECK_STATUS(reflectree_save(s, NULL), REFLECTREE_ERROR_ARGUMENT, "path is null");
  CHECK_STATUS(reflectree_save(s, "no/such/folder/file.rfl"), REFLECTREE_ERROR_REFUSED, "no/such/folder");
  /* One kind of handle in the place of the other. */
  CHECK_STATUS(reflectree_save((const reflectree_sampler*)(const void*)f, "x.rfl"), REFLECTREE_ERROR_ARGUMENT,
               "another kind");
  CHECK_STATUS(reflectree_function_eval((const reflectree_function*)(const void*)s, 1, wo, wi, values),
               REFLECTREE_ERROR_ARGUMENT, "another kind");
  CHECK(reflectree_info_text(NULL) == NULL && reflectree_info_json(NULL) == NULL &&
        reflectree_sampler_channels(NULL) == 0);
  reflectree_sampler_free(NULL);
  /* No directions, no addresses needed. */
  CHECK_OK(reflectree_sample_exact(s, 0, NULL, next, &random, NULL, NULL, NULL));
  CHECK_OK(reflectree_eval(s, 0, NULL, NULL, NULL));

  /* Directions that are none: no sample, density 0, value 0. */
  const float bad[][3] = {{0, 0, -1}, {NAN, 0, 1}, {0, 0, 5}, {0, 0, 0}, {INFINITY, 0, 1}, {1, 0, 0}};
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
    CHECK_OK(reflectree_sample_exact(s, 1, bad[k], next, &random, wi, pdf, weight));
    CHECK(pdf[0] == 0 && weight[0] == 0 && wi[0] == 0 && wi[1] == 0 && wi[2] == 0);
    CHECK_OK(reflectree_pdf(s, REFLECTREE_ONE_SHOT, 1, wo, bad[k], pdf));
    CHECK(pdf[0] == 0);
    CHECK_OK(reflectree_pdf(s, REFLECTREE_EXACT, 1, bad[k], wo, pdf));
    CHECK(pdf[0] == 0);
    CHECK_OK(reflectree_eval(s, 1, wo, bad[k], values));
    CHECK(values[0] == 0 && values[1] == 0 && values[2] == 0);
  }

  /* A function that turns bad after the build. */
  const char* words[] = {"NaN", "-1", "infinite", "returned 17"};
  for (int k = 1; k <= 4; ++k) {
    nan_from_now_on = (float)k;
    CHECK_STATUS(reflectree_sample_exact(s, 1, wo, next, &random, wi, pdf, weight), REFLECTREE_ERROR_CALLBACK,
                 words[k - 1]);
    CHECK_STATUS(reflectree_sample_one_shot(s, 1, wo, next, &random, wi, pdf, weight),
                 REFLECTREE_ERROR_CALLBACK, words[k - 1]);
    CHECK_STATUS(reflectree_sample_uniforms(s, 1, wo, u, wi, pdf, weight), REFLECTREE_ERROR_CALLBACK,
                 words[k - 1]);
    CHECK_STATUS(reflectree_eval(s, 1, wo, wo, values), REFLECTREE_ERROR_CALLBACK, words[k - 1]);
    CHECK_STATUS(reflectree_pdf(s, REFLECTREE_EXACT, 1, wo, wo, pdf), REFLECTREE_ERROR_CALLBACK,
                 words[k - 1]);
  }
  nan_from_now_on = 0;
  CHECK_OK(reflectree_sample_exact(s, 1, wo, next, &random, wi, pdf, weight));
  CHECK(pdf[0] > 0);
  reflectree_function_free(f), reflectree_sampler_free(s);
}

int main(void) {
  CHECK(strcmp(reflectree_last_error(), "") == 0);
  functions();
  options();
  files();
  sampling();
  CHECK(strcmp(reflectree_status_name(REFLECTREE_ERROR_MEMORY), "memory") == 0);
  return check_result("c_misuse");
}
