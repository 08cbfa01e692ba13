/* SPDX-License-Identifier: Apache-2.0
 *
 * Reflectree for C99 and whatever calls C: a reflectance function becomes an exact importance sampler.
 *
 *   reflectree_function* f;                    a function: a pointer of yours, a material's text, a file
 *   reflectree_sampler* s;                     its sampler
 *   reflectree_function_callback("mine", 3, 0, my_f, &my_data, NULL, &f);
 *   reflectree_build(f, NULL, &s);
 *   reflectree_sample_exact(s, n, wo, reflectree_pcg32_next, &random, wi, pdf, weight);
 *
 * Directions are unit vectors in the surface's frame, three floats each, x y z, z along the normal; both
 * point away from the surface. wo is known (towards the viewer), wi is sampled (towards the light). A
 * function's values are in sr^-1, without cosine. Every pdf is per solid angle, sr^-1. Per channel,
 * weight = f cos_theta_i / pdf. Angles are radians. Arrays of n directions hold 3 n floats, arrays of values
 * n * channels.
 *
 * Every call that can fail returns a reflectree_status; reflectree_last_error() then has a sentence that says
 * what is wrong, where, and how to mend it. Nothing is thrown across this border and nothing aborts. What a
 * failed call would have written is not to be used.
 *
 * Threads: handles are immutable; any number of threads may use one at once. A handle is freed once, by one
 * thread, when no other uses it. A sampler keeps what it needs of its function: free both in any order.
 */
#ifndef REFLECTREE_H
#define REFLECTREE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define REFLECTREE_API __attribute__((visibility("default")))
#else
#define REFLECTREE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The interface that this header describes. It grows by one when functions are added; what is there stays. */
#define REFLECTREE_INTERFACE_VERSION 1

/* The interface that the library has: at least REFLECTREE_INTERFACE_VERSION, or the header is newer. */
REFLECTREE_API uint32_t reflectree_interface_version(void);
/* The version of Reflectree, such as "0.1.0". */
REFLECTREE_API const char* reflectree_version(void);

/* ---- Errors ---- */

typedef enum reflectree_status {
  REFLECTREE_OK = 0,
  REFLECTREE_ERROR_ARGUMENT = 1, /* a null pointer, a size or number out of range, another kind of handle */
  REFLECTREE_ERROR_REFUSED = 2,  /* what a text, a file or a function holds cannot be served */
  REFLECTREE_ERROR_CALLBACK = 3, /* it returned an error or, while sampling, a negative value, NaN or inf */
  REFLECTREE_CANCELLED = 4,      /* `progress` asked for it */
  REFLECTREE_ERROR_MEMORY = 5,
  REFLECTREE_ERROR_INTERNAL = 6 /* a fault of the library; please report it */
} reflectree_status;

/* The sentence of the calling thread's last call that failed, UTF-8, cut at 1023 bytes; "" before any. Valid
 * until this thread's next failure. */
REFLECTREE_API const char* reflectree_last_error(void);
/* The status as a word: "ok", "argument", "refused", ... */
REFLECTREE_API const char* reflectree_status_name(reflectree_status status);

/* ---- Functions ---- */

typedef struct reflectree_function reflectree_function;

/* f at n pairs: values[i * channels + c] is channel c of f(wo[i], wi[i]) in sr^-1, without cosine. All
 * directions lie above the surface. Returns 0; anything else ends the call that asked, with
 * REFLECTREE_ERROR_CALLBACK. May be called with any n > 0, and must return the same values for the
 * same directions. */
typedef int (*reflectree_callback)(void* user, size_t n, const float* wo, const float* wi, float* values);

enum {
  /* Several threads may call it at once; else calls are made one after the other. */
  REFLECTREE_CONCURRENT = 1,
  /* Turning both directions about the normal changes nothing, up to rounding: the library may do so, which is
   * a little faster. */
  REFLECTREE_ISOTROPIC = 2
};

