// SPDX-License-Identifier: Apache-2.0
//
// Reflectree's samplers for shaders: GLSL ES 3.10, GLSL 4.30 and later. Text to put behind
//   #define RFL_WORD(i) words[i]      // a uint of the array that `reflectree export` wrote, from a buffer or a const
// Names, directions and measures are those of reflectree_sample.h; where it draws from words of random bits, so do
// these, and agree with it to rounding.
//
//   RflViewer v;
//   if (rfl_view(wo, v)) {
//     RflDraw d = rfl_one_shot(v, bits);       // uvec4; the weight is d.scale * f(wo, d.wi)
//     RflCandidate c = rfl_propose(v, bits);   // exact mode: evaluate f at c.wi, t = rfl_target(f)
//     if (rfl_accept(v, c, t, word, d)) ...    // else propose again, RFL_MAX_TRIALS times
//   }

const int RFL_MAX_TRIALS = 256;
const int RFL_ALBEDO = 9, RFL_EXACT = 13, RFL_ONE_SHOT = 17;
const float RFL_PI = 3.14159274, RFL_LEAST = 1e-7, RFL_MIN_COS = 7.62939453125e-06;
// Domains: 0 projected_disk, 1 equal_area, 2 half_vector, 3 back_vector, 4 stretched, 5 mirror_vector, 6 normal_vector.

struct RflViewer { vec3 known, wo; float cos_phi, sin_phi, albedo; };
struct RflDraw { vec3 wi; float pdf, scale; };
struct RflCandidate { vec3 wi; float cos_i, area, majorant; };
struct RflPoint { vec3 wi; float area; };

float rfl_float(int i) { return uintBitsToFloat(RFL_WORD(i)); }
int rfl_kind() { return int(RFL_WORD(3)); }
bool rfl_half() { return RFL_WORD(4) != 0u; }
// Where the sign bit of s is clear a, else b; also for zeros.
float rfl_by_sign(float s, float a, float b) { return (floatBitsToUint(s) >> 31) == 0u ? a : b; }

// ---- The viewer ----

int rfl_find(int head, float c) {
  int borders = int(RFL_WORD(head + 1));
  uint entry = (floatBitsToUint(c) - floatBitsToUint(RFL_MIN_COS)) >> RFL_WORD(head);
  int i = int(RFL_WORD(int(RFL_WORD(head + 2) + entry)));
  while (rfl_float(borders + i + 1) <= c) ++i;
  return i;
}
// false is "no sample": wo at or below the horizon, not of unit length, or albedo 0.
bool rfl_view(vec3 wo, out RflViewer v) {
  float sine = sqrt(wo.x * wo.x + wo.y * wo.y), inverse = sine > 0.0 ? 1.0 / sine : 0.0, c = min(wo.z, 1.0);
  v = RflViewer(wo, vec3(sine, 0.0, c), sine > 0.0 ? wo.x * inverse : 1.0, wo.y * inverse, 0.0);
  if (!(wo.z >= RFL_MIN_COS && abs(dot(wo, wo) - 1.0) <= 1e-3)) return false;
  int piece = int(RFL_WORD(RFL_ALBEDO + 3)) + 2 * rfl_find(RFL_ALBEDO, c);
  v.albedo = rfl_float(piece) + rfl_float(piece + 1) * c;
  return v.albedo > 0.0;
}
int rfl_slab_at(int head, RflViewer v) { return int(RFL_WORD(head + 3)) + 5 * rfl_find(head, v.wo.z); }
vec3 rfl_outward(RflViewer v, vec3 w) {
  return vec3(w.x * v.cos_phi - w.y * v.sin_phi, w.x * v.sin_phi + w.y * v.cos_phi, w.z);
}
vec3 rfl_inward(RflViewer v, vec3 w) {
  return vec3(w.x * v.cos_phi + w.y * v.sin_phi, w.y * v.cos_phi - w.x * v.sin_phi, w.z);
}

// ---- The domain ----

