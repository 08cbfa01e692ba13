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
const int RFL_PROJECTED_DISK = 0, RFL_EQUAL_AREA = 1, RFL_HALF_VECTOR = 2, RFL_BACK_VECTOR = 3, RFL_STRETCHED = 4,
  RFL_MIRROR_VECTOR = 5, RFL_NORMAL_VECTOR = 6, RFL_SLOPE_STAR = 7;
const uint RFL_ISOTROPIC = 0u, RFL_TWO_PLANES = 1u, RFL_ONE_PLANE = 2u, RFL_HALF_TURN = 3u;

struct RflViewer { vec3 known, axis; float cos_phi, sin_phi, side, phi, azimuth, albedo; };
struct RflDraw { vec3 wi; float pdf, scale; };
struct RflCandidate { vec3 wi; float cos_i, area, majorant; };
struct RflPoint { vec3 wi; float area; };

float rfl_float(int i) { return uintBitsToFloat(RFL_WORD(i)); }
int rfl_kind() { return int(RFL_WORD(3)); }
bool rfl_half() { return RFL_WORD(4) != 0u; }
float rfl_shape() { return rfl_float(5); }
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
// Ascends with the azimuth, to 4, and takes no arctangent.
float rfl_azimuth(uint symmetry, vec2 w) {
  float q = abs(w.y) / max(abs(w.x) + abs(w.y), 1e-37), upper = w.x < 0.0 ? 2.0 - q : q;
  return symmetry == RFL_TWO_PLANES ? q : w.y < 0.0 ? 4.0 - upper : upper;
}
// Linear in the cosine; over the azimuth the cubic through four rows.
float rfl_albedo(float c, float phi) {
  int p = int(RFL_WORD(RFL_ALBEDO + 3)) + 2 * rfl_find(RFL_ALBEDO, c);
  if (RFL_WORD(21) == RFL_ISOTROPIC) return rfl_float(p) + rfl_float(p + 1) * c;
  int g = int(RFL_WORD(23)), pieces = int(RFL_WORD(24));
  while (rfl_float(g + 4) <= phi) g += 4;
  float x = max((phi - rfl_float(g)) * rfl_float(g + 1), 0.0);
  int k = min(int(x), int(RFL_WORD(g + 3)));
  float t = x - float(k), a = t + 1.0, b = t - 1.0, d = t - 2.0, sum = 0.0;
  vec4 weights = vec4(-t * b * d / 6.0, a * b * d / 2.0, -a * t * d / 2.0, a * t * b / 6.0);
  p += 2 * (int(RFL_WORD(g + 2)) + k) * pieces;
  for (int i = 0; i < 4; ++i, p += 2 * pieces) sum += weights[i] * (rfl_float(p) + rfl_float(p + 1) * c);
  return max(sum, 0.0);
}
// false is "no sample": wo at or below the horizon, not of unit length, or albedo 0. Symmetries fold wo.
bool rfl_view(vec3 wo, out RflViewer v) {
  float sine = sqrt(wo.x * wo.x + wo.y * wo.y), inverse = sine > 0.0 ? 1.0 / sine : 0.0, c = min(wo.z, 1.0);
  vec2 turn = vec2(rfl_float(25), rfl_float(26)), inner = vec2(1.0, 0.0);
  vec2 w = vec2(wo.x * turn.x + wo.y * turn.y, wo.y * turn.x - wo.x * turn.y);
  uint symmetry = RFL_WORD(21);
  v = RflViewer(wo, vec3(0.0), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
  if (!(wo.z >= RFL_MIN_COS && abs(dot(wo, wo) - 1.0) <= 1e-3)) return false;
  if (symmetry != RFL_ISOTROPIC) {
    if ((symmetry == RFL_TWO_PLANES && w.x < 0.0) || (symmetry == RFL_HALF_TURN && w.y < 0.0)) {
      w = -w;
      turn = -turn;
    }
    if (symmetry <= RFL_ONE_PLANE && w.y < 0.0) {
      w.y = -w.y;
      v.side = -1.0;
    }
    v.phi = sine > 0.0 ? atan(w.y, w.x) : 0.0;
    if (v.phi < 0.0) v.phi += 2.0 * RFL_PI;
    v.azimuth = rfl_azimuth(symmetry, w);
  }
  v.axis = vec3(w, c);
  if (RFL_WORD(22) != 0u) {
    inner = vec2(sine > 0.0 ? w.x * inverse : 1.0, v.side * (w.y * inverse));
    v.axis = vec3(sine, 0.0, c);
  }
  if (rfl_kind() == RFL_BACK_VECTOR) v.axis.x = -sine;
  if (rfl_kind() == RFL_NORMAL_VECTOR) v.axis = vec3(0.0, 0.0, 1.0);
  v.cos_phi = turn.x * inner.x - turn.y * inner.y;
  v.sin_phi = turn.y * inner.x + turn.x * inner.y;
  v.albedo = rfl_albedo(c, v.phi);
  return v.albedo > 0.0;
}
int rfl_slab_at(int head, RflViewer v) {
  float c = min(v.known.z, 1.0);
  int table = int(RFL_WORD(head + 3)), at = int(RFL_WORD(head + 2));
  if (RFL_WORD(head) != 0u) return table + 5 * rfl_find(head, c);
  while (at < table)  // a tree over -cos theta_o and rfl_azimuth
    at = int(RFL_WORD((RFL_WORD(at + 3) == 0u ? -c : v.azimuth) >= rfl_float(at) ? at + 2 : at + 1));
  return at;
}
vec3 rfl_outward(RflViewer v, vec3 w) {
  float y = v.side * w.y;
  return vec3(w.x * v.cos_phi - y * v.sin_phi, w.x * v.sin_phi + y * v.cos_phi, w.z);
}
vec3 rfl_inward(RflViewer v, vec3 w) {
  return vec3(w.x * v.cos_phi + w.y * v.sin_phi, v.side * (w.y * v.cos_phi - w.x * v.sin_phi), w.z);
}

// ---- The domain ----

// Along the azimuth u the radius t = y d ends at the rim p / c, with d = p / (p + (c - p) y): p, c and z p / c.
vec3 rfl_rim(vec3 a, vec2 u) {
  int kind = rfl_kind();
  vec2 s = kind == RFL_SLOPE_STAR ? vec2(rfl_shape() * u.x, u.y / rfl_shape()) : vec2(u.x, 0.0);
  float q = kind == RFL_SLOPE_STAR ? dot(s, s) : 1.0, b = dot(s, a.xy), z2 = a.z * a.z;
  float l = sqrt(b * b + q * z2) + abs(b);
  if (kind == RFL_SLOPE_STAR) return vec3(rfl_by_sign(b, l, a.z), rfl_by_sign(b, q * a.z, l), 0.0);
  if (kind == RFL_HALF_VECTOR || kind == RFL_BACK_VECTOR) return vec3(rfl_by_sign(b, l * l, z2), a.z * l, 0.0);
  return vec3(rfl_by_sign(b, a.z, l), rfl_by_sign(b, l, a.z), rfl_by_sign(b, z2 / l, l));
}
RflPoint rfl_lift(vec3 a, vec2 p) {
  float r = abs(p.y), y = max(r, 1e-12), z, h = 0.5 * p.x, q = h * h, q2 = q * q;
  float ux = h * ((3.14159264 - q * 5.16771009) + q2 * ((2.55007766 - q * 0.598292159) + q2 * 0.0776594082));
  float uy = (1.0 - q * 4.93480214) + q2 * ((4.05870916 - q * 1.33521206) + q2 * (0.234937559 - q * 0.0243967166));
  vec2 u = vec2(ux, rfl_by_sign(p.y, uy, -uy));
  int kind = rfl_kind();
  float area = RFL_PI;
  if (kind == RFL_PROJECTED_DISK) {
    z = max(sqrt(1.0 - r), RFL_LEAST);
    r = sqrt(r);
  } else if (kind == RFL_EQUAL_AREA) {
    z = max(1.0 - r, RFL_LEAST);
    r = sqrt(r * (2.0 - r));
    area = 2.0 * RFL_PI * z;
  } else if (kind == RFL_STRETCHED) {
    float power = 1.0 / (2.0 - rfl_shape()), v = max(1.0 - r, 1e-7);
    z = max(pow(v, power), RFL_LEAST);
    r = sqrt(1.0 - z * z);
    area = 2.0 * RFL_PI * power * z * z / v;
  } else {
    vec3 s = rfl_rim(a, u);
    float d = s.x / (s.x + (s.y - s.x) * y), t = y * d;
    if (kind == RFL_MIRROR_VECTOR || kind == RFL_NORMAL_VECTOR) {
      float tt = t * t, inverse = 1.0 / (1.0 + tt);
      z = max(d * (1.0 - y) * (s.z * t + a.z) * inverse, RFL_LEAST);
      vec3 wi = vec3(-(a.x * (1.0 - tt) + 2.0 * t * a.z * u.x) * inverse, 2.0 * t * u.y * inverse, z);
      return RflPoint(wi, z * (8.0 * RFL_PI) * t * (inverse * inverse) * (d * d));
    }
    vec2 n = t * (kind == RFL_SLOPE_STAR ? vec2(rfl_shape() * u.x, u.y / rfl_shape()) : u);  // wh is along (n, 1)
    float won = max(dot(a.xy, n) + a.z, RFL_LEAST), cos2 = 1.0 / (1.0 + dot(n, n)), twice = 2.0 * won * cos2;
    vec3 wi = vec3(twice * n - a.xy, max(twice - a.z, RFL_LEAST));
    return RflPoint(wi, wi.z * (8.0 * RFL_PI) * won * (cos2 * cos2) * (t * d * d));
  }
  return RflPoint(vec3(r * u, z), area);
}
float rfl_quarter_atan(float t) {
  float s = t * t, p = (-0.00597563674 * s + 0.0308790214) * s - 0.0757402948;
  p = (((p * s + 0.126232606) * s - 0.178501543) * s + 0.254262416) * s;
  return t * ((p - 0.424396087) * s + 1.27323942);
}
// The inverse of rfl_lift.
vec2 rfl_lower(vec3 a, vec3 wi) {
  int kind = rfl_kind();
  bool slopes = kind == RFL_SLOPE_STAR;
  float y = wi.x * wi.x + wi.y * wi.y;
  vec3 w = wi;
  if (kind == RFL_EQUAL_AREA) {
    y = y / (1.0 + wi.z);
  } else if (kind == RFL_STRETCHED) {
    y = 1.0 - pow(wi.z, 2.0 - rfl_shape());
  } else if (kind != RFL_PROJECTED_DISK) {
    bool about = kind == RFL_MIRROR_VECTOR || kind == RFL_NORMAL_VECTOR;
    if (about) {
      vec2 off = vec2(wi.x + a.x, wi.z - a.z);
      w = vec3(-a.z * off.x - a.x * off.y, wi.y, a.z * wi.z - a.x * wi.x);
    } else {
      vec3 m = a - wi;
      w = a + wi;
      if (dot(a, wi) < 0.0) w -= (dot(w, m) / dot(m, m)) * m;
      w = normalize(w);
      w.z = max(w.z, 1e-12);
      if (slopes) w.xy = vec2(w.x / (w.z * rfl_shape()), w.y / w.z * rfl_shape());
    }
    float sine = sqrt(max(dot(w.xy, w.xy), RFL_LEAST * RFL_LEAST));
    float t = slopes ? sine : !about ? sine / w.z : w.z > 0.0 ? sine / (1.0 + w.z) : (1.0 - w.z) / sine;
    if (slopes && w.x == 0.0 && w.y == 0.0) w.x = sine;
    vec3 s = rfl_rim(a, w.xy / sine);
    y = s.x * t / (s.x - (s.y - s.x) * t);
  }
  y = clamp(y, 0.0, 1.0);
  float b = abs(w.x), c = abs(w.y);
  float x = b > c ? 1.0 - 0.5 * rfl_quarter_atan(c / b) : c > 0.0 ? 0.5 * rfl_quarter_atan(b / c) : 1.0;
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
  return rfl_lift(v.axis, vec2(at.x, rfl_half() && (bits.w & 1u) != 0u ? -at.y : at.y));
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
  return rfl_finish(v, rfl_lift(v.axis, vec2(at.x, below ? -at.y : at.y)), at.z);
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
  vec2 p = rfl_lower(v.axis, w);
  RflPoint at = rfl_lift(v.axis, p);
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
