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
 * of 32 uniform bits. Samplers are read-only: threads share them.
 *
 * Results have the bits of the C++ library's where floats are not contracted to fused multiply-adds: -ffp-contract=off.
 * `gcc -std=c99` is so anyway; gcc -std=gnu99, g++ and clang are not, once -march= offers them. */
#ifndef REFLECTREE_SAMPLE_H
#define REFLECTREE_SAMPLE_H
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#define RFL_LOAD static inline
#if defined(__GNUC__) /* all of a draw in one piece: it overlaps with the next */
#define RFL_FN static inline __attribute__((always_inline))
#else
#define RFL_FN static inline
#endif
#if defined(__FAST_MATH__)
#error "reflectree_sample.h needs comparisons that see NaN; compile without -ffast-math"
#endif
/* ---- The array of words: its head, then tables, which are named by the number of words before them ---- */
enum { RFL_MAGIC = 0x574c4652, RFL_VERSION = 2, RFL_LEAF = 5, RFL_SLAB = 5, RFL_NODE = 4, RFL_MAX_TRIALS = 256 };
enum { RFL_PROJECTED_DISK, RFL_EQUAL_AREA, RFL_HALF_VECTOR, RFL_BACK_VECTOR, RFL_STRETCHED, RFL_MIRROR_VECTOR,
       RFL_NORMAL_VECTOR, RFL_SLOPE_STAR };
enum { RFL_ISOTROPIC, RFL_TWO_PLANES, RFL_ONE_PLANE, RFL_HALF_TURN, RFL_NO_SYMMETRY };
/* Over cosines. table: of a piece, base and slope; of a slab, where its leaves are, how many, where its nodes are,
 * the capacity of a bucket, the volume. A leaf: threshold, height, alias | x << 16, y | level_x << 16 | level_y << 24,
 * slope_x | slope_y << 8. A node: lower share, lower leaves | along x << 31. Where shift is 0, a tree over theta_o and
 * phi_o leads to the slab, from the root, `guide`: border, lower child, upper child, axis. */
typedef struct { uint32_t shift, borders, guide, table; } rfl_lookup;
/* shape: exponent or stretch; turned: the domain wants wo without a y. The albedo has rows of so many pieces over
 * phi_o, in segments: phi_o, rows per radian, the row before the first, the last row but one. */
