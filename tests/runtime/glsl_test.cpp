// SPDX-License-Identifier: Apache-2.0
// The GLSL runtime in a compute shader, on whatever OpenGL ES 3.1 there is without a window; under Mesa that
// is its software driver. Draws agree with the C runtime from the same bits, and chi-square judges their
// density.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl31.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree_load.h"

namespace reflectree {
namespace {

// A context of OpenGL ES 3.1 without a surface; `missing` says why there is none.
struct Context {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string missing;

  Context() {
    const auto get =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!get || !extensions || !std::strstr(extensions, "EGL_MESA_platform_surfaceless")) {
      missing = "EGL has no surfaceless platform (Debian: libegl-mesa0 libgl1-mesa-dri)";
      return;
    }
    display = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
      missing = "EGL does not start";
      return;
    }
    eglBindAPI(EGL_OPENGL_ES_API);
    const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 1, EGL_NONE};
    context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
      missing = "no OpenGL ES 3.1";
  }
  Context(const Context&) = delete;
  ~Context() {
    if (context != EGL_NO_CONTEXT) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display, context);
    }
    if (display != EGL_NO_DISPLAY) eglTerminate(display);
  }
};

std::string runtime_text() {
  std::ifstream file(REFLECTREE_RUNTIME "/reflectree_sample.glsl");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_GT(text.str().size(), 1000U);
  return text.str();
}

// A function here and its text there.
struct Material {
  Rgb (*f)(Direction, Direction);
  const char* text;
};

// A matt ground and a lobe about the half vector.
Rgb glossy_value(Direction wo, Direction wi) {
  const float lobe = 2 * pow(normalize(wo + wi).z, 40.f);
  return {0.1f + lobe, 0.05f + lobe, 0.02f + 0.5f * lobe};
}
const Material glossy{glossy_value,
                      "vec3 f(vec3 wo, vec3 wi) { float lobe = 2.0 * pow(normalize(wo + wi).z, 40.0);\n"
                      "  return vec3(0.1 + lobe, 0.05 + lobe, 0.02 + 0.5 * lobe); }\n"};
// A ground that leans and an elliptic lobe: without any symmetry.
Rgb brushed_value(Direction wo, Direction wi) {
  const Direction h = normalize(wo + wi);
  const float x = (h.x + 0.5f * h.y) / (0.2f * h.z), y = (h.y - 0.5f * h.x) / (0.5f * h.z);
  const float lobe = std::exp(-(x * x + y * y)), ground = 0.1f + 0.05f * wi.x;
  return {ground + lobe, ground + 0.5f * lobe, ground};
}
const Material brushed{brushed_value,
                       "vec3 f(vec3 wo, vec3 wi) { vec3 h = normalize(wo + wi);\n"
                       "  float x = (h.x + 0.5 * h.y) / (0.2 * h.z), y = (h.y - 0.5 * h.x) / (0.5 * h.z);\n"
                       "  float lobe = exp(-(x * x + y * y)), ground = 0.1 + 0.05 * wi.x;\n"
                       "  return vec3(ground + lobe, ground + 0.5 * lobe, ground); }\n"};
// Hash Functions for GPU Rendering (Jarzynski and Olano 2020), pcg4d.
constexpr const char* hash_text =
    "uvec4 words_of(uvec4 v) { v = v * 1664525u + 1013904223u;\n"
    "  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z; v ^= v >> 16;\n"
    "  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z; return v; }\n";

