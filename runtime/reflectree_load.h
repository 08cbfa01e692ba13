/* SPDX-License-Identifier: Apache-2.0
 * Sampler files become the array that reflectree_sample.h draws from. Nothing of a file is trusted; sampler_file.hpp has
 * the format. Allocates the array, which rfl_free() gives back.
 *
 *   const char* error = rfl_load(&s, "gold.rfl");    null, or what is wrong; rfl_free(&s) in the end */
#ifndef REFLECTREE_LOAD_H
#define REFLECTREE_LOAD_H
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include "reflectree_sample.h"
#define RFL_LOAD static inline
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
/* As rfl_azimuth, of an angle. */
RFL_FN float rfl_azimuth_of(float phi) {
  const double x = cos((double)phi), y = sin((double)phi), q = fabs(y) / (fabs(x) + fabs(y)), upper = x < 0 ? 2 - q : q;
  return phi >= 2 * rfl_pi ? 4.f : (float)(y < 0 ? 4 - upper : upper);
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
      node[0] = rfl_word(along ? rfl_azimuth_of(split) : -cosf(split)), node[3] = along;
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
