/* SPDX-License-Identifier: Apache-2.0
 * A sphere under a sky, with a reflectance function of our own: dust that scatters light once, and a sheen. No sampler
 * of it is known; the library builds one.   sphere FILE.pfm   cc sphere.c $(pkg-config --cflags --libs reflectree_c) -lm
 */
#include <math.h>
#include <reflectree.h>
#include <stdio.h>
#include <stdlib.h>

enum { size = 128, samples = 256 };

static int dust(void* user, size_t n, const float* wo, const float* wi, float* f) {
  const float* tint = user;
  for (size_t i = 0; i < n; ++i) {
    const float co = wo[3 * i + 2], ci = wi[3 * i + 2];
    const float along = wo[3 * i] * wi[3 * i] + wo[3 * i + 1] * wi[3 * i + 1] + co * ci;
    const float sheen = 0.2f * expf(8 * (along - 1)); /* back to where the light comes from */
    for (size_t c = 0; c < 3; ++c) f[3 * i + c] = 0.25f * tint[c] / (co + ci) + sheen;
  }
  return 0;
}

/* Radiance of the sky from the direction (x, y, z), y upwards: blue above, and a broad sun at the right. */
static void sky(float x, float y, float z, float light[3]) {
  const float up = 0.5f + 0.5f * y, sun = 4 * expf(6 * (0.64f * x + 0.48f * y + 0.6f * z - 1));
  for (int c = 0; c < 3; ++c) light[c] = 0.1f + up * (0.2f + 0.2f * (float)c) + sun;
}

static void must(reflectree_status status) {
  if (status != REFLECTREE_OK) fprintf(stderr, "error: %s\n", reflectree_last_error()), exit(2);
}

int main(int argc, char** argv) {
  static float picture[size * size * 3], wo[samples * 3], wi[samples * 3], weight[samples * 3];
  float tint[3] = {0.9f, 0.6f, 0.4f};
  reflectree_function* f;
  reflectree_sampler* s;
  reflectree_pcg32 random;
  must(reflectree_function_callback("dust", 3, REFLECTREE_CONCURRENT | REFLECTREE_ISOTROPIC, dust, tint, NULL,
                                    &f));
  must(reflectree_build(f, NULL, &s));
  reflectree_pcg32_seed(&random, 1, 0);
  for (int p = 0; p < size * size; ++p) { /* rows from below; the viewer is far away along z */
    const float x = 2 * ((float)(p % size) + 0.5f) / size - 1, y = 2 * ((float)(p / size) + 0.5f) / size - 1;
    float* pixel = picture + 3 * p;
    const float z = sqrtf(fmaxf(1 - x * x - y * y, 0)), r = sqrtf(x * x + y * y);
    if (!(z > 0.02f)) continue;
    /* The frame about n = (x, y, z): t lies in the picture, across n; s = t x n. Then wo = (-r, 0, z). */
    const float cx = r > 0 ? x / r : 1, cy = r > 0 ? y / r : 0;
    for (int i = 0; i < samples; ++i) wo[3 * i] = -r, wo[3 * i + 1] = 0, wo[3 * i + 2] = z;
    must(reflectree_sample_exact(s, samples, wo, reflectree_pcg32_next, &random, wi, NULL, weight));
    for (int i = 0; i < samples; ++i) {
      const float a = wi[3 * i], b = wi[3 * i + 1], c = wi[3 * i + 2], out = a * z + c * r;
      float light[3];
      sky(out * cx - b * cy, out * cy + b * cx, c * z - a * r, light);
      for (int k = 0; k < 3; ++k) pixel[k] += weight[3 * i + k] * light[k] / samples;
    }
  }
  FILE* file = argc == 2 ? fopen(argv[1], "wb") : NULL;
  if (!file) return fprintf(stderr, "usage: sphere FILE.pfm, in a folder that exists\n"), 2;
  fprintf(file, "PF\n%d %d\n-1.0\n", size, size); /* little-endian, as this machine */
  const int bad = fwrite(picture, sizeof picture, 1, file) != 1;
  reflectree_function_free(f), reflectree_sampler_free(s);
  return fclose(file) != 0 || bad;
}
