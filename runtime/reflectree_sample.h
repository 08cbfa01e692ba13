/* SPDX-License-Identifier: Apache-2.0
 * Reflectree's samplers in one C99 file (and C++): draws directions from the array that `reflectree export` wrote, or,
 * with reflectree_load.h, from a file that `reflectree build` saved. Needs libm and never allocates.
 *
 *   const char* error = rfl_open(&s, gold, sizeof gold / sizeof gold[0]);    null, or what is wrong
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
#if defined(__GNUC__) /* all of a draw in one piece: it overlaps with the next */
#define RFL_FN static inline __attribute__((always_inline))
#else
#define RFL_FN static inline
#endif
#if defined(__FAST_MATH__)
#error "reflectree_sample.h needs comparisons that see NaN; compile without -ffast-math"
#endif
/* ---- The array of words: its head, then tables, which are named by the number of words before them ---- */
enum { RFL_MAGIC = 0x574c4652, RFL_VERSION = 3, RFL_LEAF = 5, RFL_SLAB = 5, RFL_NODE = 4, RFL_MAX_TRIALS = 256 };
enum { RFL_PROJECTED_DISK, RFL_EQUAL_AREA, RFL_HALF_VECTOR, RFL_BACK_VECTOR, RFL_STRETCHED, RFL_MIRROR_VECTOR,
       RFL_NORMAL_VECTOR, RFL_SLOPE_STAR };
enum { RFL_ISOTROPIC, RFL_TWO_PLANES, RFL_ONE_PLANE, RFL_HALF_TURN, RFL_NO_SYMMETRY };
/* Over cosines. table: of a piece, base and slope; of a slab, where its leaves are, how many, where its nodes are,
 * the capacity of a bucket, the volume. A leaf: threshold, height, alias | x << 16, y | level_x << 16 | level_y << 24,
 * slope_x | slope_y << 8. A node: lower share, lower leaves | along x << 31. Where shift is 0, a tree over
 * -cos theta_o and rfl_azimuth leads to the slab, from the root, `guide`: border, lower child, upper child, axis. */
typedef struct { uint32_t shift, borders, guide, table; } rfl_lookup;
/* shape: exponent or stretch; turned: the domain wants wo without a y. The albedo has rows of so many pieces over
 * phi_o, in segments: phi_o, rows per radian, the row before the first, the last row but one. */
typedef struct {
  uint32_t magic, version, words, kind, half; float shape; uint32_t target, channel; float scale;
  rfl_lookup albedo, exact, one_shot; uint32_t symmetry, turned, segments, pieces; float cos_axis, sin_axis;
} rfl_head;
typedef struct { const uint32_t* words; uint32_t* owned; rfl_head h; } rfl_sampler;
typedef struct { float x, y, z; } rfl_vec;
typedef struct { rfl_vec known, axis; float cos_phi, sin_phi, side, phi, azimuth, albedo; } rfl_viewer; /* axis: the domain's */
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
RFL_FN float rfl_azimuth(uint32_t symmetry, float x, float y) { /* ascends with the azimuth, to 4: viewer_frame.hpp */
  const float a = fabsf(x), b = fabsf(y), q = b / rfl_max(a + b, 1e-37f), upper = x < 0 ? 2 - q : q;
  return symmetry == RFL_TWO_PLANES ? q : y < 0 ? 4 - upper : upper;
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
  v->known = wo, v->side = 1, v->phi = v->azimuth = 0;
  if (s->h.symmetry != RFL_ISOTROPIC) {
    if ((s->h.symmetry == RFL_TWO_PLANES && w.x < 0) || (s->h.symmetry == RFL_HALF_TURN && w.y < 0))
      w.x = -w.x, w.y = -w.y, a = -a, b = -b;
    if (s->h.symmetry <= RFL_ONE_PLANE && w.y < 0) w.y = -w.y, v->side = -1;
    if (s->h.symmetry == RFL_TWO_PLANES) w.x = fabsf(w.x); /* -0 is 0 */
    if (s->h.symmetry <= RFL_HALF_TURN) w.y = fabsf(w.y);
    v->phi = rfl_angle(w.y, w.x), v->azimuth = rfl_azimuth(s->h.symmetry, w.x, w.y);
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
  const float key[2] = {-rfl_min(v->known.z, 1.f), v->azimuth};
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
#endif