// A compute shader over `count` items: what `body` writes to results[i], 8 floats, i < count.
class Shader {
 public:
  explicit Shader(const std::string& body, const Material& material = glossy,
                  const std::string& words_text = "") {
    const bool constant = !words_text.empty();
    const std::string text =
        "#version 310 es\nprecision highp float;\nprecision highp int;\nlayout(local_size_x = 64) in;\n" +
        (constant ? words_text
                  : std::string("layout(std430, binding = 0) readonly buffer Words { uint words[]; };\n"
                                "#define RFL_WORD(i) words[i]\n")) +
        "layout(std430, binding = 1) buffer Results { float results[]; };\n"
        "uniform vec3 wo; uniform uint count, seed;\n" +
        runtime_text() + material.text + hash_text +
        "void main() {\n  uint i = gl_GlobalInvocationID.x;\n  if (i >= count) return;\n" +
        "  RflViewer v; RflDraw d = RflDraw(vec3(0.0), 0.0, 0.0); vec2 u = vec2(0.0); float pdf = 0.0;\n" +
        "  uvec4 bits = words_of(uvec4(i, seed, 1u, 2u));\n" + body +
        "  float row[8] = float[8](d.wi.x, d.wi.y, d.wi.z, d.pdf, d.scale, u.x, u.y, pdf);\n"
        "  for (uint k = 0u; k < 8u; ++k) results[8u * i + k] = row[k];\n}\n";
    const char* source = text.c_str();
    const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    char log[4096] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    program_ = glCreateProgram();
    glAttachShader(program_, shader);
    glLinkProgram(program_);
    GLint linked = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &linked);
    if (!linked) ADD_FAILURE() << "the shader does not compile: " << log;
    glDeleteShader(shader);
  }
  Shader(const Shader&) = delete;
  ~Shader() { glDeleteProgram(program_); }

  std::vector<float> run(const rfl_sampler& s, Direction wo, std::uint32_t seed, std::uint32_t count) const {
    GLuint buffers[2];
    glGenBuffers(2, buffers);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(4 * std::size_t(s.words[2])), s.words, GL_STATIC_DRAW);
    std::vector<float> results(8 * std::size_t(count));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[1]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(4 * results.size()), nullptr, GL_DYNAMIC_READ);
    glUseProgram(program_);
    glUniform3f(glGetUniformLocation(program_, "wo"), wo.x, wo.y, wo.z);
    glUniform1ui(glGetUniformLocation(program_, "count"), count);
    glUniform1ui(glGetUniformLocation(program_, "seed"), seed);
    glDispatchCompute((count + 63) / 64, 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    const void* mapped =
        glMapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(4 * results.size()), GL_MAP_READ_BIT);
    if (mapped) std::memcpy(results.data(), mapped, 4 * results.size());
    EXPECT_NE(mapped, nullptr);
    glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
    glDeleteBuffers(2, buffers);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    return results;
  }

 private:
  GLuint program_ = 0;
};

constexpr const char* one_shot_body =
    "  if (rfl_view(wo, v)) { d = rfl_one_shot(v, bits); pdf = rfl_one_shot_invert(v, d.wi, u); }\n";
constexpr const char* uniforms_body =
    "  if (rfl_view(wo, v)) { u = vec2(bits.xy >> 8) * 5.9604644775390625e-08;\n"
    "    d = rfl_one_shot_uniforms(v, u); pdf = rfl_one_shot_pdf(v, d.wi); }\n";
// `bend` multiplies the target: 1.0, or the twin's fault.
std::string exact_body(const std::string& bend) {
  return "  if (rfl_view(wo, v)) for (int trial = 0; trial < RFL_MAX_TRIALS; ++trial) {\n"
         "    bits = words_of(bits + uvec4(i, seed, uint(trial), 7u));\n"
         "    RflCandidate c = rfl_propose(v, bits); RflDraw e;\n"
         "    float t = rfl_target(f(wo, c.wi));\n"
         "    if (rfl_accept(v, c, t * (" +
         bend +
         "), words_of(bits.wzyx).x, e)) {\n"
         "      d = e; pdf = rfl_exact_pdf(v, d.wi, t); break; } }\n";
}