typedef struct {
  uint32_t magic, version, words, kind, half; float shape; uint32_t target, channel; float scale;
  rfl_lookup albedo, exact, one_shot; uint32_t symmetry, turned, segments, pieces; float cos_axis, sin_axis;
} rfl_head;
typedef struct { const uint32_t* words; uint32_t* owned; rfl_head h; } rfl_sampler;
typedef struct { float x, y, z; } rfl_vec;
typedef struct { rfl_vec known, axis; float cos_phi, sin_phi, side, phi, albedo; } rfl_viewer; /* axis: of the domain */
typedef struct { rfl_vec wi; float pdf, scale; } rfl_draw;                 /* scale: the weight over f */
typedef struct { rfl_vec wi; float cos_i, area, majorant; } rfl_candidate; /* a trial of exact mode */
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
  memset(s, 0, sizeof *s);
  if (!w || count < sizeof s->h / 4 || w[0] != (uint32_t)RFL_MAGIC || w[1] != (uint32_t)RFL_VERSION || w[2] != count)
    return "no array of this version and length; write it with this header's `reflectree export`";
  s->words = w, memcpy(&s->h, w, sizeof s->h);
  return NULL;
}
/* ---- The viewer ---- */
RFL_FN uint32_t rfl_find(const rfl_sampler* s, const rfl_lookup* l, float c) {
  const uint32_t* border = s->words + l->borders + 1;
  uint32_t i = s->words[l->guide + ((rfl_word(c) - rfl_word(rfl_min_cos)) >> l->shift)];
  for (i += rfl_float(border[i]) <= c; rfl_float(border[i]) <= c;) ++i;
  return i;
}
RFL_FN float rfl_angle(float y, float x) { /* from 0 to 2 pi, by a minimax polynomial: fast_functions.hpp */
  const float a = fabsf(x), b = fabsf(y), lo = rfl_min(a, b), hi = rfl_max(a, b);
  const int turn = lo > 0.41421356f * hi;
  const float below = turn ? lo + hi : hi, q = (turn ? lo - hi : lo) / (below > 0 ? below : 1.f), t = q * q;
  const float p = (-0.333329553f + t * 0.199779261f) + t * t * (-0.1387985f + t * 0.0806030888f);
  float angle = (q + q * (t * p)) + (turn ? 0.25f * rfl_pi : 0.f);
  angle = b > a ? 0.5f * rfl_pi - angle : angle, angle = x < 0 ? rfl_pi - angle : angle;
  return y < 0 && angle > 0 ? -angle + 2 * rfl_pi : angle;
}
/* Linear in the cosine; over the azimuth the cubic through four rows. */
RFL_FN float rfl_albedo(const rfl_sampler* s, float c, float phi) {
  const uint32_t *p = s->words + s->h.albedo.table + 2 * (size_t)rfl_find(s, &s->h.albedo, c), *g;
  float x, t, weights[4], sum = 0;
  uint32_t k;
  if (s->h.symmetry == RFL_ISOTROPIC) return rfl_float(p[0]) + rfl_float(p[1]) * c;
  for (g = s->words + s->h.segments; rfl_float(g[4]) <= phi;) g += 4;
  x = rfl_max((phi - rfl_float(g[0])) * rfl_float(g[1]), 0.f), k = (uint32_t)x < g[3] ? (uint32_t)x : g[3];
  t = x - (float)k, p += 2 * (size_t)(g[2] + k) * s->h.pieces;
  weights[0] = -t * (t - 1) * (t - 2) / 6, weights[1] = (t + 1) * (t - 1) * (t - 2) / 2;
  weights[2] = -(t + 1) * t * (t - 2) / 2, weights[3] = (t + 1) * t * (t - 1) / 6;
  for (k = 0; k < 4; ++k, p += 2 * s->h.pieces) sum += weights[k] * (rfl_float(p[0]) + rfl_float(p[1]) * c);
  return rfl_max(sum, 0.f);
}
/* 0 is "no sample": wo at or below the horizon, not finite, not of unit length, or albedo 0. Symmetries fold wo. */
RFL_FN int rfl_view(const rfl_sampler* s, rfl_vec wo, rfl_viewer* v) {
  const float s2 = wo.x * wo.x + wo.y * wo.y, sine = sqrtf(s2), inv = sine > 0 ? 1 / sine : 0.f, c = rfl_min(wo.z, 1.f);
  float a = s->h.cos_axis, b = s->h.sin_axis, x = 1, y = 0;
  rfl_vec w = rfl_turn(wo, a, -b);
  if (!(wo.z >= rfl_min_cos && fabsf(s2 + wo.z * wo.z - 1) <= 1e-3f)) return 0;
  v->known = wo, v->side = 1, v->phi = 0;
  if (s->h.symmetry != RFL_ISOTROPIC) {
    if ((s->h.symmetry == RFL_TWO_PLANES && w.x < 0) || (s->h.symmetry == RFL_HALF_TURN && w.y < 0))
      w.x = -w.x, w.y = -w.y, a = -a, b = -b;
    if (s->h.symmetry <= RFL_ONE_PLANE && w.y < 0) w.y = -w.y, v->side = -1;
    v->phi = rfl_angle(w.y, w.x);
  }
  v->axis = rfl_vec3(w.x, w.y, c);
  if (s->h.turned) x = sine > 0 ? w.x * inv : 1.f, y = v->side * (w.y * inv), v->axis = rfl_vec3(sine, 0, c);
  if (s->h.kind == RFL_BACK_VECTOR) v->axis.x = -sine;
  if (s->h.kind == RFL_NORMAL_VECTOR) v->axis = rfl_vec3(0, 0, 1);
  v->cos_phi = a * x - b * y, v->sin_phi = b * x + a * y;
  return (v->albedo = rfl_albedo(s, c, v->phi)) > 0;
}
RFL_FN rfl_vec rfl_outward(const rfl_viewer* v, rfl_vec w) {
  return rfl_turn(rfl_vec3(w.x, v->side * w.y, w.z), v->cos_phi, v->sin_phi);
}
RFL_FN const uint32_t* rfl_slab_at(const rfl_sampler* s, const rfl_lookup* l, const rfl_viewer* v) {
  const float key[2] = {-rfl_min(v->known.z, 1.f), v->phi};
  uint32_t at = l->guide;
  if (l->shift) return s->words + l->table + RFL_SLAB * (size_t)rfl_find(s, l, -key[0]);
  while (at < l->table) at = s->words[at + 1 + (key[s->words[at + 3]] >= rfl_float(s->words[at]))];
  return s->words + at;
}
/* ---- The domain: from the square to wi, with d(projected solid angle) / d(share); domain_map.hpp derives it ---- */
/* Along the azimuth (ux, uy) the radius t = y d ends at the rim p / c, with d = p / (p + (c - p) y). */
RFL_FN void rfl_rim(const rfl_sampler* s, rfl_vec a, float ux, float uy, float* p, float* c, float* zr) {
  if (s->h.kind == RFL_SLOPE_STAR) {
    const float x = s->h.shape * ux, y = uy / s->h.shape, q = x * x + y * y, b = x * a.x + y * a.y;
    const float l = sqrtf(b * b + q * (a.z * a.z)) + fabsf(b);
    *p = rfl_by_sign(b, l, a.z), *c = rfl_by_sign(b, q * a.z, l);
  } else {
    const float z2 = a.z * a.z, b = a.x * ux, l = sqrtf(z2 + b * b) + fabsf(b);
    if (s->h.kind == RFL_HALF_VECTOR || s->h.kind == RFL_BACK_VECTOR)
      *p = rfl_by_sign(b, l * l, z2), *c = a.z * l;
    else
      *p = rfl_by_sign(b, a.z, l), *c = rfl_by_sign(b, l, a.z), *zr = rfl_by_sign(b, z2 / l, l);
  }
}
RFL_FN rfl_point rfl_lift(const rfl_sampler* s, rfl_vec a, float px, float py) {
  const float h = 0.5f * px, q = h * h, q2 = q * q; /* ux = cos phi = sin(pi px / 2), uy = sin phi on the side of py */
  const float ux = h * ((3.14159264f - q * 5.16771009f) + q2 * ((2.55007766f - q * 0.598292159f) + q2 * 0.0776594082f));
  const float u = (1.f - q * 4.93480214f) +
                  q2 * ((4.05870916f - q * 1.33521206f) + q2 * (0.234937559f - q * 0.0243967166f));
  const float uy = rfl_float(rfl_word(u) ^ (rfl_word(py) & 0x80000000u)), y = rfl_max(fabsf(py), 1e-12f);
  float p, c, d, t, r = fabsf(py), z, zr = 0, won, cos2, twice;
  rfl_point o;
  if (s->h.kind == RFL_PROJECTED_DISK) {
    z = rfl_max(sqrtf(1.f - r), rfl_least), r = sqrtf(r), o.area = rfl_pi;
  } else if (s->h.kind == RFL_EQUAL_AREA) {
    z = rfl_max(1.f - r, rfl_least), r = sqrtf(r * (2.f - r)), o.area = 2 * rfl_pi * z;
  } else if (s->h.kind == RFL_STRETCHED) {
    p = 1 / (2 - s->h.shape), t = rfl_max(1.f - r, 1e-7f), z = rfl_max(powf(t, p), rfl_least);
    r = sqrtf(1.f - z * z), o.area = 2 * rfl_pi * p * z * z / t;
  } else {
    rfl_rim(s, a, ux, uy, &p, &c, &zr), d = p / (p + (c - p) * y), t = y * d;
    if (s->h.kind == RFL_MIRROR_VECTOR || s->h.kind == RFL_NORMAL_VECTOR) {
      const float tt = t * t, inverse = 1.f / (1.f + tt);
      z = rfl_max(d * (1.f - y) * (zr * t + a.z) * inverse, rfl_least);
      o.wi = rfl_vec3(-(a.x * (1.f - tt) + 2.f * t * a.z * ux) * inverse, 2.f * t * uy * inverse, z);
      return o.area = z * (8 * rfl_pi) * t * (inverse * inverse) * (d * d), o;
    }
    if (s->h.kind == RFL_SLOPE_STAR) { /* wh is along (x, v, 1) */
      const float x = t * (s->h.shape * ux), v = t * (uy / s->h.shape);
      won = rfl_max(a.x * x + a.y * v + a.z, rfl_least), cos2 = 1.f / (1.f + x * x + v * v), twice = 2.f * won * cos2;
      o.wi = rfl_vec3(twice * x - a.x, twice * v - a.y, rfl_max(twice - a.z, rfl_least));
    } else {
      won = rfl_max(a.x * ux * t + a.z, rfl_least), cos2 = 1.f / (1.f + t * t), twice = 2.f * won * cos2;
      o.wi = rfl_vec3(twice * t * ux - a.x, twice * t * uy, rfl_max(twice - a.z, rfl_least));
    }
    return o.area = o.wi.z * (8 * rfl_pi) * won * (cos2 * cos2) * (t * d * d), o;
  }
  return o.wi = rfl_vec3(r * ux, r * uy, z), o;
}
RFL_FN float rfl_quarter_atan(float t) {
  float s = t * t, p = (-0.00597563674f * s + 0.0308790214f) * s - 0.0757402948f;
  p = (((p * s + 0.126232606f) * s - 0.178501543f) * s + 0.254262416f) * s;
  return t * ((p - 0.424396087f) * s + 1.27323942f);
}
/* The inverse of rfl_lift; with half squares wi.y >= 0. */
RFL_FN void rfl_lower(const rfl_sampler* s, rfl_vec a, rfl_vec wi, float* at) {
  const int slopes = s->h.kind == RFL_SLOPE_STAR;
  const int about = s->h.kind == RFL_MIRROR_VECTOR || s->h.kind == RFL_NORMAL_VECTOR;
  const rfl_vec m = rfl_vec3(a.x - wi.x, a.y - wi.y, a.z - wi.z);
  rfl_vec w = wi;
  float y = wi.x * wi.x + wi.y * wi.y, p, c, zr = 0, t, sine, x, z = 0;
  if (s->h.kind == RFL_EQUAL_AREA) {
    y = y / (1 + wi.z);
  } else if (s->h.kind == RFL_STRETCHED) {
    y = 1 - powf(wi.z, 2 - s->h.shape);
  } else if (s->h.kind != RFL_PROJECTED_DISK) {
    if (about) {
      x = wi.x + a.x, z = wi.z - a.z, w = rfl_vec3(-a.z * x - a.x * z, wi.y, a.z * wi.z - a.x * wi.x);
    } else {
      w = rfl_vec3(a.x + wi.x, a.y + wi.y, a.z + wi.z);
      if (rfl_dot(a, wi) < 0.f) /* what is rounding is taken out of the sum */
        t = rfl_dot(w, m) / rfl_dot(m, m), w = rfl_vec3(w.x - t * m.x, w.y - t * m.y, w.z - t * m.z);
      t = 1.f / sqrtf(rfl_dot(w, w)), w = rfl_vec3(t * w.x, t * w.y, t * w.z), z = rfl_max(w.z, 1e-12f);
      if (slopes) w.x = w.x / (z * s->h.shape), w.y = w.y / z * s->h.shape;
    }
    sine = sqrtf(rfl_max(w.x * w.x + w.y * w.y, rfl_least * rfl_least));
    t = slopes ? sine : !about ? sine / z : w.z > 0 ? sine / (1 + w.z) : (1 - w.z) / sine;
    if (slopes) w = rfl_vec3(w.x == 0 && w.y == 0 ? 1.f : w.x / sine, w.y / sine, 0), sine = 1;
    rfl_rim(s, a, w.x / sine, w.y / sine, &p, &c, &zr), y = p * t / (p - (c - p) * t);
  }
  x = fabsf(w.x), z = fabsf(w.y), y = rfl_clamp(y);
  t = x > z ? 1 - 0.5f * rfl_quarter_atan(z / x) : z > 0 ? 0.5f * rfl_quarter_atan(x / z) : 1.f;
  at[0] = w.x < 0 ? -t : t, at[1] = !s->h.half && w.y < 0 ? -y : y;
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
RFL_FN float rfl_at(const rfl_sampler* s, const uint32_t* leaf, float tx, float ty, float* px, float* py) {
  const int x = (int)(leaf[2] >> 16), y = (int)(leaf[3] & 0xffffu);
  const float gx = rfl_slope(leaf[4]), gy = rfl_slope(leaf[4] >> 8);
  *px = (float)(x - 0x4000) * 6.103515625e-05f + rfl_power(128u - ((leaf[3] >> 16) & 255u)) * tx;
  *py = s->h.half ? (float)y * 3.0517578125e-05f + rfl_power(127u - (leaf[3] >> 24)) * ty
             : (float)(y - 0x4000) * 6.103515625e-05f + rfl_power(128u - (leaf[3] >> 24)) * ty;
  return rfl_float(leaf[1]) * ((1.f - gx) + 2.f * gx * tx) * ((1.f - gy) + 2.f * gy * ty);
}
/* From four words: a leaf, a point in it, the coin for the side of half squares. */
RFL_FN rfl_point rfl_place(const rfl_sampler* s, const rfl_lookup* l, const rfl_viewer* v, const uint32_t* b,
                           float* h) {
  uint32_t spare;
  const uint32_t* leaf = rfl_choose(s, rfl_slab_at(s, l, v), b, &spare);
  const float tx = rfl_mix(rfl_byte(leaf[4]), b[2], spare);
  const float ty = rfl_linear(rfl_slope(leaf[4] >> 8), (float)(b[3] >> 8) * 5.9604644775390625e-08f);
  float px, py;
  *h = rfl_at(s, leaf, tx, ty, &px, &py);
  return rfl_lift(s, v->axis, px, s->h.half && (b[3] & 1u) ? -py : py);
}
RFL_FN void rfl_finish(const rfl_viewer* v, rfl_point p, float height, rfl_draw* out) {
  out->wi = rfl_outward(v, p.wi), out->pdf = height / p.area * p.wi.z, out->scale = p.area / height;
}
/* ---- One-shot mode: from four words of random bits ---- */
RFL_FN void rfl_one_shot(const rfl_sampler* s, const rfl_viewer* v, const uint32_t* bits, rfl_draw* out) {
  float height;
  const rfl_point p = rfl_place(s, &s->h.one_shot, v, bits, &height);
  rfl_finish(v, p, height, out);
}
/* Down to the leaf of uniforms u or, where there are none, of a point p: its cell, and its share of the uniforms. */
typedef struct { const uint32_t* leaf; double lo[2], share[2]; float start[2], size[2]; } rfl_cell;
RFL_FN void rfl_descend(const rfl_sampler* s, const rfl_viewer* v, const double* u, const float* p, rfl_cell* c) {
  const uint32_t *slab = rfl_slab_at(s, &s->h.one_shot, v), *node = s->words + slab[2];
  uint32_t left = slab[1];
  c->leaf = s->words + slab[0], c->lo[0] = c->lo[1] = 0, c->share[0] = c->share[1] = 1;
  c->start[0] = -1, c->size[0] = 2, c->start[1] = s->h.half ? 0.f : -1.f, c->size[1] = s->h.half ? 1.f : 2.f;
  while (left > 1) {
    const uint32_t axis = 1u - (node[1] >> 31), lower_leaves = node[1] & 0x7fffffffu;
    const double lower = c->share[axis] * (double)rfl_float(node[0]);
    const float middle = c->start[axis] + (c->size[axis] *= 0.5f);
    const int up = u ? u[axis] >= c->lo[axis] + lower : p[axis] >= middle;
    c->lo[axis] += up ? lower : 0, c->share[axis] = up ? c->share[axis] - lower : lower;
    c->start[axis] = up ? middle : c->start[axis], left = up ? left - lower_leaves : lower_leaves;
    c->leaf += up ? RFL_LEAF * (size_t)lower_leaves : 0, node += up ? 2 * (size_t)lower_leaves : 2;
  }
}
/* From two uniforms of [0, 1], monotone; 0 where they are none. */
RFL_FN int rfl_one_shot_uniforms(const rfl_sampler* s, const rfl_viewer* v, double u1, double u2, rfl_draw* out) {
  const int below = s->h.half && u2 < 0.5;
  double u[2];
  float px, py, height, t[2];
  rfl_cell c;
  int i;
  if (!(u1 >= 0 && u1 <= 1 && u2 >= 0 && u2 <= 1)) return 0;
  u[0] = u1, u[1] = !s->h.half ? u2 : below ? 1 - 2 * u2 : 2 * u2 - 1;
  rfl_descend(s, v, u, NULL, &c);
  for (i = 0; i < 2; ++i)
    t[i] = rfl_linear(rfl_slope(c.leaf[4] >> (8 * i)), rfl_min((float)((u[i] - c.lo[i]) / c.share[i]), 1.f));
  height = rfl_at(s, c.leaf, t[0], t[1], &px, &py);
  return rfl_finish(v, rfl_lift(s, v->axis, px, below ? -py : py), height, out), 1;
}
/* The uniforms that rfl_one_shot_uniforms takes to wi, up to rounding, and the pdf there; 0 below the horizon. */
RFL_FN float rfl_one_shot_invert(const rfl_sampler* s, const rfl_viewer* v, rfl_vec wi, double* u) {
  rfl_vec w = rfl_turn(wi, v->cos_phi, -v->sin_phi);
  const int below = s->h.half && w.y < 0;
  float p[2], t[2], px, py;
  rfl_point at;
  rfl_cell c;
  int i;
  if (!(wi.z > 0)) return 0;
  w.y = s->h.half ? fabsf(w.y) : v->side * w.y;
  rfl_lower(s, v->axis, w, p), at = rfl_lift(s, v->axis, p[0], p[1]), rfl_descend(s, v, NULL, p, &c);
  for (i = 0; i < 2; ++i) {
    t[i] = rfl_clamp((p[i] - c.start[i]) / c.size[i]);
    u[i] = c.lo[i] + c.share[i] * (double)(t[i] * (1 - rfl_slope(c.leaf[4] >> (8 * i)) * (1 - t[i])));
  }
  if (s->h.half) u[1] = below ? 0.5 * (1 - u[1]) : 0.5 * (1 + u[1]);
  return rfl_at(s, c.leaf, t[0], t[1], &px, &py) * at.wi.z / at.area;
}
RFL_FN float rfl_one_shot_pdf(const rfl_sampler* s, const rfl_viewer* v, rfl_vec wi) {
  double u[2];
  return rfl_one_shot_invert(s, v, wi, u);
}
/* ---- Exact mode: first the scalar that is sampled, from the channels of f ---- */
RFL_FN float rfl_target(const rfl_sampler* s, const float* f, int channels) {
  static const float rgb[3] = {0.2126f, 0.7152f, 0.0722f};
  float t = 0, sum = 0;
  int c;
  if (channels == 1) return s->h.scale * f[0];
  for (c = 0; c < channels; ++c) {
    sum += s->h.scale * f[c] * (s->h.scale * f[c]);
    if (s->h.target == 1) t += channels == 3 ? rgb[c] * f[c] : f[c] / (float)channels;
    if (s->h.target == 2) t = rfl_max(t, f[c]);
  }
  if (s->h.target == 3) t = f[(int)s->h.channel < channels ? (int)s->h.channel : channels - 1];
  return s->h.target == 0 ? sqrtf(sum) : 0.99f * (s->h.scale * t) + 0.01f * sqrtf(sum);
}
/* One trial, from four words. Evaluate f at v->known and out->wi, and ask rfl_accept; then propose again. */
RFL_FN void rfl_propose(const rfl_sampler* s, const rfl_viewer* v, const uint32_t* bits, rfl_candidate* out) {
  const rfl_point p = rfl_place(s, &s->h.exact, v, bits, &out->majorant);
  out->wi = rfl_outward(v, p.wi), out->cos_i = p.wi.z, out->area = p.area;
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
typedef struct { float lo[2], hi[2]; uint32_t* link; } rfl_box; /* of a node to come, and what shall lead to it */
typedef struct {
  const unsigned char *file, *at, *end, *values, *splits, *slope_x, *slope_y;
  const char* error; /* what to say of the chunk in which something is wrong */
  uint32_t *words, *leaf, *node, count, splits_count, split, leaves, next, rows, segments;
  uint32_t mass[65536], small[65536], large[65536];
  uint64_t left[65536];
  float span, border[60002], phi[4096];
  double unit, whole;
  rfl_box box[60002];
  rfl_head h;
  size_t size;
  jmp_buf out;
} rfl_loader;
RFL_LOAD void rfl_check(rfl_loader* l, int good) { if (!good) longjmp(l->out, 1); }
RFL_LOAD const unsigned char* rfl_take(rfl_loader* l, size_t n) {
  return rfl_check(l, n <= (size_t)(l->end - l->at)), l->at += n, l->at - n;
}
RFL_LOAD uint32_t rfl_uint(rfl_loader* l, size_t n) {
  const unsigned char* at = rfl_take(l, n);
  uint32_t v = 0;
  while (n-- > 0) v = v << 8 | at[n];
  return v;
}
RFL_LOAD float rfl_finite(rfl_loader* l) {
  const float f = rfl_float(rfl_uint(l, 4));
  return rfl_check(l, fabsf(f) <= 3.40282347e38f), f;
}
/* Of `border`, whose last becomes 2. The bits of a float index a guide, finer until no entry spans two borders. */
RFL_LOAD void rfl_put_lookup(rfl_loader* l, uint32_t n, rfl_lookup* to) {
  const uint32_t least = rfl_word(rfl_min_cos), most = rfl_word(1.f) - least;
  uint32_t entry, i, before, crowded = 1;
  l->border[n - 1] = 2, to->borders = l->count, to->guide = l->count + n, to->shift = 19;
  for (i = 0; i < n; ++i) l->words[l->count++] = rfl_word(l->border[i]);
  while (to->shift > 15 && crowded) {
    for (--to->shift, crowded = 0, i = 0, l->count = to->guide, entry = 0; entry <= most >> to->shift; ++entry) {
      for (before = i; l->border[i + 1] <= rfl_float(least + (entry << to->shift));) ++i;
      crowded += i > before + 1, l->words[l->count++] = i;
    }
  }
}
/* A tree in preorder. Slabs come in reverse, so that those of theta_o alone ascend in its cosine. Returns how many. */
RFL_LOAD uint32_t rfl_partition(rfl_loader* l, rfl_lookup* to) {
  static const char* const names[2] = {"theta_o", "phi_o"};
  const uint32_t axes = l->h.symmetry == RFL_ISOTROPIC ? 1 : 2;
  const unsigned char* axis;
  uint32_t n, i, open = 1, done = 0, slabs, *node;
  rfl_box* b = l->box;
  for (rfl_check(l, rfl_uint(l, 4) == axes), i = 0; i < axes; ++i) {
    n = (uint32_t)strlen(names[i]), rfl_check(l, rfl_uint(l, 4) == n && memcmp(rfl_take(l, n), names[i], n) == 0);
    b->lo[i] = rfl_finite(l), b->hi[i] = rfl_finite(l), rfl_check(l, b->lo[i] == 0);
    rfl_check(l, i ? fabsf(b->hi[i] - l->span) <= 1e-4f : b->hi[i] > 1.5707f && b->hi[i] <= 0.5f * rfl_pi);
  }
  n = rfl_uint(l, 4), axis = rfl_take(l, n), slabs = n / 2 + 1, b->link = &to->guide, to->shift = 0;
  rfl_check(l, n % 2 == 1 && slabs <= 60000 && rfl_uint(l, 4) == n / 2);
  for (to->table = l->count + RFL_NODE * (n / 2), i = 0; i < n; ++i) {
    rfl_check(l, open > 0), b = l->box + --open;
    if (axis[i] == 255) {
      l->border[slabs - done++] = cosf(b->lo[0]), *b->link = to->table + RFL_SLAB * (slabs - done);
    } else {
      const uint32_t along = axis[i];
      const float split = rfl_finite(l);
      rfl_check(l, along < axes && split > b->lo[along] && split < b->hi[along] && l->count < to->table);
      *b->link = l->count, node = l->words + l->count, l->count += RFL_NODE, open += 2;
      node[0] = rfl_word(along ? split : -cosf(split)), node[3] = along;
      b[1] = b[0], b[0].lo[along] = b[1].hi[along] = split, b[0].link = node + 2, b[1].link = node + 1;
    }
  }
  rfl_check(l, open == 0);
  if (axes == 1) /* a lookup in place of the tree */
    l->count -= RFL_NODE * (n / 2), l->border[0] = rfl_min_cos, rfl_put_lookup(l, slabs + 1, to), to->table = l->count;
  return l->count += RFL_SLAB * slabs, slabs;
}
/* Symmetry, axis, stretch and the azimuths of the albedo's rows. */
RFL_LOAD void rfl_anisotropy(rfl_loader* l) {
  const uint32_t symmetry = l->h.symmetry = rfl_uint(l, 1);
  const float axis = rfl_finite(l), stretch = rfl_finite(l);
  uint32_t i;
  l->rows = rfl_uint(l, 4), l->segments = 1, l->h.cos_axis = cosf(axis), l->h.sin_axis = sinf(axis);
  rfl_check(l, symmetry > 0 && symmetry <= RFL_NO_SYMMETRY && fabsf(axis) <= 7 && !l->h.half);
  rfl_check(l, stretch > 0.001f && stretch < 1000 && l->rows >= 2 && l->rows <= 4096);
  for (i = 0; i < l->rows; ++i) l->phi[i] = rfl_finite(l), l->segments += i > 0 && l->phi[i] == l->phi[i - 1];
  l->span = (symmetry == RFL_TWO_PLANES ? 0.5f : symmetry == RFL_NO_SYMMETRY ? 2.f : 1.f) * rfl_pi;
  rfl_check(l, l->phi[0] == 0 && fabsf(l->phi[i - 1] - l->span) <= 1e-4f);
  if (l->h.kind == RFL_SLOPE_STAR) l->h.shape = stretch;
}
/* The albedo in row k of a segment of rows from `first` to first + last. Beyond its ends a single one is mirrored or
 * comes round; of several the polynomial goes on. */
RFL_LOAD float rfl_in_row(rfl_loader* l, uint32_t column, uint32_t first, int last, int k) {
  static const float weights[4][4] = {{1, 0, 0, 0}, {2, -1, 0, 0}, {3, -3, 1, 0}, {4, -6, 4, -1}};
  const int inside = k >= 0 && k <= last, order = inside || l->segments == 1 ? 0 : last < 3 ? last : 3;
  int m, row = k;
  float sum = 0;
  if (!inside && l->segments == 1)
    row = l->h.symmetry <= RFL_ONE_PLANE ? (k < 0 ? -k : 2 * last - k) : k < 0 ? k + last : k - last;
  for (m = 0; m <= order; ++m) {
    if (order > 0) row = k < 0 ? m : last - m;
    l->at = l->values + 4 * ((first + (uint32_t)row) * (size_t)(l->h.pieces + 1) + column);
    sum += weights[order][m] * rfl_finite(l);
  }
  return sum;
}
RFL_LOAD void rfl_albedo_table(rfl_loader* l) {
  const float error = rfl_finite(l), *phi = l->phi;
  const uint32_t n = rfl_uint(l, 4), beyond = l->h.symmetry != RFL_ISOTROPIC;
  uint32_t i, first, last, k, *g = l->words + l->count, padded = 0;
  double c0, a0, c1 = 0, a1 = 0, slope;
  rfl_check(l, error >= 0 && error <= 1 && n >= 2 && n <= 60000);
  for (i = 0; i < n; ++i) l->border[i] = rfl_finite(l), rfl_check(l, i == 0 || l->border[i] > l->border[i - 1]);
  rfl_check(l, l->border[0] == rfl_min_cos && l->border[n - 1] == 1 && rfl_uint(l, 4) == n * l->rows);
  for (l->values = l->at, i = 0; i < n * l->rows; ++i) rfl_check(l, rfl_finite(l) >= 0);
  rfl_check(l, l->at == l->end), l->h.segments = l->count, l->h.pieces = n - 1;
  l->count += 4 * l->segments + 1, l->h.albedo.table = l->count;
  for (first = 0; first < l->rows; first += last + 1, g += 4, padded += last + 3) {
    for (last = 0; first + last + 1 < l->rows && phi[first + last + 1] != phi[first + last];) ++last;
    if (beyond) {
      const float begin = phi[first], end = phi[first + last];
      rfl_check(l, last >= (l->segments > 1 ? 1 : 2) && end > begin && end < 6.3f);
      for (k = 1; k <= last; ++k)
        rfl_check(l, fabsf(phi[first + k] - (begin + (float)k / (float)last * (end - begin))) <= 1e-5f * end);
      g[0] = rfl_word(begin), g[1] = rfl_word((float)last / (end - begin)), g[2] = padded, g[3] = last - 1;
      g[4] = rfl_word(8.f); /* beyond all azimuths */
    }
    for (k = 0; k <= last + 2 * beyond; ++k)
      for (i = 0; i < n; ++i) {
        c0 = c1, a0 = a1, c1 = (double)l->border[i], a1 = (double)rfl_in_row(l, i, first, (int)last, (int)(k - beyond));
        if (i == 0) continue;
        slope = (a1 - a0) / (c1 - c0);
        if (i + 1 < n && rfl_word(l->border[i]) - rfl_word(l->border[i - 1]) < 2) slope = 0; /* a step has no inside */
        l->words[l->count++] = rfl_word((float)(a0 - slope * c0)), l->words[l->count++] = rfl_word((float)slope);
      }
  }
  l->at = l->end, rfl_put_lookup(l, n, &l->h.albedo);
}
/* A subtree in preorder, at most 15 levels deep along each axis. Returns its mass. */
RFL_LOAD double rfl_subtree(rfl_loader* l, uint32_t x, uint32_t y, uint32_t lx, uint32_t ly) {
  const uint32_t i = l->split++, first = l->next, good = i < l->splits_count && lx < 16 && ly < 16;
  const uint32_t split = good ? (l->splits[i / 4] >> (2 * (i % 4))) & 3u : 3u, along_x = split == 1;
  uint32_t *leaf = l->leaf + RFL_LEAF * first, *node = l->node;
  double lower, upper;
  rfl_check(l, split < 3 && (split == 0 ? first < l->leaves : node < l->words + l->count));
  if (split == 0) {
    const double mass = l->unit * l->mass[l->next++];
    rfl_check(l, l->slope_x[first] != 128 && l->slope_y[first] != 128);
    leaf[1] = rfl_word((float)(mass / (double)rfl_power(127u - lx - ly))), leaf[2] |= x << 16, l->whole += mass;
    leaf[3] = y | lx << 16 | ly << 24, leaf[4] = l->slope_x[first] + l->slope_y[first] * 256u;
    return (double)l->mass[first];
  }
  l->node += 2, lower = rfl_subtree(l, x, y, lx + along_x, ly + !along_x);
  node[1] = (l->next - first) | along_x << 31, x += along_x ? 0x4000u >> lx : 0, y += along_x ? 0 : 0x4000u >> ly;
  upper = rfl_subtree(l, x, y, lx + along_x, ly + !along_x), node[0] = rfl_word((float)(lower / (lower + upper)));
  return lower + upper;
}
/* volume 0: a density. The heaviest leaf takes up what its masses lack to a multiple of their number. */
RFL_LOAD void rfl_tree(rfl_loader* l, double volume, uint32_t* slab) {
  uint32_t n = rfl_uint(l, 4), m, i, heaviest = 0, small = 0, large = 0, last;
  uint64_t sum = 0, bucket;
  l->splits = rfl_take(l, n / 4 + (n % 4 != 0)), m = rfl_uint(l, 4);
  rfl_check(l, n % 2 == 1 && m == n / 2 + 1 && m <= 65535 && l->splits[n / 4] >> (2 * (n % 4)) == 0);
  for (i = 0; i < m; ++i) {
    l->mass[i] = rfl_uint(l, 4), rfl_check(l, l->mass[i] > 0 && (sum += l->mass[i]) <= 0xffffffffu);
    if (l->mass[i] > l->mass[heaviest]) heaviest = i;
  }
  l->slope_x = rfl_take(l, m), l->slope_y = rfl_take(l, m), bucket = (sum + m - 1) / m;
  l->unit = volume / (double)sum, l->unit = l->unit > 0 ? l->unit : 1 / ((double)bucket * m);
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
  for (; small + large > 0; l->leaf[RFL_LEAF * i] = slab[3], l->leaf[RFL_LEAF * i + 2] = i)
    i = large > 0 ? l->large[--large] : l->small[--small];
  l->splits_count = n, l->leaves = m, l->split = l->next = 0, l->whole = 0, rfl_subtree(l, 0, 0, 0, 0);
  rfl_check(l, l->split == n && l->next == m), slab[4] = rfl_word((float)l->whole);
}
/* Finds a chunk by the end of what is said if it is damaged. Without one there is nothing to read. */
RFL_LOAD int rfl_chunk(rfl_loader* l, const char* damaged) {
  static const char known[] = "MATL TARG DOMN EXPA EXTR ONPA ONTR ALBD PROB REPT SCAL PRCH NOTE ANIS FMLY WDTH";
  const unsigned char *from = l->file, *to = l->file, *payload;
  rfl_check(l, l->at == l->end), l->error = damaged; /* the chunk before ends where it should */
  for (l->at = l->file + 8, l->end = l->file + l->size - 4; l->at < l->end;) {
    char name[5] = "";
    const char* place = (const char*)memcpy(name, rfl_take(l, 4), 4);
    const uint32_t version = rfl_uint(l, 2), flags = rfl_uint(l, 2), length = rfl_uint(l, 4), high = rfl_uint(l, 4);
    rfl_check(l, high == 0), payload = rfl_take(l, length), place = strstr(known, name);
    if (version == 1 && strlen(name) == 4 && place && (place - known) % 5 == 0) {
      if (memcmp(name, damaged + 15, 4) == 0) rfl_check(l, from == l->file), from = payload, to = l->at;
    } else if (!(flags & 1)) {
      l->error = "written by a later version; take its reflectree_sample.h", longjmp(l->out, 1);
    }
  }
  return l->at = from, l->end = to, from != l->file;
}
RFL_LOAD void rfl_convert(rfl_loader* l) {
  rfl_head* h = &l->h;
  uint32_t i, k, slabs;
  float volume = 0;
  if (rfl_chunk(l, "damaged: chunk FMLY") || rfl_chunk(l, "damaged: chunk WDTH"))
    l->error = "a family, or a member cut out of one; use the library", longjmp(l->out, 1);
  memset(h, 0, sizeof *h), h->magic = RFL_MAGIC, h->version = RFL_VERSION, l->count = sizeof *h / 4;
  h->scale = h->cos_axis = 1, l->rows = 1, l->segments = 0;
  rfl_chunk(l, "damaged: chunk TARG"), h->target = rfl_uint(l, 1), h->channel = rfl_uint(l, 2);
  rfl_check(l, h->target <= 3), rfl_chunk(l, "damaged: chunk DOMN");
  h->kind = rfl_uint(l, 1), h->half = rfl_uint(l, 1), h->shape = rfl_finite(l);
  rfl_check(l, h->kind <= RFL_SLOPE_STAR && h->half <= 1 && h->shape >= 0 && h->shape < 2);
  if (rfl_chunk(l, "damaged: chunk SCAL")) h->scale = rfl_finite(l), rfl_check(l, h->scale > 0);
  if (rfl_chunk(l, "damaged: chunk ANIS")) rfl_anisotropy(l); else rfl_check(l, h->kind != RFL_SLOPE_STAR);
  h->turned = !h->symmetry || !(h->kind <= RFL_EQUAL_AREA || h->kind == RFL_STRETCHED || h->kind == RFL_SLOPE_STAR);
  rfl_chunk(l, "damaged: chunk ALBD"), rfl_albedo_table(l);
  for (k = 0; k < 2; ++k) {
    rfl_lookup* const to = k ? &h->one_shot : &h->exact;
    rfl_chunk(l, k ? "damaged: chunk ONPA" : "damaged: chunk EXPA"), slabs = rfl_partition(l, to);
    rfl_chunk(l, k ? "damaged: chunk ONTR" : "damaged: chunk EXTR"), rfl_check(l, rfl_uint(l, 4) == slabs);
    for (i = slabs; i-- > 0;) {
      if (k == 0) rfl_check(l, rfl_uint(l, 1) <= 1), volume = rfl_finite(l), rfl_check(l, volume >= 0);
      rfl_tree(l, k ? 0 : (double)volume, l->words + to->table + RFL_SLAB * i);
    }
  }
  rfl_check(l, l->at == l->end), h->words = l->count, memcpy(l->words, h, sizeof *h);
}
/* Null, or what is wrong. The bytes are not needed afterwards. */
RFL_LOAD const char* rfl_load_bytes(rfl_sampler* s, const void* bytes, size_t size) {
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
  l->words = words, l->file = l->at = l->end = file, l->size = size, l->error = NULL;
  if (setjmp(l->out) == 0) rfl_convert(l), rfl_open(s, words, l->count), s->owned = words, l->error = NULL;
  error = l->error, free(l);
  return error ? free(words), error : NULL;
}
RFL_LOAD const char* rfl_load(rfl_sampler* s, const char* path) {
  FILE* file = fopen(path, "rb");
  const long size = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : 0;
  unsigned char* bytes = size > 0 && size <= 268435456 ? (unsigned char*)malloc((size_t)size) : NULL;
  const int read = bytes && fseek(file, 0, SEEK_SET) == 0 && fread(bytes, 1, (size_t)size, file) == (size_t)size;
  const char* error = rfl_load_bytes(s, bytes, read ? (size_t)size : 0);
  if (file) fclose(file);
  return free(bytes), read ? error : "no file that can be read";
}
RFL_LOAD void rfl_free(rfl_sampler* s) { free(s->owned), memset(s, 0, sizeof *s); }
#endif
