// SPDX-License-Identifier: Apache-2.0
// The runtime of one file beside the C++ samplers: nanoseconds of this thread per call, medians of repeats that
// alternate in one run, and their ratio. Both sides draw the same directions from the same words, evaluate the
// same function from directions, and must agree in the sum of all that they return. The last column: the C++
// samplers of the model itself, which are given the half vector and the frame of the viewer.
//
//   bench_runtime [CALLS] [REPEATS] [WORD OF A NAME] [cpp|c]     e.g. for a profiler: 1000000 1 exact c
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/study/thread_time.hpp"
#include "reflectree_load.h"

namespace {

using namespace reflectree;

struct Function {
  Ggx ggx;
  Rgb operator()(Direction wo, Direction wi) const { return ggx(shading_geometry(wo, wi)); }
};

struct Subject {
  std::string name;
  Function f;
  Sampler<Function> ours;
  Sampler<Ggx> native;
  rfl_sampler theirs{};
  std::vector<Direction> wo, wi;  // wi: drawn for its wo

  Subject(std::string called, Ggx ggx)
      : Subject(std::move(called), ggx, build(AnyBrdf(ggx), BuildOptions{})) {}
  Subject(std::string called, Ggx ggx, const SamplerData& data)
      : name(std::move(called)), f{ggx}, ours(make_sampler(f, data)), native(make_sampler(ggx, data)) {
    const Bytes bytes = encode_sampler(data);
    if (const char* error = rfl_load_bytes(&theirs, bytes.data(), bytes.size())) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error);
      std::exit(1);
    }
    Pcg32 u(2008);
    while (wo.size() < 4096) {
      const float r = sqrt(to_unit_float(u())), phi = 2 * pi * to_unit_float(u());
      const Direction w{r * cos(phi), r * sin(phi), sqrt(max(1 - r * r, 0.f))};
      const auto drawn = ours.one_shot.sample(w, u);
      if (!(w.z > 1e-3f) || !drawn) continue;
      wo.push_back(w), wi.push_back(drawn->wi);
    }
  }
  Subject(const Subject&) = delete;
  ~Subject() { rfl_free(&theirs); }
};

rfl_vec vec(Direction w) { return {w.x, w.y, w.z}; }
Rgb value(const Subject& s, Direction wo, rfl_vec wi) { return s.f(wo, {wi.x, wi.y, wi.z}); }

float sum_of(Direction wi, float pdf, Rgb weight) {
  return wi.x + wi.y + wi.z + pdf + weight.r + weight.g + weight.b;
}
float sum_of(const std::optional<DirectionSample<Rgb>>& s) {
  return s ? sum_of(s->wi, s->pdf, s->weight) : 0.f;
}
float sum_of(const rfl_draw& d, Rgb f) {
  return sum_of({d.wi.x, d.wi.y, d.wi.z}, d.pdf, scaled_value(f, d.scale));
}

struct FourWords {
  std::uint32_t words[4];
  explicit FourWords(Pcg32& u) {
    for (std::uint32_t& w : words) w = u();
  }
};

// What is measured: one call of either side, for pair i of the pool.
using Call = float (*)(const Subject&, std::size_t i, Pcg32&);

template <auto Member>
float alias(const Subject& s, std::size_t i, Pcg32& u) {
  return sum_of((s.*Member).one_shot.sample(s.wo[i], u));
}
template <auto Member>
float alias_without_f(const Subject& s, std::size_t i, Pcg32& u) {
  const auto p = (s.*Member).one_shot.propose(s.wo[i], u);
  return p ? p->wi.x + p->wi.y + p->wi.z + p->pdf + p->scale : 0.f;
}
template <auto Member>
float uniforms(const Subject& s, std::size_t i, Pcg32& u) {
  const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
  return sum_of((s.*Member).one_shot.sample(s.wo[i], u1, u2));
}
template <auto Member>
float pdf(const Subject& s, std::size_t i, Pcg32&) {
  return (s.*Member).one_shot.pdf(s.wo[i], s.wi[i]);
}
template <auto Member>
float inverse(const Subject& s, std::size_t i, Pcg32&) {
  const auto at = (s.*Member).one_shot.invert(s.wo[i], s.wi[i]);
  return at ? float(at->x) + float(at->y) : 0.f;
}
template <auto Member>
float exact(const Subject& s, std::size_t i, Pcg32& u) {
  return sum_of((s.*Member).exact.sample(s.wo[i], u));
}