/* The function that a pointer of yours evaluates.
 * name      for people and for files; a saved sampler bears it
 * channels  1 to 256; 1 is grey, 3 is RGB
 * flags     REFLECTREE_CONCURRENT | REFLECTREE_ISOTROPIC, or 0
 * user      passed to every call; may be null
 * release   called once with `user` after the last handle that may call f is gone; may be null. Not called
 *           when this call fails. */
REFLECTREE_API reflectree_status reflectree_function_callback(const char* name, int channels, uint32_t flags,
                                                              reflectree_callback f, void* user,
                                                              void (*release)(void* user),
                                                              reflectree_function** out);
/* The function of a material's text ("ggx:alpha=0.1", "0.3*lambert:rho=0.5 + plastic"), of a measured file,
 * or of a sampler file. data: a folder where files are looked for as well; may be null. */
REFLECTREE_API reflectree_status reflectree_function_open(const char* text, const char* data,
                                                          reflectree_function** out);
/* Null is left alone. */
REFLECTREE_API void reflectree_function_free(reflectree_function* f);
/* 1 to 256; 0 for what is no function. */
REFLECTREE_API int reflectree_function_channels(const reflectree_function* f);
/* values[i * channels + c] of f(wo[i], wi[i]); 0 where a direction is not above the surface or
 * not of unit length. */
REFLECTREE_API reflectree_status reflectree_function_eval(const reflectree_function* f, size_t n,
                                                          const float* wo, const float* wi, float* values);

/* ---- Building, saving, loading ---- */

typedef struct reflectree_sampler reflectree_sampler;

/* The scalar that is sampled, reduced from the channels: root of the sum of squares, luminance, maximum, or
 * one channel. */
enum { REFLECTREE_NORM = 0, REFLECTREE_LUMINANCE = 1, REFLECTREE_MAXIMUM = 2, REFLECTREE_CHANNEL = 3 };

/* fraction in [0, 1], never falling; stage: what is done now, in a few words. Return 0 to go on, anything
 * else to cancel. Called by the thread that called reflectree_build, and by no other. */
typedef int (*reflectree_progress)(void* user, float fraction, const char* stage);

/* Filled by reflectree_build_options_init; then change what you want. */
typedef struct reflectree_build_options {
  size_t size;              /* of the struct as the caller knows it */
  int target;               /* REFLECTREE_NORM, ... */
  int target_channel;       /* which one, for REFLECTREE_CHANNEL */
  float expected_trials;    /* 1.25: of exact mode, for every wo */
  float one_shot_variance;  /* 0.01: relative variance of the target's weight, one-shot mode */
  float albedo_error;       /* 1e-4: relative */
  int threads;              /* 0: as many as the machine has; results do not depend on it */
  uint64_t seed;            /* 1 */
  uint64_t max_evaluations; /* of f; a build that would need more ends with what it has, as its notes say */
  reflectree_progress progress; /* may be null */
  void* progress_user;
} reflectree_build_options;

/* size: sizeof(reflectree_build_options). */
REFLECTREE_API reflectree_status reflectree_build_options_init(reflectree_build_options* options,
                                                               size_t size);

/* Builds the sampler of f. options: may be null. REFLECTREE_ERROR_REFUSED names what f does wrong (negative,
 * NaN, infinite, different values for the same directions, ...). What was promised and is not kept is in the
 * notes of reflectree_info_text. */
REFLECTREE_API reflectree_status reflectree_build(const reflectree_function* f,
                                                  const reflectree_build_options* options,
                                                  reflectree_sampler** out);
/* Writes a sampler file, whole or not at all. */
REFLECTREE_API reflectree_status reflectree_save(const reflectree_sampler* s, const char* path);
/* Reads a sampler file. f: the function that it was built for, checked at 64 pairs of directions; null: that
 * of the material whose text the file bears. data: as for reflectree_function_open. */
REFLECTREE_API reflectree_status reflectree_load(const char* path, const reflectree_function* f,
                                                 const char* data, reflectree_sampler** out);
/* Null is left alone. */
REFLECTREE_API void reflectree_sampler_free(reflectree_sampler* s);
/* 1 to 256; 0 for what is no sampler. */
REFLECTREE_API int reflectree_sampler_channels(const reflectree_sampler* s);
/* The facts of a sampler, UTF-8, one line per fact, or a JSON object. Valid as long as the sampler; null for
 * what is no sampler. */
