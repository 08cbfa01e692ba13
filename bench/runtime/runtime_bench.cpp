// SPDX-License-Identifier: Apache-2.0
// The runtime of one file beside the C++ samplers: nanoseconds of this thread per call, medians of repeats that
// alternate in one run, and their ratios. Both sides draw the same directions from the same words, evaluate the
// same function from directions, and must agree in the sum of all that they return.
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
#include "reflectree_sample.h"

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
  rfl_sampler theirs{};
  std::vector<Direction> wo, wi;  // wi: drawn for its wo

  Subject(std::string called, Ggx ggx)
      : Subject(std::move(called), ggx, build(AnyBrdf(ggx), BuildOptions{})) {}
  Subject(std::string called, Ggx ggx, const SamplerData& data)
      : name(std::move(called)), f{ggx}, ours(make_sampler(f, data)) {
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
struct Way {
  const char* name;
  Call cpp, c;
};

const Way ways[] = {
    {"one-shot, alias",
     [](const Subject& s, std::size_t i, Pcg32& u) { return sum_of(s.ours.one_shot.sample(s.wo[i], u)); },
     [](const Subject& s, std::size_t i, Pcg32& u) {
       rfl_viewer v;
       if (!rfl_view(&s.theirs, vec(s.wo[i]), &v)) return 0.f;
       rfl_draw d;
       rfl_one_shot(&s.theirs, &v, FourWords(u).words, &d);
       return sum_of(d, value(s, s.wo[i], d.wi));
     }},
    {"one-shot, alias, without f",
     [](const Subject& s, std::size_t i, Pcg32& u) {
       const auto p = s.ours.one_shot.propose(s.wo[i], u);
       return p ? p->wi.x + p->wi.y + p->wi.z + p->pdf + p->scale : 0.f;
     },
     [](const Subject& s, std::size_t i, Pcg32& u) {
       rfl_viewer v;
       if (!rfl_view(&s.theirs, vec(s.wo[i]), &v)) return 0.f;
       rfl_draw d;
       rfl_one_shot(&s.theirs, &v, FourWords(u).words, &d);
       return d.wi.x + d.wi.y + d.wi.z + d.pdf + d.scale;
     }},
    {"one-shot, uniforms",
     [](const Subject& s, std::size_t i, Pcg32& u) {
       const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
       return sum_of(s.ours.one_shot.sample(s.wo[i], u1, u2));
     },
     [](const Subject& s, std::size_t i, Pcg32& u) {
       const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
       rfl_viewer v;
       rfl_draw d;
       if (!rfl_view(&s.theirs, vec(s.wo[i]), &v) || !rfl_one_shot_uniforms(&s.theirs, &v, u1, u2, &d))
         return 0.f;
       return sum_of(d, value(s, s.wo[i], d.wi));
     }},
    {"one-shot, pdf",
     [](const Subject& s, std::size_t i, Pcg32&) { return s.ours.one_shot.pdf(s.wo[i], s.wi[i]); },
     [](const Subject& s, std::size_t i, Pcg32&) {
       rfl_viewer v;
       return rfl_view(&s.theirs, vec(s.wo[i]), &v) ? rfl_one_shot_pdf(&s.theirs, &v, vec(s.wi[i])) : 0.f;
     }},
    {"one-shot, inverse",
     [](const Subject& s, std::size_t i, Pcg32&) {
       const auto at = s.ours.one_shot.invert(s.wo[i], s.wi[i]);
       return at ? float(at->x) + float(at->y) : 0.f;
     },
     [](const Subject& s, std::size_t i, Pcg32&) {
       rfl_viewer v;
       double at[2] = {0, 0};
       if (rfl_view(&s.theirs, vec(s.wo[i]), &v)) rfl_one_shot_invert(&s.theirs, &v, vec(s.wi[i]), at);
       return float(at[0]) + float(at[1]);
     }},
    {"exact",
     [](const Subject& s, std::size_t i, Pcg32& u) { return sum_of(s.ours.exact.sample(s.wo[i], u)); },
     [](const Subject& s, std::size_t i, Pcg32& u) {
       rfl_viewer v;
       if (!rfl_view(&s.theirs, vec(s.wo[i]), &v)) return 0.f;
       for (int trial = 0; trial < RFL_MAX_TRIALS; ++trial) {
         rfl_candidate c;
         rfl_propose(&s.theirs, &v, FourWords(u).words, &c);
         const Rgb f = value(s, s.wo[i], c.wi);
         const float channels[3] = {f.r, f.g, f.b};
         rfl_draw d;
         if (rfl_accept(&v, &c, rfl_target(&s.theirs, channels, 3), u(), &d)) return sum_of(d, f);
       }
       return 0.f;
     }},
};

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
  const Subject subjects[] = {{"ggx:alpha=0.3", Ggx{0.3f}}, {"ggx:alpha=0.1", Ggx{0.1f}}};
  std::printf("%ld calls, %ld repeats\n%-20s %-28s %8s %8s %7s\n", calls, repeats, "material", "", "C++ ns",
              "C ns", "ratio");
  bool agree = true;
  for (const Subject& s : subjects) {
    for (const Way& way : ways) {
      const std::string name = s.name + " " + way.name;
      if (name.find(wanted) == std::string::npos) continue;
      std::vector<double> cpp, c, ratio;
      for (long r = 0; r < repeats; ++r) {
        Run ours{0, 0}, theirs{0, 0};
        if (side != "c") ours = run(s, way.cpp, calls);
        if (side != "cpp") theirs = run(s, way.c, calls);
        cpp.push_back(ours.ns), c.push_back(theirs.ns), ratio.push_back(theirs.ns / ours.ns);
        agree = agree && (!side.empty() || ours.sum == theirs.sum);
      }
      std::printf("%-20s %-28s %8.1f %8.1f %7.2f\n", s.name.c_str(), way.name, median(cpp), median(c),
                  median(ratio));
    }
  }
  if (!agree) return std::fputs("the two sides do not return the same\n", stderr), 1;
  return 0;
}