float c_alias(const Subject& s, std::size_t i, Pcg32& u) {
  rfl_viewer v;
  rfl_draw d;
  if (!rfl_view(&s.theirs, vec(s.wo[i]), &v)) return 0;
  rfl_one_shot(&s.theirs, &v, FourWords(u).words, &d);
  return sum_of(d, value(s, s.wo[i], d.wi));
}
float c_alias_without_f(const Subject& s, std::size_t i, Pcg32& u) {
  rfl_viewer v;
  rfl_draw d;
  if (!rfl_view(&s.theirs, vec(s.wo[i]), &v)) return 0;
  rfl_one_shot(&s.theirs, &v, FourWords(u).words, &d);
  return d.wi.x + d.wi.y + d.wi.z + d.pdf + d.scale;
}
float c_uniforms(const Subject& s, std::size_t i, Pcg32& u) {
  const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
  rfl_viewer v;
  rfl_draw d;
  if (!rfl_view(&s.theirs, vec(s.wo[i]), &v) || !rfl_one_shot_uniforms(&s.theirs, &v, u1, u2, &d)) return 0;
  return sum_of(d, value(s, s.wo[i], d.wi));
}
float c_pdf(const Subject& s, std::size_t i, Pcg32&) {
  rfl_viewer v;
  return rfl_view(&s.theirs, vec(s.wo[i]), &v) ? rfl_one_shot_pdf(&s.theirs, &v, vec(s.wi[i])) : 0;
}
float c_inverse(const Subject& s, std::size_t i, Pcg32&) {
  rfl_viewer v;
  double at[2] = {0, 0};
  if (rfl_view(&s.theirs, vec(s.wo[i]), &v)) rfl_one_shot_invert(&s.theirs, &v, vec(s.wi[i]), at);
  return float(at[0]) + float(at[1]);
}
float c_exact(const Subject& s, std::size_t i, Pcg32& u) {
  rfl_viewer v;
  rfl_draw d;
  if (!rfl_view(&s.theirs, vec(s.wo[i]), &v)) return 0;
  for (int trial = 0; trial < RFL_MAX_TRIALS; ++trial) {
    rfl_candidate c;
    rfl_propose(&s.theirs, &v, FourWords(u).words, &c);
    const Rgb f = value(s, s.wo[i], c.wi);
    const float channels[3] = {f.r, f.g, f.b};
    if (rfl_accept(&v, &c, rfl_target(&s.theirs, channels, 3), u(), &d)) return sum_of(d, f);
  }
  return 0;
}

struct Way {
  const char* name;
  Call cpp, native, c;
};
constexpr auto ours = &Subject::ours;
constexpr auto native = &Subject::native;
const Way ways[] = {
    {"one-shot, alias", alias<ours>, alias<native>, c_alias},
    {"one-shot, alias, without f", alias_without_f<ours>, alias_without_f<native>, c_alias_without_f},
    {"one-shot, uniforms", uniforms<ours>, uniforms<native>, c_uniforms},
    {"one-shot, pdf", pdf<ours>, pdf<native>, c_pdf},
    {"one-shot, inverse", inverse<ours>, inverse<native>, c_inverse},
    {"exact", exact<ours>, exact<native>, c_exact}};

struct Run {
  double ns, sum;
};
Run run(const Subject& s, Call call, long calls) {
  Pcg32 u(1);
  double sum = 0;
  const double start = study::thread_seconds();
  for (long i = 0; i < calls; ++i) sum += double(call(s, std::size_t(i) & 4095U, u));
  return {1e9 * (study::thread_seconds() - start) / double(calls), sum};
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const long calls = argc > 1 ? std::atol(argv[1]) : 1'000'000, repeats = argc > 2 ? std::atol(argv[2]) : 11;
  const std::string wanted = argc > 3 ? argv[3] : "", side = argc > 4 ? argv[4] : "";
  if (calls < 1 || repeats < 1)
    return std::fputs("usage: bench_runtime [CALLS] [REPEATS] [NAME] [cpp|c]\n", stderr), 2;
  const Subject subjects[] = {
      {"ggx 0.3", Ggx{0.3f}}, {"ggx 0.1", Ggx{0.1f}}, {"ggx 0.05 x 0.3", Ggx{Widths(0.05f, 0.3f)}}};
  std::printf("%ld calls, %ld repeats\n%-16s %-28s %8s %8s %7s %9s\n", calls, repeats, "", "", "C++ ns",
              "C ns", "ratio", "model ns");
  bool agree = true;
  for (const Subject& s : subjects) {
    for (const Way& way : ways) {
      if ((s.name + " " + way.name).find(wanted) == std::string::npos) continue;
      std::vector<double> cpp, c, ratio, model;
      for (long r = 0; r < repeats; ++r) {
        Run ours_ran{0, 0}, theirs{0, 0};
        if (side != "c") ours_ran = run(s, way.cpp, calls);
        if (side != "cpp") theirs = run(s, way.c, calls);
        if (side.empty()) model.push_back(run(s, way.native, calls).ns);
        cpp.push_back(ours_ran.ns), c.push_back(theirs.ns), ratio.push_back(theirs.ns / ours_ran.ns);
        agree = agree && (!side.empty() || ours_ran.sum == theirs.sum);
      }
      std::printf("%-16s %-28s %8.1f %8.1f %7.2f %9.1f\n", s.name.c_str(), way.name, median(cpp), median(c),
                  median(ratio), model.empty() ? 0 : median(model));
    }
  }
  if (!agree) return std::fputs("the two sides do not return the same\n", stderr), 1;
  return 0;
}