REFLECTREE_API const char* reflectree_info_text(const reflectree_sampler* s);
REFLECTREE_API const char* reflectree_info_json(const reflectree_sampler* s);

/* ---- Random bits ---- */

/* 32 uniform random bits. */
typedef uint32_t (*reflectree_bits)(void* state);

/* PCG32 (O'Neill 2014), for who has no generator. Each thread has its own. */
typedef struct reflectree_pcg32 {
  uint64_t state, increment;
} reflectree_pcg32;
/* Different streams of a seed are independent. Null is left alone. */
REFLECTREE_API void reflectree_pcg32_seed(reflectree_pcg32* state, uint64_t seed, uint64_t stream);
/* state: a reflectree_pcg32. */
REFLECTREE_API uint32_t reflectree_pcg32_next(void* state);

/* ---- Sampling ---- */

/* Each call draws one direction for each of n viewers, in batches. wi: 3 n floats; pdf: n, may be null;
 * weight: n * channels, may be null. The estimate of the reflected radiance is the mean of
 * weight * light(wi). "No sample" has wi, pdf and weight 0 and counts as such in that mean: wo below the
 * horizon, not of unit length (|wo|^2 off by more than 1e-3) or not finite, albedo 0, or 256 trials used up. */

/* Exact mode: the density is exactly proportional to the target times the cosine. Takes 5 words per trial. */
REFLECTREE_API reflectree_status reflectree_sample_exact(const reflectree_sampler* s, size_t n,
                                                         const float* wo, reflectree_bits bits, void* state,
                                                         float* wi, float* pdf, float* weight);
/* One-shot mode: nothing is rejected; always unbiased; the weight varies a little.
 * Takes 4 words per direction. */
REFLECTREE_API reflectree_status reflectree_sample_one_shot(const reflectree_sampler* s, size_t n,
                                                            const float* wo, reflectree_bits bits,
                                                            void* state, float* wi, float* pdf,
                                                            float* weight);
/* One-shot mode from given uniforms: u holds two of [0, 1] per viewer, such as stratified or Sobol' points,
 * and the map is monotone. Uniforms outside give no sample. */
REFLECTREE_API reflectree_status reflectree_sample_uniforms(const reflectree_sampler* s, size_t n,
                                                            const float* wo, const double* u, float* wi,
                                                            float* pdf, float* weight);

enum { REFLECTREE_EXACT = 0, REFLECTREE_ONE_SHOT = 1 };

/* f itself: reflectree_function_eval of the sampler's function. */
REFLECTREE_API reflectree_status reflectree_eval(const reflectree_sampler* s, size_t n, const float* wo,
                                                 const float* wi, float* values);
/* pdf[i] of drawing wi[i] for wo[i], per solid angle. mode: REFLECTREE_EXACT (of both, evaluates f) or
 * REFLECTREE_ONE_SHOT (of both ways of one-shot sampling). 0 where there is no sample. */
REFLECTREE_API reflectree_status reflectree_pdf(const reflectree_sampler* s, int mode, size_t n,
                                                const float* wo, const float* wi, float* pdf);
/* albedo[i]: the integral of target times cosine over wi, for wo[i], from the table, in units of the target. */
REFLECTREE_API reflectree_status reflectree_albedo(const reflectree_sampler* s, size_t n, const float* wo,
                                                   float* albedo);
/* trials[i]: the expected trials of exact mode for wo[i]. */
REFLECTREE_API reflectree_status reflectree_expected_trials(const reflectree_sampler* s, size_t n,
                                                            const float* wo, float* trials);
/* The uniforms that reflectree_sample_uniforms takes to wi, two per pair, up to rounding; -1 and -1 where
 * there are none. */
REFLECTREE_API reflectree_status reflectree_invert(const reflectree_sampler* s, size_t n, const float* wo,
                                                   const float* wi, double* u);

#ifdef __cplusplus
}
#endif

#endif
