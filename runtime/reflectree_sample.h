/* SPDX-License-Identifier: Apache-2.0
 * Reflectree's samplers in one C99 file (and C++): draws directions from a file that `reflectree build` saved, or from
 * the array that `reflectree export` wrote. Needs libm; allocates while it loads and never again.
 *
 *   const char* error = rfl_load(&s, "gold.rfl");    null, or what is wrong; rfl_free(&s) in the end
 *   if (rfl_view(&s, wo, &v)) {                      once for each wo; 0: no sample
 *     rfl_one_shot(&s, &v, bits, &d);                d.wi, d.pdf; the weight is d.scale * f(wo, d.wi)
 *     do rfl_propose(&s, &v, bits, &c);              density exactly proportional to the target
 *     while (!rfl_accept(&v, &c, rfl_target(&s, f(wo, c.wi), 3), a_fifth_word, &d));    RFL_MAX_TRIALS times
 *   }
 * Directions are unit vectors in the surface's frame, z the normal, pointing away: wo towards the viewer, wi towards
 * the light. f is in sr^-1 without cosine, every pdf per solid angle, weight = f cos_i / pdf. Random numbers are words
 * of 32 uniform bits. Samplers are read-only: threads share them. Anisotropic ones are refused.
 *
 * Results have the bits of the C++ library's where floats are not contracted to fused multiply-adds: -ffp-contract=off.
 * `gcc -std=c99` is so anyway; gcc -std=gnu99, g++ and clang are not, once -march= offers them. Never -ffast-math. */
#ifndef REFLECTREE_SAMPLE_H
#define REFLECTREE_SAMPLE_H
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#define RFL_FN static inline
#if defined(__FAST_MATH__)
#error "reflectree_sample.h needs comparisons that see NaN; compile without -ffast-math"
#endif
/* ---- The array of words. Its head: magic, version, words; domain, half, exponent; target, channel, scale; of the
 * albedo, exact mode and one-shot mode each the shift, borders and guide of a lookup, and pieces or slabs. Tables are
 * named by the number of words before them. ---- */
enum { RFL_MAGIC = 0x574c4652, RFL_VERSION = 1, RFL_HEAD = 24, RFL_ALBEDO = 9, RFL_EXACT = 13, RFL_ONE_SHOT = 17 };
enum { RFL_LEAF = 5, RFL_SLAB = 5, RFL_MAX_TRIALS = 256 };
enum { RFL_PROJECTED_DISK, RFL_EQUAL_AREA, RFL_HALF_VECTOR, RFL_BACK_VECTOR, RFL_STRETCHED, RFL_MIRROR_VECTOR };
typedef struct { float x, y, z; } rfl_vec;
/* Over cosines. table: of a piece, base and slope; of a slab, where its leaves are, how many, where its nodes are,
 * the capacity of a bucket, the volume. A leaf: threshold, height, alias | x << 16, y | level_x << 16 | level_y << 24,
 * slope_x | slope_y << 8. A node: lower share, lower leaves | along x << 31. */