// p and c of half_vector and back_vector; p, c and z R of mirror_vector and normal_vector.
vec2 rfl_star(float sin_o, float cos_o, float cos_phi) {
  float sx = sin_o * cos_phi, l = sqrt(cos_o * cos_o + sx * sx) + abs(sx);
  return vec2(rfl_by_sign(sx, l * l, cos_o * cos_o), cos_o * l);
}
vec3 rfl_rim(float sin_o, float cos_o, float cos_phi) {
  float sx = sin_o * cos_phi, l = sqrt(cos_o * cos_o + sx * sx) + abs(sx);
  return vec3(rfl_by_sign(sx, cos_o, l), rfl_by_sign(sx, l, cos_o), rfl_by_sign(sx, cos_o * cos_o / l, l));
}
RflPoint rfl_lift(vec3 wo, vec2 p) {
  float r = abs(p.y), y = max(r, 1e-12), z, h = 0.5 * p.x, q = h * h, q2 = q * q;
  float ux = h * ((3.14159264 - q * 5.16771009) + q2 * ((2.55007766 - q * 0.598292159) + q2 * 0.0776594082));
  float uy = (1.0 - q * 4.93480214) + q2 * ((4.05870916 - q * 1.33521206) + q2 * (0.234937559 - q * 0.0243967166));
  uy = rfl_by_sign(p.y, uy, -uy);
  int kind = rfl_kind();
  if (kind == 2 || kind == 3) {
    float ax = kind == 2 ? wo.x : -wo.x;
    vec2 s = rfl_star(ax, wo.z, ux);
    float d = s.x / (s.x + (s.y - s.x) * y), t = y * d, won = max(ax * ux * t + wo.z, RFL_LEAST);
    float cos2 = 1.0 / (1.0 + t * t), twice = 2.0 * won * cos2;
    vec3 wi = vec3(twice * t * ux - ax, twice * t * uy, max(twice - wo.z, RFL_LEAST));
    return RflPoint(wi, wi.z * (8.0 * RFL_PI) * won * (cos2 * cos2) * (t * d * d));
  }
  if (kind >= 5) {
    vec2 a = kind == 5 ? wo.xz : vec2(0.0, 1.0);
    vec3 s = rfl_rim(a.x, a.y, ux);
    float d = s.x / (s.x + (s.y - s.x) * y), t = y * d, tt = t * t, inverse = 1.0 / (1.0 + tt);
    z = max(d * (1.0 - y) * (s.z * t + a.y) * inverse, RFL_LEAST);
    vec3 wi = vec3(-(a.x * (1.0 - tt) + 2.0 * t * a.y * ux) * inverse, 2.0 * t * uy * inverse, z);
    return RflPoint(wi, z * (8.0 * RFL_PI) * t * (inverse * inverse) * (d * d));
  }
  float area = RFL_PI;
  if (kind == 0) {
    z = max(sqrt(1.0 - r), RFL_LEAST);
    r = sqrt(r);
  } else if (kind == 1) {
    z = max(1.0 - r, RFL_LEAST);
    r = sqrt(r * (2.0 - r));
    area = 2.0 * RFL_PI * z;
  } else {
    float power = 1.0 / (2.0 - rfl_float(5)), v = max(1.0 - r, 1e-7);
    z = max(pow(v, power), RFL_LEAST);
    r = sqrt(1.0 - z * z);
    area = 2.0 * RFL_PI * power * z * z / v;
  }
  return RflPoint(vec3(r * ux, r * uy, z), area);
}
float rfl_quarter_atan(float t) {
  float s = t * t, p = (-0.00597563674 * s + 0.0308790214) * s - 0.0757402948;
  p = (((p * s + 0.126232606) * s - 0.178501543) * s + 0.254262416) * s;
  return t * ((p - 0.424396087) * s + 1.27323942);
}
// The inverse of rfl_lift.
vec2 rfl_lower(vec3 wo, vec3 wi) {
  int kind = rfl_kind();
  float sin2 = wi.x * wi.x + wi.y * wi.y, y = kind == 1 ? sin2 / (1.0 + wi.z) : sin2;
  vec3 w = wi;
  if (kind == 4) {
    y = 1.0 - pow(wi.z, 2.0 - rfl_float(5));
  } else if (kind == 2 || kind == 3) {
    vec3 o = vec3(kind == 2 ? wo.x : -wo.x, 0.0, wo.z), m = o - wi;
    w = o + wi;
    if (dot(o, wi) < 0.0) w -= (dot(w, m) / dot(m, m)) * m;
    w = normalize(w);
    float sine = sqrt(max(w.x * w.x + w.y * w.y, RFL_LEAST * RFL_LEAST)), t = sine / max(w.z, 1e-12);
    vec2 s = rfl_star(o.x, wo.z, w.x / sine);
    y = s.x * t / (s.x - (s.y - s.x) * t);
  } else if (kind >= 5) {
    vec2 a = kind == 5 ? wo.xz : vec2(0.0, 1.0), off = vec2(wi.x + a.x, wi.z - a.y);
    w = vec3(-a.y * off.x - a.x * off.y, wi.y, a.y * wi.z - a.x * wi.x);
    float sine = sqrt(max(w.x * w.x + w.y * w.y, RFL_LEAST * RFL_LEAST));
    float t = w.z > 0.0 ? sine / (1.0 + w.z) : (1.0 - w.z) / sine;
    vec3 s = rfl_rim(a.x, a.y, w.x / sine);
    y = s.x * t / (s.x - (s.y - s.x) * t);
  }
  y = clamp(y, 0.0, 1.0);
  float a = abs(w.x), b = abs(w.y);
  float x = a > b ? 1.0 - 0.5 * rfl_quarter_atan(b / a) : b > 0.0 ? 0.5 * rfl_quarter_atan(a / b) : 1.0;
  return vec2(w.x < 0.0 ? -x : x, !rfl_half() && w.y < 0.0 ? -y : y);
}