struct Glsl : testing::Test {
  static Context& context() {
    static Context made;
    return made;
  }
  void SetUp() override {
    if (!context().missing.empty()) GTEST_SKIP() << "skipped: " << context().missing;
    std::printf("renderer: %s\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  }
};

struct Loaded {
  SamplerData data;
  rfl_sampler s{};
  explicit Loaded(const BuildOptions& options = {}, const Material& material = glossy)
      : Loaded(build(AnyBrdf(material.f), options)) {}
  explicit Loaded(const SamplerData& built) : data(built) {
    const Bytes bytes = encode_sampler(data);
    const char* error = rfl_load_bytes(&s, bytes.data(), bytes.size());
    if (error) ADD_FAILURE() << error;
  }
  Loaded(const Loaded&) = delete;
  ~Loaded() { rfl_free(&s); }
};

// What the shader's hash gives for an item.
std::array<std::uint32_t, 4> words_of(std::array<std::uint32_t, 4> v) {
  for (std::uint32_t& x : v) x = x * 1664525U + 1013904223U;
  const auto mix = [&v] {
    v[0] += v[1] * v[3], v[1] += v[2] * v[0], v[2] += v[0] * v[1], v[3] += v[1] * v[2];
  };
  mix();
  for (std::uint32_t& x : v) x ^= x >> 16U;
  mix();
  return v;
}

Direction wo_at(double theta_deg, double phi_deg = 53.13) {
  const double degree = pi_v<double> / 180, theta = theta_deg * degree, phi = phi_deg * degree;
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

// Draws, densities and inverses of both ways in are those of C from the same words.
void expect_agreement(const Loaded& loaded, Direction wo, const std::string& where) {
  const Shader by_bits(one_shot_body), by_uniforms(uniforms_body);
  constexpr std::uint32_t count = 20000;
  rfl_viewer v;
  ASSERT_TRUE(rfl_view(&loaded.s, {wo.x, wo.y, wo.z}, &v));
  for (const Shader* shader : {&by_bits, &by_uniforms}) {
    const std::vector<float> rows = shader->run(loaded.s, wo, 5, count);
    std::uint32_t far = 0, other_pdf = 0, other_inverse = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto bits = words_of({i, 5, 1, 2});
      const float* row = &rows[8 * std::size_t(i)];
      const float u1 = to_unit_float(bits[0]), u2 = to_unit_float(bits[1]);
      rfl_draw d{};
      if (shader == &by_bits) {
        rfl_one_shot(&loaded.s, &v, bits.data(), &d);
      } else {
        rfl_one_shot_uniforms(&loaded.s, &v, double(u1), double(u2), &d);
      }
      const float off = abs(row[0] - d.wi.x) + abs(row[1] - d.wi.y) + abs(row[2] - d.wi.z);
      far += !(off < 2e-4f && abs(row[3] / d.pdf - 1) < 1e-2f && abs(row[4] / d.scale - 1) < 1e-2f);
      double u[2] = {};
      const float pdf = rfl_one_shot_invert(&loaded.s, &v, d.wi, u);
      other_pdf += !(abs(row[7] / pdf - 1) < 1e-2f);
      const float v1 = shader == &by_bits ? float(u[0]) : u1, v2 = shader == &by_bits ? float(u[1]) : u2;
      other_inverse += !(abs(row[5] - v1) + abs(row[6] - v2) < 2e-3f);
    }
    // A direction on the border of two leaves may fall into the other one.
    EXPECT_LT(far, count / 200) << where;
    EXPECT_LT(other_pdf, count / 50) << where;
    EXPECT_LT(other_inverse, count / 50) << where;
  }
}

TEST_F(Glsl, AgreesWithCInEveryDomain) {
  for (int kind = 0; kind <= int(DomainKind::normal_vector); ++kind) {
    for (const Symmetry symmetry : {Symmetry::mirror, Symmetry::none}) {
      BuildOptions options;
      options.domain = Domain{DomainKind(kind), symmetry, kind == int(DomainKind::stretched) ? 1.3f : 0};
      options.expected_trials = 3, options.one_shot_variance = 0.3f;
      const Loaded loaded(options);
      for (const double theta : {0., 50., 80.})
        expect_agreement(loaded, wo_at(theta), name_of(DomainKind(kind)) + (" " + std::to_string(theta)));
    }
  }
}

TEST_F(Glsl, AgreesWithCForAnisotropicFunctions) {
  const Material even{
      [](Direction wo, Direction wi) { return to_rgb(0.2f + 0.1f * sqr(wi.x) + 0.05f * sqr(wo.y)); }, ""};
  const Material leaning{[](Direction, Direction wi) { return to_rgb(0.2f + 0.15f * wi.x); }, ""};
  const Material turned{[](Direction wo, Direction wi) { return to_rgb(0.2f + 0.1f * wo.x * wi.y); }, ""};
  std::set<ViewerSymmetry> symmetries;
  for (const Material& material : {even, leaning, turned, brushed}) {
    BuildOptions options;
    options.domain = Domain{DomainKind::half_vector, Symmetry::none};
    options.expected_trials = 4, options.one_shot_variance = 1, options.albedo_error = 3e-2f;
    SamplerData data = build(AnyBrdf(material.f), options);
    symmetries.insert(data.frame.symmetry);
    for (const DomainKind kind : {DomainKind::half_vector, DomainKind::slope_star}) {
      data.domain.kind = kind,
      data.domain.stretch = 0.7f;  // what is drawn follows nothing, but must be the same
      const Loaded loaded(data);
      for (const double phi : {20., 130., 200., 310.})
        expect_agreement(loaded, wo_at(50, phi), name_of(kind) + (" " + std::to_string(phi)));
    }
  }
  EXPECT_EQ(symmetries.size(), 4U);
}

// Draws of a shader as a sampler that is asked one by one.
ErasedSampler drawn_by(const Shader& shader, const rfl_sampler& s, const Material& material) {
  struct Queue {
    std::vector<float> rows;
    std::size_t next = 0;
    std::uint32_t seed = 1;
  };
  const auto queue = std::make_shared<Queue>();
  ErasedSampler sampler;
  sampler.name = "GLSL", sampler.concurrent = false;
  sampler.sample = [queue, &shader, &s, &material](Direction wo, Pcg32&, DrawnDirection& out) {
    if (queue->next == queue->rows.size())
      queue->rows = shader.run(s, wo, queue->seed++, 1U << 16U), queue->next = 0;
    const float* row = &queue->rows[queue->next];
    queue->next += 8;
    out.wi = {row[0], row[1], row[2]};
    out.pdf = row[3];
    out.weight = row[4] * Target{}(material.f(wo, out.wi));
    return row[3] > 0;
  };
  return sampler;
}

// The density passes and its planted faults do not, for viewers at each elevation.
void judge(const Loaded& loaded, const Material& material, double phi_deg) {
  const TargetFunction target = target_function(AnyBrdf(material.f));
  const Shader exact(exact_body("1.0"), material), one_shot(one_shot_body, material),
      uniforms(uniforms_body, material);
  const Shader bent_exact(exact_body("c.wi.x > 0.0 ? 1.02 : 0.98"), material);
  const Shader bent_one_shot("  bits.x = min(bits.x, bits.x * 2u) ;\n" + std::string(one_shot_body),
                             material);
  ChiSquareOptions options;
  options.samples = 1 << 20;
  options.tests = 12;
  for (const double theta : {5., 45., 75., 86.}) {
    const Direction wo = wo_at(theta, phi_deg);
    const Bins bins = equal_mass_bins(target, wo);
    const auto tally = [&](const Shader& shader) {
      return tally_of(drawn_by(shader, loaded.s, material), bins, options);
    };
    const Tally drawn = tally(exact);
    const CheckResult counts = check_counts(drawn, bins, options);
    EXPECT_TRUE(counts.passed) << theta << ' ' << to_line(counts);
    EXPECT_FALSE(check_counts(tally(bent_exact), bins, options).passed) << theta;
    for (const Shader* shader : {&one_shot, &uniforms}) {
      const Tally weighted = tally(*shader);
      const CheckResult weights = check_weights(weighted, bins, options);
      const CheckResult mean = check_mean_weight(weighted, bins, options);
      EXPECT_TRUE(weights.passed) << theta << ' ' << to_line(weights);
      EXPECT_TRUE(mean.passed) << theta << ' ' << to_line(mean);
    }
    EXPECT_FALSE(check_weights(tally(bent_one_shot), bins, options).passed) << theta;
  }
}

TEST_F(Glsl, ChiSquarePassesAndItsTwinsDoNot) { judge(Loaded(), glossy, 53.13); }

TEST_F(Glsl, ChiSquarePassesForAnAnisotropicFunctionAndItsTwinsDoNot) {
  BuildOptions options;
  options.expected_trials = 1.5f, options.one_shot_variance = 0.05f, options.albedo_error = 1e-3f;
  const Loaded loaded(options, brushed);
  EXPECT_EQ(loaded.data.frame.symmetry, ViewerSymmetry::none);
  judge(loaded, brushed, 200);
}

// The array as a constant of the shader, as `reflectree export --glsl` writes it.
TEST_F(Glsl, TheArrayMayBeAConstant) {
  const Loaded loaded;
  const std::uint32_t n = loaded.s.words[2];
  std::string text = "const uint rfl_words[" + std::to_string(n) + "] = uint[" + std::to_string(n) + "](\n";
  for (std::uint32_t i = 0; i < n; ++i) text += (i ? "," : "") + std::to_string(loaded.s.words[i]) + "u";
  text += ");\n#define RFL_WORD(i) rfl_words[i]\n";
  const Shader constant(one_shot_body, glossy, text), buffer(one_shot_body);
  EXPECT_EQ(constant.run(loaded.s, wo_at(40), 3, 4096), buffer.run(loaded.s, wo_at(40), 3, 4096));
}

}  // namespace
}  // namespace reflectree