typedef struct { const uint32_t *borders, *guide, *table; uint32_t shift; } rfl_lookup;
typedef struct {
  const uint32_t* words;
  uint32_t* owned;
  int kind, half, target, channel;
  float exponent, scale;
  rfl_lookup albedo, exact, one_shot;
} rfl_sampler;
typedef struct { rfl_vec known, wo; float cos_phi, sin_phi, albedo; } rfl_viewer; /* wo turned to azimuth 0 */
typedef struct { rfl_vec wi; float pdf, scale; } rfl_draw;                        /* scale: the weight over f */
typedef struct { rfl_vec wi; float cos_i, area, majorant; } rfl_candidate;        /* a trial of exact mode */
typedef struct { rfl_vec wi; float area; } rfl_point;
RFL_FN float rfl_float(uint32_t w) { float f; memcpy(&f, &w, 4); return f; }
RFL_FN uint32_t rfl_word(float f) { uint32_t w; memcpy(&w, &f, 4); return w; }
RFL_FN float rfl_min(float a, float b) { return b < a ? b : a; }
RFL_FN float rfl_max(float a, float b) { return a < b ? b : a; }
RFL_FN float rfl_clamp(float x) { return rfl_min(rfl_max(x, 0.f), 1.f); }
RFL_FN float rfl_by_sign(float s, float a, float b) { /* a or b, without a branch */
  return rfl_float(rfl_word(a) ^ ((rfl_word(a) ^ rfl_word(b)) & (0u - (rfl_word(s) >> 31))));
}
RFL_FN rfl_vec rfl_vec3(float x, float y, float z) { rfl_vec v; v.x = x; v.y = y; v.z = z; return v; }
RFL_FN float rfl_dot(rfl_vec a, rfl_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
RFL_FN rfl_vec rfl_turn(rfl_vec w, float c, float s) { return rfl_vec3(w.x * c - w.y * s, w.x * s + w.y * c, w.z); }
static const float rfl_pi = 3.14159274f, rfl_least = 1e-7f, rfl_min_cos = 7.62939453125e-06f;
/* An exported array, which must stay, as a sampler. Null, or what is wrong. */
RFL_FN const char* rfl_open(rfl_sampler* s, const uint32_t* w, size_t count) {
  rfl_lookup* const l[3] = {&s->albedo, &s->exact, &s->one_shot};
  int i;
  memset(s, 0, sizeof *s);
  if (!w || count < RFL_HEAD || w[0] != (uint32_t)RFL_MAGIC || w[1] != (uint32_t)RFL_VERSION || w[2] != count)
    return "no array of this version and length; write it with this header's `reflectree export`";
  s->words = w, s->kind = (int)w[3], s->half = (int)w[4], s->exponent = rfl_float(w[5]);
  s->target = (int)w[6], s->channel = (int)w[7], s->scale = rfl_float(w[8]);
  for (i = 0, w += RFL_ALBEDO; i < 3; ++i, w += 4)
    l[i]->shift = w[0], l[i]->borders = s->words + w[1], l[i]->guide = s->words + w[2], l[i]->table = s->words + w[3];
  return NULL;
}
/* ---- The viewer ---- */
RFL_FN uint32_t rfl_find(const rfl_lookup* l, float c) {
  uint32_t i = l->guide[(rfl_word(c) - rfl_word(rfl_min_cos)) >> l->shift];
  for (i += rfl_float(l->borders[i + 1]) <= c; rfl_float(l->borders[i + 1]) <= c;) ++i;
  return i;
}
/* 0 is "no sample": wo at or below the horizon, not finite, not of unit length, or albedo 0. */
RFL_FN int rfl_view(const rfl_sampler* s, rfl_vec wo, rfl_viewer* v) {
  const float s2 = wo.x * wo.x + wo.y * wo.y, sine = sqrtf(s2), inv = sine > 0 ? 1 / sine : 0.f, c = rfl_min(wo.z, 1.f);
  const uint32_t* piece;
  if (!(wo.z >= rfl_min_cos && fabsf(s2 + wo.z * wo.z - 1) <= 1e-3f)) return 0;
  v->known = wo, v->wo = rfl_vec3(sine, 0, c), v->cos_phi = sine > 0 ? wo.x * inv : 1.f, v->sin_phi = wo.y * inv;
  piece = s->albedo.table + 2 * (size_t)rfl_find(&s->albedo, c);
  return (v->albedo = rfl_float(piece[0]) + rfl_float(piece[1]) * c) > 0;
}
RFL_FN const uint32_t* rfl_slab_at(const rfl_lookup* l, const rfl_viewer* v) {
  return l->table + RFL_SLAB * (size_t)rfl_find(l, v->wo.z);
}
/* ---- The domain: from the square to wi, with d(projected solid angle) / d(share); domain_map.hpp and the maps that it includes derive it ---- */
RFL_FN void rfl_star(float sin_o, float cos_o, float cos_phi, float* p, float* c) {
  const float c2 = cos_o * cos_o, sx = sin_o * cos_phi, l = sqrtf(c2 + sx * sx) + fabsf(sx);
  *p = rfl_by_sign(sx, l * l, c2), *c = cos_o * l;
}
RFL_FN void rfl_rim(float sin_o, float cos_o, float cos_phi, float* p, float* c, float* zr) {
  const float sx = sin_o * cos_phi, l = sqrtf(cos_o * cos_o + sx * sx) + fabsf(sx);
  *p = rfl_by_sign(sx, cos_o, l), *c = rfl_by_sign(sx, l, cos_o), *zr = rfl_by_sign(sx, cos_o * cos_o / l, l);
}
RFL_FN rfl_point rfl_lift(const rfl_sampler* s, rfl_vec wo, float px, float py) {
  rfl_point o;
  float y = rfl_max(fabsf(py), 1e-12f), p, c, d, t, r = fabsf(py), z, zr;
  const float h = 0.5f * px, q = h * h, q2 = q * q; /* ux = cos phi = sin(pi px / 2), uy = sin phi on the side of py */
  const float ux = h * ((3.14159264f - q * 5.16771009f) + q2 * ((2.55007766f - q * 0.598292159f) + q2 * 0.0776594082f));
  const float u = (1.f - q * 4.93480214f) +
                  q2 * ((4.05870916f - q * 1.33521206f) + q2 * (0.234937559f - q * 0.0243967166f));
  const float uy = rfl_float(rfl_word(u) ^ (rfl_word(py) & 0x80000000u));
  if (s->kind == RFL_HALF_VECTOR || s->kind == RFL_BACK_VECTOR) {
    const float ax = (s->kind == RFL_HALF_VECTOR ? 1.f : -1.f) * wo.x;
    float won, cos2, twice;
    rfl_star(ax, wo.z, ux, &p, &c), d = p / (p + (c - p) * y), t = y * d;
    won = rfl_max(ax * ux * t + wo.z, rfl_least), cos2 = 1.f / (1.f + t * t), twice = 2.f * won * cos2;
    o.wi = rfl_vec3(twice * t * ux - ax, twice * t * uy, rfl_max(twice - wo.z, rfl_least));
    return o.area = o.wi.z * (8 * rfl_pi) * won * (cos2 * cos2) * (t * d * d), o;
  }
  if (s->kind >= RFL_MIRROR_VECTOR) { /* or about the normal */
    const float ax = s->kind == RFL_MIRROR_VECTOR ? wo.x : 0.f, az = s->kind == RFL_MIRROR_VECTOR ? wo.z : 1.f;
    float tt, inverse;
    rfl_rim(ax, az, ux, &p, &c, &zr), d = p / (p + (c - p) * y), t = y * d, tt = t * t, inverse = 1.f / (1.f + tt);
    z = rfl_max(d * (1.f - y) * (zr * t + az) * inverse, rfl_least);
    o.wi = rfl_vec3(-(ax * (1.f - tt) + 2.f * t * az * ux) * inverse, 2.f * t * uy * inverse, z);
    return o.area = z * (8 * rfl_pi) * t * (inverse * inverse) * (d * d), o;
  }
  if (s->kind == RFL_PROJECTED_DISK) {
    z = rfl_max(sqrtf(1.f - r), rfl_least), r = sqrtf(r), o.area = rfl_pi;
  } else if (s->kind == RFL_EQUAL_AREA) {
    z = rfl_max(1.f - r, rfl_least), r = sqrtf(r * (2.f - r)), o.area = 2 * rfl_pi * z;
  } else {
    p = 1 / (2 - s->exponent), t = rfl_max(1.f - r, 1e-7f), z = rfl_max(powf(t, p), rfl_least);
    r = sqrtf(1.f - z * z), o.area = 2 * rfl_pi * p * z * z / t;
  }
  return o.wi = rfl_vec3(r * ux, r * uy, z), o;
}
RFL_FN float rfl_quarter_atan(float t) {
  float s = t * t, p = (-0.00597563674f * s + 0.0308790214f) * s - 0.0757402948f;
  p = (((p * s + 0.126232606f) * s - 0.178501543f) * s + 0.254262416f) * s;
  return t * ((p - 0.424396087f) * s + 1.27323942f);
}
/* The inverse of rfl_lift; with half squares wi.y >= 0. */
RFL_FN void rfl_lower(const rfl_sampler* s, rfl_vec wo, rfl_vec wi, float* px, float* py) {
  const float ax = (s->kind == RFL_BACK_VECTOR ? -1.f : 1.f) * wo.x, sin2 = wi.x * wi.x + wi.y * wi.y;
  const rfl_vec o = rfl_vec3(ax, 0, wo.z), m = rfl_vec3(o.x - wi.x, o.y - wi.y, o.z - wi.z);
  const rfl_vec axis = s->kind == RFL_MIRROR_VECTOR ? wo : rfl_vec3(0, 0, 1);
  rfl_vec w = wi;
  float y = s->kind == RFL_EQUAL_AREA ? sin2 / (1 + wi.z) : sin2, p, c, t, sine, zr, a, b;
  if (s->kind == RFL_STRETCHED) {
    y = 1 - powf(wi.z, 2 - s->exponent);
  } else if (s->kind == RFL_HALF_VECTOR || s->kind == RFL_BACK_VECTOR) {
    w = rfl_vec3(o.x + wi.x, o.y + wi.y, o.z + wi.z);
    if (rfl_dot(o, wi) < 0.f) /* what is rounding is taken out of the sum */
      t = rfl_dot(w, m) / rfl_dot(m, m), w = rfl_vec3(w.x - t * m.x, w.y - t * m.y, w.z - t * m.z);
    t = 1.f / sqrtf(rfl_dot(w, w)), w = rfl_vec3(t * w.x, t * w.y, t * w.z);
    sine = sqrtf(rfl_max(w.x * w.x + w.y * w.y, rfl_least * rfl_least)), t = sine / rfl_max(w.z, 1e-12f);
    rfl_star(ax, wo.z, w.x / sine, &p, &c), y = p * t / (p - (c - p) * t);
  } else if (s->kind >= RFL_MIRROR_VECTOR) {
    a = wi.x + axis.x, b = wi.z - axis.z;
    w = rfl_vec3(-axis.z * a - axis.x * b, wi.y, axis.z * wi.z - axis.x * wi.x);
    sine = sqrtf(rfl_max(w.x * w.x + w.y * w.y, rfl_least * rfl_least));
    t = w.z > 0 ? sine / (1 + w.z) : (1 - w.z) / sine;
    rfl_rim(axis.x, axis.z, w.x / sine, &p, &c, &zr), y = p * t / (p - (c - p) * t);
  }
  y = rfl_clamp(y), a = fabsf(w.x), b = fabsf(w.y);
  t = a > b ? 1 - 0.5f * rfl_quarter_atan(b / a) : b > 0 ? 0.5f * rfl_quarter_atan(a / b) : 1.f;
  *px = w.x < 0 ? -t : t, *py = !s->half && w.y < 0 ? -y : y;
}
/* ---- A leaf, by an alias table (Walker 1977) in integers; spare: random bits that are left ---- */
RFL_FN const uint32_t* rfl_choose(const rfl_sampler* s, const uint32_t* slab, const uint32_t* bits, uint32_t* spare) {
  const uint64_t n = slab[1], m = slab[3], high = bits[0] * n + ((bits[1] * n) >> 32), low = bits[1] * n;
  const uint64_t rest = (high & 0xffffffffu) * m + (((low & 0xffffffffu) * m) >> 32);
  const uint32_t *leaves = s->words + slab[0], bucket = (uint32_t)(high >> 32);
  const uint32_t *leaf = leaves + RFL_LEAF * (size_t)bucket, own = 0u - (uint32_t)((uint32_t)(rest >> 32) < leaf[0]);
  *spare = (uint32_t)rest;
  return leaves + RFL_LEAF * (size_t)((bucket & own) | (leaf[2] & 0xffffu & ~own));
}
RFL_FN int rfl_byte(uint32_t b) { return (int)(b & 127u) - (int)(b & 128u); }
RFL_FN float rfl_slope(uint32_t b) { return (float)rfl_byte(b) * 0.0078125f; }
RFL_FN float rfl_power(uint32_t exponent) { return rfl_float(exponent << 23); }
/* From 1 + g s, s in [-1, 1], by its inverse CDF, as (s + 1) / 2. */
RFL_FN float rfl_linear(float g, float u) {
  const float a = 1.f - g, b = 1.f + g;
  return rfl_min(2.f * u / (a + sqrtf(a * a + u * (b * b - a * a))), 1.f);
}
/* The same without a root: with probability |g| the larger (g < 0: smaller) of two uniforms, else the first. */
RFL_FN float rfl_mix(int slope, uint32_t first, uint32_t second) {
  const uint32_t a = first >> 8, b = second >> 8, low = a < b ? a : b, high = a ^ b ^ low;
  const uint32_t other = high ^ ((high ^ low) & (0u - (uint32_t)(slope < 0)));
  const uint32_t mixed = 0u - (uint32_t)((int)(first & 127u) < (slope < 0 ? -slope : slope));
  return (float)(a ^ ((a ^ other) & mixed)) * 5.9604644775390625e-08f;
}
/* The point at tx, ty in [0, 1] across a leaf, and the height there. */
RFL_FN float rfl_at(const uint32_t* leaf, int half, float tx, float ty, float* px, float* py) {
  const int x = (int)(leaf[2] >> 16), y = (int)(leaf[3] & 0xffffu);
  const float gx = rfl_slope(leaf[4]), gy = rfl_slope(leaf[4] >> 8);
  *px = (float)(x - 0x4000) * 6.103515625e-05f + rfl_power(128u - ((leaf[3] >> 16) & 255u)) * tx;
  *py = half ? (float)y * 3.0517578125e-05f + rfl_power(127u - (leaf[3] >> 24)) * ty
             : (float)(y - 0x4000) * 6.103515625e-05f + rfl_power(128u - (leaf[3] >> 24)) * ty;
  return rfl_float(leaf[1]) * ((1.f - gx) + 2.f * gx * tx) * ((1.f - gy) + 2.f * gy * ty);
}
/* From four words: a leaf, a point in it, the coin for the side of half squares. */
RFL_FN rfl_point rfl_place(const rfl_sampler* s, const rfl_lookup* l, const rfl_viewer* v, const uint32_t* b, float* h) {
  uint32_t spare;
  const uint32_t* leaf = rfl_choose(s, rfl_slab_at(l, v), b, &spare);
  const float tx = rfl_mix(rfl_byte(leaf[4]), b[2], spare);
  const float ty = rfl_linear(rfl_slope(leaf[4] >> 8), (float)(b[3] >> 8) * 5.9604644775390625e-08f);
  float px, py;
  *h = rfl_at(leaf, s->half, tx, ty, &px, &py);
  return rfl_lift(s, v->wo, px, s->half && (b[3] & 1u) ? -py : py);
}
/* ---- One-shot mode: from four words of random bits ---- */
RFL_FN void rfl_one_shot(const rfl_sampler* s, const rfl_viewer* v, const uint32_t* bits, rfl_draw* out) {
  float height;
  const rfl_point p = rfl_place(s, &s->one_shot, v, bits, &height);
  out->wi = rfl_turn(p.wi, v->cos_phi, v->sin_phi), out->pdf = height / p.area * p.wi.z, out->scale = p.area / height;
}
/* From two uniforms of [0, 1], monotone; 0 where they are none. */
RFL_FN int rfl_one_shot_uniforms(const rfl_sampler* s, const rfl_viewer* v, double u1, double u2, rfl_draw* out) {
  const uint32_t *slab = rfl_slab_at(&s->one_shot, v), *node = s->words + slab[2], *leaf = s->words + slab[0];
  const int below = s->half && u2 < 0.5;
  double lo[2] = {0, 0}, size[2] = {1, 1}, u[2];
  float px, py, height, t[2];
  uint32_t left = slab[1], i;
  rfl_point p;
  if (!(u1 >= 0 && u1 <= 1 && u2 >= 0 && u2 <= 1)) return 0;
  u[0] = u1, u[1] = !s->half ? u2 : below ? 1 - 2 * u2 : 2 * u2 - 1;
  while (left > 1) {
    const uint32_t axis = 1u - (node[1] >> 31), lower_leaves = node[1] & 0x7fffffffu;
    const double lower = size[axis] * (double)rfl_float(node[0]);
    const int up = u[axis] >= lo[axis] + lower;
    lo[axis] += up ? lower : 0, size[axis] = up ? size[axis] - lower : lower, node += up ? 2 * lower_leaves : 2;
    left = up ? left - lower_leaves : lower_leaves, leaf += up ? RFL_LEAF * lower_leaves : 0;
  }
  for (i = 0; i < 2; ++i)
    t[i] = rfl_linear(rfl_slope(leaf[4] >> (8 * i)), rfl_min((float)((u[i] - lo[i]) / size[i]), 1.f));
  height = rfl_at(leaf, s->half, t[0], t[1], &px, &py), p = rfl_lift(s, v->wo, px, below ? -py : py);
  out->wi = rfl_turn(p.wi, v->cos_phi, v->sin_phi), out->pdf = height / p.area * p.wi.z, out->scale = p.area / height;
  return 1;
}
/* The uniforms that rfl_one_shot_uniforms takes to wi, up to rounding, and the pdf there; 0 below the horizon. */
RFL_FN float rfl_one_shot_invert(const rfl_sampler* s, const rfl_viewer* v, rfl_vec wi, double* u) {
  const uint32_t *slab = rfl_slab_at(&s->one_shot, v), *node = s->words + slab[2], *leaf = s->words + slab[0];
  rfl_vec w = rfl_vec3(wi.x * v->cos_phi + wi.y * v->sin_phi, wi.y * v->cos_phi - wi.x * v->sin_phi, wi.z);
  const int below = s->half && w.y < 0;
  double lo[2] = {0, 0}, share[2] = {1, 1};
  float start[2] = {-1, -1}, size[2] = {2, 2}, p[2], t[2], px, py;
  uint32_t left = slab[1], i;
  rfl_point at;
  if (!(wi.z > 0)) return 0;
  if (s->half) w.y = fabsf(w.y), start[1] = 0, size[1] = 1;
  rfl_lower(s, v->wo, w, p, p + 1), at = rfl_lift(s, v->wo, p[0], p[1]);
  while (left > 1) {
    const uint32_t axis = 1u - (node[1] >> 31), lower_leaves = node[1] & 0x7fffffffu;
    const double lower = (double)rfl_float(node[0]);
    size[axis] *= 0.5f;
    if (p[axis] < start[axis] + size[axis]) {
      share[axis] *= lower, left = lower_leaves, node += 2;
    } else {
      start[axis] += size[axis], lo[axis] += share[axis] * lower, share[axis] *= 1 - lower, left -= lower_leaves;
      leaf += RFL_LEAF * (size_t)lower_leaves, node += 2 * (size_t)lower_leaves;
    }
  }
  for (i = 0; i < 2; ++i) {
    t[i] = rfl_clamp((p[i] - start[i]) / size[i]);
    u[i] = lo[i] + share[i] * (double)(t[i] * (1 - rfl_slope(leaf[4] >> (8 * i)) * (1 - t[i])));
  }
  if (s->half) u[1] = below ? 0.5 * (1 - u[1]) : 0.5 * (1 + u[1]);
  return rfl_at(leaf, s->half, t[0], t[1], &px, &py) * at.wi.z / at.area;
}
RFL_FN float rfl_one_shot_pdf(const rfl_sampler* s, const rfl_viewer* v, rfl_vec wi) {
  double u[2];
  return rfl_one_shot_invert(s, v, wi, u);
}
/* ---- Exact mode: first the scalar that is sampled, from the channels of f ---- */
RFL_FN float rfl_target(const rfl_sampler* s, const float* f, int channels) {
  float t = 0, sum = 0;
  int c;
  if (channels == 1) return s->scale * f[0];
  for (c = 0; c < channels; ++c) {
    sum += s->scale * f[c] * (s->scale * f[c]);
    if (s->target == 1 && channels != 3) t += f[c] / (float)channels;
    if (s->target == 2) t = rfl_max(t, f[c]);
  }
  if (s->target == 0) return sqrtf(sum);
  if (s->target == 1 && channels == 3) t = 0.2126f * f[0] + 0.7152f * f[1] + 0.0722f * f[2];
  if (s->target == 3) t = f[s->channel < channels ? s->channel : channels - 1];
  return 0.99f * (s->scale * t) + 0.01f * sqrtf(sum);
}
/* One trial, from four words. Evaluate f at v->known and out->wi, and ask rfl_accept; then propose again. */
RFL_FN void rfl_propose(const rfl_sampler* s, const rfl_viewer* v, const uint32_t* bits, rfl_candidate* out) {
  const rfl_point p = rfl_place(s, &s->exact, v, bits, &out->majorant);
  out->wi = rfl_turn(p.wi, v->cos_phi, v->sin_phi), out->cos_i = p.wi.z, out->area = p.area;
}
/* 1: accepted, by a fifth word. */
RFL_FN int rfl_accept(const rfl_viewer* v, const rfl_candidate* c, float target, uint32_t bits, rfl_draw* out) {
  const float whole = target * c->area, t = whole / c->area;
  if (!((double)bits * 2.3283064365386963e-10 * (double)(c->majorant * v->albedo) < (double)whole)) return 0;
  return out->wi = c->wi, out->pdf = t * c->cos_i / v->albedo, out->scale = v->albedo / t, 1;
}
/* Per solid angle, from the target at wi. */
RFL_FN float rfl_exact_pdf(const rfl_viewer* v, rfl_vec wi, float t) { return t / v->albedo * rfl_max(wi.z, 0.f); }
/* ---- Sampler files become the array. Nothing of a file is trusted; sampler_file.hpp has the format. ---- */
typedef struct {
  const unsigned char *at, *end, *splits, *slope_x, *slope_y;
  uint32_t *words, *leaf, *node, count, splits_count, split, leaves, next, mass[65536], small[65536], large[65536];
  uint64_t left[65536];
  float border[60002];
  const char* error;
  jmp_buf out;
} rfl_loader;
RFL_FN void rfl_check(rfl_loader* l, int good, const char* error) { if (!good) l->error = error, longjmp(l->out, 1); }
RFL_FN const unsigned char* rfl_take(rfl_loader* l, size_t n) {
  return rfl_check(l, n <= (size_t)(l->end - l->at), "damaged: bytes are missing"), l->at += n, l->at - n;
}
RFL_FN uint32_t rfl_uint(rfl_loader* l, size_t n) {
  const unsigned char* at = rfl_take(l, n);
  uint32_t v = 0;
  while (n-- > 0) v = v << 8 | at[n];
  return v;
}
RFL_FN float rfl_finite(rfl_loader* l) {
  const float f = rfl_float(rfl_uint(l, 4));
  return rfl_check(l, fabsf(f) <= 3.40282347e38f, "damaged: a number is not finite"), f;
}
/* Of `border`, whose last becomes 2. The bits of a float index a guide, finer until no entry spans two borders. */
RFL_FN void rfl_put_lookup(rfl_loader* l, uint32_t n, uint32_t head) {
  const uint32_t least = rfl_word(rfl_min_cos), most = rfl_word(1.f) - least, guide = l->count + n;
  uint32_t shift = 19, entry, i, before, crowded = 1;
  l->border[n - 1] = 2, l->words[head + 1] = l->count, l->words[head + 2] = guide;
  for (i = 0; i < n; ++i) l->words[l->count++] = rfl_word(l->border[i]);
  while (shift > 15 && crowded) {
    for (--shift, crowded = 0, i = 0, l->count = guide, entry = 0; entry <= most >> shift; ++entry) {
      for (before = i; l->border[i + 1] <= rfl_float(least + (entry << shift));) ++i;
      crowded += i > before + 1, l->words[l->count++] = i;
    }
  }
  l->words[head] = shift, l->words[head + 3] = l->count;
}
/* In preorder: the box of the next node goes from `lo` to the last split that is open. Returns the slabs. */
RFL_FN uint32_t rfl_partition(rfl_loader* l, uint32_t head) {
  const char* error = "damaged: a partition that is not one of theta_o";
  const unsigned char* axis;
  uint32_t n, i, open = 0, slabs = 0;
  float lo, hi, split;
  rfl_check(l, rfl_uint(l, 4) == 1 && rfl_uint(l, 4) == 7 && memcmp(rfl_take(l, 7), "theta_o", 7) == 0, error);
  lo = rfl_finite(l), hi = rfl_finite(l), n = rfl_uint(l, 4), axis = rfl_take(l, n);
  rfl_check(l, lo == 0 && hi > 1.5707f && hi <= 0.5f * rfl_pi && n % 2 == 1 && n < 120000, error);
  for (rfl_check(l, rfl_uint(l, 4) == n / 2, error), i = 0; i < n; ++i) {
    if (axis[i] == 255) {
      rfl_check(l, (open > 0) == (i + 1 < n), error), l->border[slabs++] = cosf(lo);
      if (open > 0) lo = rfl_float(l->large[--open]);
      continue;
    }
    split = rfl_finite(l), l->large[open++] = rfl_word(split);
    rfl_check(l, axis[i] == 0 && split > lo && split < (open > 1 ? rfl_float(l->large[open - 2]) : hi), error);
  }
  l->border[slabs] = rfl_min_cos; /* cosines ascend */
  for (i = 0; 2 * i < slabs; ++i) lo = l->border[i], l->border[i] = l->border[slabs - i], l->border[slabs - i] = lo;
  return rfl_put_lookup(l, slabs + 1, head), slabs;
}
/* A subtree in preorder, at most 15 levels deep along each axis. Returns its mass. */
RFL_FN double rfl_subtree(rfl_loader* l, uint32_t x, uint32_t y, uint32_t lx, uint32_t ly) {
  const uint32_t i = l->split++, first = l->next, good = i < l->splits_count && lx < 16 && ly < 16;
  const uint32_t split = good ? (l->splits[i / 4] >> (2 * (i % 4))) & 3u : 3u, along_x = split == 1;
  uint32_t *leaf = l->leaf + RFL_LEAF * first, *node = l->node;
  double lower, upper;
  rfl_check(l, split < 3 && (split == 0 ? first < l->leaves : node < l->words + l->count), "damaged: a tree");
  if (split == 0) {
    rfl_check(l, l->slope_x[first] != 128 && l->slope_y[first] != 128, "damaged: a slope empties a leaf's edge");
    leaf[2] |= x << 16, leaf[3] = y | lx << 16 | ly << 24, leaf[4] = l->slope_x[first] + l->slope_y[first] * 256u;
    return (double)l->mass[l->next++];
  }
  l->node += 2, lower = rfl_subtree(l, x, y, lx + along_x, ly + !along_x);
  node[1] = (l->next - first) | along_x << 31, x += along_x ? 0x4000u >> lx : 0, y += along_x ? 0 : 0x4000u >> ly;
  upper = rfl_subtree(l, x, y, lx + along_x, ly + !along_x), node[0] = rfl_word((float)(lower / (lower + upper)));
  return lower + upper;
}
/* volume 0: a density. The heaviest leaf takes up what its masses lack to a multiple of their number. */
RFL_FN void rfl_tree(rfl_loader* l, double volume, uint32_t* slab) {
  uint32_t n = rfl_uint(l, 4), m, i, heaviest = 0, small = 0, large = 0, last;
  uint64_t sum = 0, bucket;
  double unit, whole = 0;
  l->splits = rfl_take(l, n / 4 + (n % 4 != 0)), m = rfl_uint(l, 4);
  rfl_check(l, n % 2 == 1 && m == n / 2 + 1 && m <= 65535 && l->splits[n / 4] >> (2 * (n % 4)) == 0, "damaged: a tree");
  for (i = 0; i < m; ++i) {
    l->mass[i] = rfl_uint(l, 4), rfl_check(l, l->mass[i] > 0 && (sum += l->mass[i]) <= 0xffffffffu, "damaged: a mass");
    if (l->mass[i] > l->mass[heaviest]) heaviest = i;
  }
  l->slope_x = rfl_take(l, m), l->slope_y = rfl_take(l, m);
  bucket = (sum + m - 1) / m, unit = volume / (double)sum, unit = unit > 0 ? unit : 1 / ((double)bucket * m);
  slab[0] = l->count, slab[1] = m, slab[2] = l->count + RFL_LEAF * m, slab[3] = (uint32_t)bucket;
  l->leaf = l->words + slab[0], l->node = l->words + slab[2], l->count = slab[2] + 2 * (m - 1);
  l->mass[heaviest] += (uint32_t)(bucket * m - sum);
  for (i = 0; i < m; ++i)
    if ((l->left[i] = l->mass[i]) < bucket) l->small[small++] = i; else l->large[large++] = i;
  while (small > 0 && large > 0) { /* Vose 1991 */
    i = l->small[--small], last = l->large[large - 1], l->left[last] -= bucket - l->left[i];
    l->leaf[RFL_LEAF * i] = (uint32_t)l->left[i], l->leaf[RFL_LEAF * i + 2] = last;
    if (l->left[last] < bucket) --large, l->small[small++] = last;
  }
  while (small + large > 0)
    i = large > 0 ? l->large[--large] : l->small[--small], l->leaf[RFL_LEAF * i] = slab[3], l->leaf[RFL_LEAF * i + 2] = i;
  l->splits_count = n, l->leaves = m, l->split = l->next = 0, rfl_subtree(l, 0, 0, 0, 0);
  rfl_check(l, l->split == n && l->next == m, "damaged: a tree");
  for (i = 0; i < m; ++i) {
    const uint32_t levels = l->leaf[RFL_LEAF * i + 3];
    const double mass = unit * l->mass[i], area = (double)rfl_power(127u - ((levels >> 16) & 255u) - (levels >> 24));
    l->leaf[RFL_LEAF * i + 1] = rfl_word((float)(mass / area)), whole += mass;
  }
  slab[4] = rfl_word((float)whole);
}
/* The payload of a chunk; 0 if there is none. */
RFL_FN int rfl_chunk(rfl_loader* l, const unsigned char* file, size_t size, const char* tag) {
  static const char known[] = "MATL TARG DOMN EXPA EXTR ONPA ONTR ALBD PROB REPT SCAL PRCH NOTE ANIS";
  const unsigned char *from = NULL, *to = NULL, *payload;
  for (l->at = file + 8, l->end = file + size - 4; l->at < l->end;) {
    char name[5] = "";
    const char* place = (const char*)memcpy(name, rfl_take(l, 4), 4);
    const uint32_t version = rfl_uint(l, 2), flags = rfl_uint(l, 2), length = rfl_uint(l, 4), high = rfl_uint(l, 4);
    rfl_check(l, high == 0, "damaged: a length"), payload = rfl_take(l, length), place = strstr(known, name);
    if (version != 1 || strlen(name) != 4 || !place || (place - known) % 5 != 0)
      rfl_check(l, flags & 1, "written by a later version; take its reflectree_sample.h");
    else if (memcmp(name, tag, 4) == 0)
      rfl_check(l, !from, "damaged: a chunk comes twice"), from = payload, to = l->at;
  }
  return l->at = from, l->end = to, from != NULL;
}
RFL_FN void rfl_convert(rfl_loader* l, const unsigned char* file, size_t size) {
  static const char* const tags[2][2] = {{"EXPA", "EXTR"}, {"ONPA", "ONTR"}};
  const char* error = "damaged: a chunk is missing, or too long, or has a number out of range";
  uint32_t *w = l->words, i, k, n, slabs;
  float x;
  rfl_check(l, !rfl_chunk(l, file, size, "ANIS"), "anisotropic: only isotropic samplers are served; use the library");
  memset(w, 0, 4 * RFL_HEAD), l->count = RFL_HEAD, w[0] = RFL_MAGIC, w[1] = RFL_VERSION, w[8] = rfl_word(1.f);
  rfl_check(l, rfl_chunk(l, file, size, "TARG"), error), w[6] = rfl_uint(l, 1), w[7] = rfl_uint(l, 2);
  rfl_check(l, w[6] <= 3 && l->at == l->end && rfl_chunk(l, file, size, "DOMN"), error);
  w[3] = rfl_uint(l, 1), w[4] = rfl_uint(l, 1), x = rfl_finite(l), w[5] = rfl_word(x);
  rfl_check(l, w[3] <= RFL_MIRROR_VECTOR + 1 && w[4] <= 1 && x >= 0 && x < 2 && l->at == l->end, error);
  if (rfl_chunk(l, file, size, "SCAL"))
    x = rfl_finite(l), w[8] = rfl_word(x), rfl_check(l, x > 0 && l->at == l->end, error);
  rfl_check(l, rfl_chunk(l, file, size, "ALBD"), error), x = rfl_finite(l), rfl_check(l, x >= 0 && x <= 1, error);
  n = rfl_uint(l, 4), rfl_check(l, n >= 2 && n <= 60000, error);
  for (i = 0; i < n; ++i) l->border[i] = rfl_finite(l), rfl_check(l, i == 0 || l->border[i] > l->border[i - 1], error);
  rfl_check(l, l->border[0] == rfl_min_cos && l->border[n - 1] == 1 && rfl_uint(l, 4) == n, error);
  for (i = 0; i < n; ++i) l->mass[i] = rfl_word(rfl_finite(l)), rfl_check(l, rfl_float(l->mass[i]) >= 0, error);
  rfl_check(l, l->at == l->end, error), k = l->count, l->count += 2 * (n - 1), w[RFL_ALBEDO + 3] = k;
  for (i = 0; i + 1 < n; ++i) {
    const double c0 = (double)l->border[i], c1 = (double)l->border[i + 1], a0 = (double)rfl_float(l->mass[i]);
    const double slope = ((double)rfl_float(l->mass[i + 1]) - a0) / (c1 - c0);
    w[k + 2 * i] = rfl_word((float)(a0 - slope * c0)), w[k + 2 * i + 1] = rfl_word((float)slope);
  }
  rfl_put_lookup(l, n, RFL_ALBEDO), w[RFL_ALBEDO + 3] = k;
  for (k = 0; k < 2; ++k) {
    const uint32_t head = k ? RFL_ONE_SHOT : RFL_EXACT;
    rfl_check(l, rfl_chunk(l, file, size, tags[k][0]), error), slabs = rfl_partition(l, head);
    rfl_check(l, l->at == l->end && rfl_chunk(l, file, size, tags[k][1]) && rfl_uint(l, 4) == slabs, error);
    for (l->count += RFL_SLAB * slabs, i = slabs, x = 0; i-- > 0;) {
      if (k == 0) rfl_check(l, rfl_uint(l, 1) <= 1 && (x = rfl_finite(l)) >= 0, error);
      rfl_tree(l, (double)x, w + w[head + 3] + RFL_SLAB * i);
    }
    rfl_check(l, l->at == l->end, error);
  }
  w[2] = l->count;
}
/* Null, or what is wrong. The bytes are not needed afterwards. */
RFL_FN const char* rfl_load_bytes(rfl_sampler* s, const void* bytes, size_t size) {
  const unsigned char* file = (const unsigned char*)bytes;
  uint32_t crc = 0xffffffffu, bit, *words;
  const char* error;
  rfl_loader* l;
  size_t i;
  memset(s, 0, sizeof *s);
  if (size < 12 || size > 268435456 || memcmp(file, "\x89RFL\r\n\x1a\n", 8) != 0)
    return "not a sampler file; name one that `reflectree build` saved";
  for (i = 0; i < size - 4; ++i)
    for (crc ^= file[i], bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
  for (bit = 0; bit < 4; ++bit)
    if (file[size - 4 + bit] != ((~crc >> (8 * bit)) & 255u)) return "truncated or damaged: its checksum is wrong";
  l = (rfl_loader*)malloc(sizeof *l), words = (uint32_t*)malloc(4 * (2 * size + 16384)); /* more than tables take */
  if (!l || !words) return free(l), free(words), "not enough memory";
  l->words = words, l->error = NULL;
  if (setjmp(l->out) == 0) rfl_convert(l, file, size), rfl_open(s, words, l->count), s->owned = words;
  error = l->error, free(l);
  return error ? free(words), error : NULL;
}
RFL_FN const char* rfl_load(rfl_sampler* s, const char* path) {
  FILE* file = fopen(path, "rb");
  const char* error = "no file that can be read";
  unsigned char* bytes = NULL;
  long size = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : 0;
  memset(s, 0, sizeof *s);
  if (size > 0 && size <= 268435456 && fseek(file, 0, SEEK_SET) == 0) bytes = (unsigned char*)malloc((size_t)size);
  if (bytes && fread(bytes, 1, (size_t)size, file) == (size_t)size) error = rfl_load_bytes(s, bytes, (size_t)size);
  if (file) fclose(file);
  return free(bytes), error;
}
RFL_FN void rfl_free(rfl_sampler* s) { free(s->owned), memset(s, 0, sizeof *s); }
#endif