// ---- Leaves ----

// By an alias table in integers; spare: random bits that are left.
int rfl_choose(int slab, uvec2 bits, out uint spare) {
  uint n = RFL_WORD(slab + 1), m = RFL_WORD(slab + 3), carry, h0, l0, h1, l1;
  umulExtended(bits.x, n, h0, l0);
  umulExtended(bits.y, n, h1, l1);
  uint middle = uaddCarry(l0, h1, carry), bucket = h0 + carry;  // bucket, middle, l1: the product, 96 bits
  umulExtended(middle, m, h0, l0);
  umulExtended(l1, m, h1, l1);
  spare = uaddCarry(l0, h1, carry);
  int leaves = int(RFL_WORD(slab)), leaf = leaves + 5 * int(bucket);
  return h0 + carry < RFL_WORD(leaf) ? leaf : leaves + 5 * int(RFL_WORD(leaf + 2) & 0xffffu);
}
int rfl_byte(uint b) { return int(b & 127u) - int(b & 128u); }
float rfl_slope(uint b) { return float(rfl_byte(b)) * 0.0078125; }
float rfl_power(uint exponent) { return uintBitsToFloat(exponent << 23); }
float rfl_linear(float g, float u) {
  float a = 1.0 - g, b = 1.0 + g;
  return min(2.0 * u / (a + sqrt(a * a + u * (b * b - a * a))), 1.0);
}
float rfl_mix(int slope, uint first, uint second) {
  uint a = first >> 8, b = second >> 8;
  uint other = slope < 0 ? min(a, b) : max(a, b);
  return float(int(first & 127u) < abs(slope) ? other : a) * 5.9604644775390625e-08;
}
// The point at t of [0, 1]^2 across a leaf, and the height there.
vec3 rfl_at(int leaf, vec2 t) {
  uint place = RFL_WORD(leaf + 3), slopes = RFL_WORD(leaf + 4);
  float gx = rfl_slope(slopes), gy = rfl_slope(slopes >> 8);
  float x = float(int(RFL_WORD(leaf + 2) >> 16) - 0x4000) * 6.103515625e-05 + rfl_power(128u - ((place >> 16) & 255u)) * t.x;
  int iy = int(place & 0xffffu);
  float y = rfl_half() ? float(iy) * 3.0517578125e-05 + rfl_power(127u - (place >> 24)) * t.y
                       : float(iy - 0x4000) * 6.103515625e-05 + rfl_power(128u - (place >> 24)) * t.y;
  return vec3(x, y, rfl_float(leaf + 1) * ((1.0 - gx) + 2.0 * gx * t.x) * ((1.0 - gy) + 2.0 * gy * t.y));
}
RflPoint rfl_place(int head, RflViewer v, uvec4 bits, out float height) {
  uint spare;
  int leaf = rfl_choose(rfl_slab_at(head, v), bits.xy, spare);
  uint slopes = RFL_WORD(leaf + 4);
  vec3 at = rfl_at(leaf, vec2(rfl_mix(rfl_byte(slopes), bits.z, spare),
                              rfl_linear(rfl_slope(slopes >> 8), float(bits.w >> 8) * 5.9604644775390625e-08)));
  height = at.z;
  return rfl_lift(v.wo, vec2(at.x, rfl_half() && (bits.w & 1u) != 0u ? -at.y : at.y));
}

// ---- One-shot mode ----

