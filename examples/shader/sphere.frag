// SPDX-License-Identifier: Apache-2.0
// A fragment shader that path traces a glossy sphere on a chequered floor under a sky. In front of it stand a
// #version, `words` (what `reflectree export` wrote) and runtime/reflectree_sample.glsl; sphere.py does it.
// The sphere's reflectance is a formula below; its directions come from the sampler that was built for it.
//   MODE 0: one-shot    MODE 1: exact, by rejection    MODE 2: uniform directions, for comparison
uniform uint frame;    // another picture of the same scene
uniform uint samples;  // paths per pixel and frame
uniform vec2 size;     // of the picture in pixels
out vec4 radiance;     // mean over the paths, and over their squared luminance

// phong:kd=0.2/0.05/0.02,ks=0.6/0.5/0.4,n=60
vec3 f(vec3 wo, vec3 wi) {
  float lobe = 62.0 / (2.0 * RFL_PI) * pow(max(dot(vec3(-wo.xy, wo.z), wi), 0.0), 60.0);
  return vec3(0.2, 0.05, 0.02) / RFL_PI + lobe * vec3(0.6, 0.5, 0.4);
}

// Hash Functions for GPU Rendering (Jarzynski and Olano 2020), pcg4d.
uvec4 random;
uvec4 next_words() {
  random = random * 1664525u + 1013904223u;
  random.x += random.y * random.w; random.y += random.z * random.x;
  random.z += random.x * random.y; random.w += random.y * random.z;
  random ^= random >> 16;
  random.x += random.y * random.w; random.y += random.z * random.x;
  random.z += random.x * random.y; random.w += random.y * random.z;
  return random;
}
vec2 next_uniforms() { return vec2(next_words().xy >> 8) * 5.9604644775390625e-08; }

// A direction in the sphere's frame, and f cos / pdf.
bool reflect_from(vec3 wo, out vec3 wi, out vec3 weight) {
#if MODE == 2
  vec2 u = next_uniforms();
  float r = sqrt(1.0 - u.x * u.x);
  wi = vec3(r * cos(2.0 * RFL_PI * u.y), r * sin(2.0 * RFL_PI * u.y), u.x);
  weight = f(wo, wi) * wi.z * 2.0 * RFL_PI;
  return true;
#else
  RflViewer v;
  RflDraw d;
  if (!rfl_view(wo, v)) return false;
#if MODE == 0
  d = rfl_one_shot(v, next_words());
#else
  bool drawn = false;
  for (int trial = 0; trial < RFL_MAX_TRIALS && !drawn; ++trial) {
    RflCandidate c = rfl_propose(v, next_words());
    drawn = rfl_accept(v, c, rfl_target(f(wo, c.wi)), next_words().x, d);
  }
  if (!drawn) return false;
#endif
  wi = d.wi;
  weight = d.scale * f(wo, wi);
  return true;
#endif
}

vec3 sky(vec3 w) {
  vec3 blue = mix(vec3(0.9, 0.95, 1.0), vec3(0.2, 0.4, 0.9), sqrt(max(w.y, 0.0)));
  float sun = smoothstep(0.90, 0.97, dot(w, normalize(vec3(0.6, 0.7, 0.5))));
  return blue + sun * vec3(12.0, 10.0, 7.0);
}

// The frame of a normal (Duff et al. 2017).
mat3 frame_of(vec3 n) {
  float s = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
  return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

vec3 path(vec3 origin, vec3 w) {
  vec3 throughput = vec3(1.0);
  for (int bounce = 0; bounce < 5; ++bounce) {
    // The unit sphere about (0, 1, 0), and the floor y = 0.
    vec3 o = origin - vec3(0.0, 1.0, 0.0);
    float b = dot(o, w), inside = b * b - dot(o, o) + 1.0;
    float sphere = inside > 0.0 ? -b - sqrt(inside) : -1.0, floor_at = -origin.y / w.y;
    bool on_sphere = sphere > 1e-3, on_floor = !on_sphere && w.y < 0.0 && floor_at > 1e-3;
    if (!on_sphere && !on_floor) return throughput * sky(w);
    origin += (on_sphere ? sphere : floor_at) * w;
    vec3 wi, weight;
    mat3 axes = frame_of(on_sphere ? normalize(origin - vec3(0.0, 1.0, 0.0)) : vec3(0.0, 1.0, 0.0));
    if (on_sphere) {
      if (!reflect_from(-w * axes, wi, weight)) return vec3(0.0);
    } else {
      vec2 u = next_uniforms();
      wi = vec3(sqrt(u.x) * cos(2.0 * RFL_PI * u.y), sqrt(u.x) * sin(2.0 * RFL_PI * u.y), sqrt(1.0 - u.x));
      bool dark = (int(floor(origin.x)) + int(floor(origin.z)) & 1) == 0;
      weight = vec3(dark ? 0.15 : 0.6);
    }
    throughput *= weight;
    w = axes * wi;
  }
  return vec3(0.0);
}

void main() {
  random = uvec4(gl_FragCoord.xy, frame, 9u);
  vec3 sum = vec3(0.0);
  float squares = 0.0;
  for (uint k = 0u; k < samples; ++k) {
    vec2 at = (2.0 * (gl_FragCoord.xy + next_uniforms() - 0.5) - size) / size.y;
    vec3 light = path(vec3(0.0, 1.6, 4.2), normalize(vec3(0.5 * at.x, 0.5 * at.y - 0.16, -1.0)));
    sum += light;
    squares += pow(dot(light, vec3(0.2126, 0.7152, 0.0722)), 2.0);
  }
  radiance = vec4(sum, squares) / float(samples);
}