RflDraw rfl_finish(RflViewer v, RflPoint p, float height) {
  return RflDraw(rfl_outward(v, p.wi), height / p.area * p.wi.z, p.area / height);
}
RflDraw rfl_one_shot(RflViewer v, uvec4 bits) {
  float height;
  RflPoint p = rfl_place(RFL_ONE_SHOT, v, bits, height);
  return rfl_finish(v, p, height);
}
// From two uniforms of [0, 1), monotone.
RflDraw rfl_one_shot_uniforms(RflViewer v, vec2 u) {
  int slab = rfl_slab_at(RFL_ONE_SHOT, v), leaf = int(RFL_WORD(slab)), node = int(RFL_WORD(slab + 2));
  uint left = RFL_WORD(slab + 1);
  bool below = rfl_half() && u.y < 0.5;
  if (rfl_half()) u.y = below ? 1.0 - 2.0 * u.y : 2.0 * u.y - 1.0;
  while (left > 1u) {  // what is left of the uniforms of [0, 1) is stretched: floats keep their digits
    uint word = RFL_WORD(node + 1), lower_leaves = word & 0x7fffffffu;
    bool along_x = (word >> 31) != 0u;
    float lower = rfl_float(node), at = along_x ? u.x : u.y;
    bool up = at >= lower;
    at = up ? (at - lower) / (1.0 - lower) : at / lower;
    if (along_x) u.x = at; else u.y = at;
    left = up ? left - lower_leaves : lower_leaves;
    leaf += up ? 5 * int(lower_leaves) : 0;
    node += up ? 2 * int(lower_leaves) : 2;
  }
  uint slopes = RFL_WORD(leaf + 4);
  vec3 at = rfl_at(leaf, vec2(rfl_linear(rfl_slope(slopes), min(u.x, 1.0)), rfl_linear(rfl_slope(slopes >> 8), min(u.y, 1.0))));
  return rfl_finish(v, rfl_lift(v.wo, vec2(at.x, below ? -at.y : at.y)), at.z);
}
// Per solid angle; u: the uniforms that lead to wi.
float rfl_one_shot_invert(RflViewer v, vec3 wi, out vec2 u) {
  int slab = rfl_slab_at(RFL_ONE_SHOT, v), leaf = int(RFL_WORD(slab)), node = int(RFL_WORD(slab + 2));
  uint left = RFL_WORD(slab + 1);
  vec3 w = rfl_inward(v, wi);
  bool below = rfl_half() && w.y < 0.0;
  vec2 start = vec2(-1.0, rfl_half() ? 0.0 : -1.0), size = vec2(2.0, rfl_half() ? 1.0 : 2.0), lo = vec2(0.0), share = vec2(1.0);
  u = vec2(-1.0);
  if (!(wi.z > 0.0)) return 0.0;
  if (rfl_half()) w.y = abs(w.y);
  vec2 p = rfl_lower(v.wo, w);
  RflPoint at = rfl_lift(v.wo, p);
  while (left > 1u) {
    uint word = RFL_WORD(node + 1), lower_leaves = word & 0x7fffffffu;
    vec2 axis = (word >> 31) != 0u ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
    float lower = rfl_float(node);
    size *= 1.0 - 0.5 * axis;
    if (dot(p, axis) < dot(start + size, axis)) {
      share *= mix(vec2(1.0), vec2(lower), axis);
      left = lower_leaves;
      node += 2;
    } else {
      start += size * axis;
      lo += share * lower * axis;
      share *= mix(vec2(1.0), vec2(1.0 - lower), axis);
      left -= lower_leaves;
      leaf += 5 * int(lower_leaves);
      node += 2 * int(lower_leaves);
    }
  }
  vec2 t = clamp((p - start) / size, 0.0, 1.0), g = vec2(rfl_slope(RFL_WORD(leaf + 4)), rfl_slope(RFL_WORD(leaf + 4) >> 8));
  u = lo + share * t * (1.0 - g * (1.0 - t));
  if (rfl_half()) u.y = below ? 0.5 * (1.0 - u.y) : 0.5 * (1.0 + u.y);
  return rfl_at(leaf, t).z * at.wi.z / at.area;
}
float rfl_one_shot_pdf(RflViewer v, vec3 wi) {
  vec2 u;
  return rfl_one_shot_invert(v, wi, u);
}

// ---- Exact mode ----

// The scalar that is sampled, of RGB values. (Of one channel it is rfl_float(8) * f.)
float rfl_target(vec3 f) {
  uint kind = RFL_WORD(6);
  float scale = rfl_float(8), norm = length(scale * f), t;
  if (kind == 0u) return norm;
  t = kind == 1u ? dot(f, vec3(0.2126, 0.7152, 0.0722)) : kind == 2u ? max(max(f.x, f.y), f.z) : f[min(int(RFL_WORD(7)), 2)];
  return 0.99 * (scale * t) + 0.01 * norm;
}
RflCandidate rfl_propose(RflViewer v, uvec4 bits) {
  RflCandidate c;
  RflPoint p = rfl_place(RFL_EXACT, v, bits, c.majorant);
  c.wi = rfl_outward(v, p.wi);
  c.cos_i = p.wi.z;
  c.area = p.area;
  return c;
}
bool rfl_accept(RflViewer v, RflCandidate c, float target, uint bits, out RflDraw d) {
  d = RflDraw(c.wi, target * c.cos_i / v.albedo, v.albedo / target);
  return float(bits) * 2.3283064365386963e-10 * (c.majorant * v.albedo) < target * c.area;
}
float rfl_exact_pdf(RflViewer v, vec3 wi, float target) { return target / v.albedo * max(wi.z, 0.0); }
