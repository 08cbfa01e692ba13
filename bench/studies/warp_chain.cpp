// SPDX-License-Identifier: Apache-2.0
// The warp chain of Dupuy and Jakob 2018 beside our samplers, on materials baked as RGL files: the chain that is fitted
// from what the file says, the peer of `compare`; and, where its source was given (-DPOWITACQ=FOLDER,
// github.com/rgl-epfl/brdf-loader), the file's own tables, as their authors' loader draws from them. Prints Markdown.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/rgl_fit.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/study/thread_time.hpp"
#include "study_program.hpp"

#ifdef REFLECTREE_POWITACQ
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wsign-compare"
#define POWITACQ_IMPLEMENTATION 1
#include <powitacq_rgb.h>
#pragma GCC diagnostic pop
#endif

namespace {

using namespace reflectree;

constexpr double degs[] = {10, 45, 75, 85};
constexpr int azimuths = 16, samples = 20'000, turns = 5;
constexpr double round_seconds = 2e-3;

struct Drawn {
  float weight[3];
};
using Draw = std::function<Drawn(Direction wo, UniformBits& u)>;
struct Way {
  const char* name;
  double kib, build_seconds;
  Draw draw;
};

// Compiled for the type of its function, as the authors' loader is.
template <class Sampler>
Way ours(const char* name, const Sampler& sampler, double seconds) {
  return {name, double(bytes_of(sampler.packed())) / 1024, seconds, [sampler](Direction wo, UniformBits& u) {
            const auto s = sampler.sample(wo, u);
            return s ? Drawn{{s->weight[0], s->weight[1], s->weight[2]}} : Drawn{};
          }};
}

Way warp_chain(const AnyBrdf& f) {
  const double start = study::thread_seconds();
  const auto sampler = std::make_shared<const AnySampler<Spectrum>>(
      *find_sampler("warp-chain")->make({f, {}, {}, nullptr}, {}));
  return {"warp-chain", double(sampler->bytes()) / 1024, study::thread_seconds() - start,
          [sampler](Direction wo, UniformBits& u) {
            const auto s = sampler->sample(wo, u);
            return s ? Drawn{{s->weight[0], s->weight[1], s->weight[2]}} : Drawn{};
          }};
}

#ifdef REFLECTREE_POWITACQ
// The loader reads only files that go all the way round. They are written for functions without symmetry: of this one a
// thousandth is lopsided.
AnyBrdf barely_lopsided(const AnyBrdf& f) {
  return AnyBrdf([f](Direction wo, Direction wi) {
    const Spectrum v = f(shading_geometry(wo, wi));
    const float factor = 1 + 1e-3f * wi.x;
    return Rgb{factor * v[0], factor * v[v.channels() > 1 ? 1 : 0], factor * v[v.channels() > 2 ? 2 : 0]};
  });
}

Way loader(const AnyBrdf& f) {
  const Bytes bytes = write_rgl(fit_rgl(barely_lopsided(f)), "whole turn");
  const std::string path = (std::filesystem::temp_directory_path() / "study_warp_chain.bsdf").string();
  write_file_atomically(path, ByteView(bytes));
  const double start = study::thread_seconds();
  const auto brdf = std::make_shared<const powitacq_rgb::BRDF>(path);
  const double seconds = study::thread_seconds() - start;
  std::filesystem::remove(path);
  return {"the file's own, by its authors' loader", double(bytes.size()) / 1024, seconds,
          [brdf](Direction wo, UniformBits& u) {
            const powitacq_rgb::Vector2f points(to_unit_float(u()), to_unit_float(u()));
            powitacq_rgb::Vector3f wi;
            float pdf = 0;
            const auto w = brdf->sample(points, {wo.x, wo.y, wo.z}, &wi, &pdf);
            return Drawn{{w[0], w[1], w[2]}};
          }};
}
#endif

Direction viewer(double deg, double turn) {
  return direction_from_angles(float(deg * pi_v<double> / 180), float(2 * pi_v<double> * turn));
}

// Of the weight, relative, its channels together: the mean over viewers all around.
double variance_at(const Way& way, double deg) {
  UniformBits u{Pcg32(3)};
  double mean_variance = 0;
  for (int a = 0; a < azimuths; ++a) {
    double sum[3] = {}, square = 0;
    for (int i = 0; i < samples; ++i) {
      const Drawn d = way.draw(viewer(deg, (a + 0.37) / azimuths), u);
      for (int c = 0; c < 3; ++c) {
        sum[c] += double(d.weight[c]) / samples;
        square += double(d.weight[c]) * double(d.weight[c]) / samples;
      }
    }
    mean_variance += (square / (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) - 1) / azimuths;
  }
  return mean_variance;
}

// Nanoseconds per sample, viewers all around: of every way in turn, medians over the turns.
std::vector<double> times_at(const std::vector<Way>& ways, double deg) {
  UniformBits u{Pcg32(7)};
  std::vector<Direction> wo(512);
  for (Direction& w : wo) w = viewer(deg, to_unit_double(u()));
  std::vector<std::vector<double>> all(ways.size());
  double used = 0;
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t k = 0; k < ways.size(); ++k) {
      all[k].push_back(1e9 * study::median_seconds(round_seconds, [&](std::size_t i) {
                         used += double(ways[k].draw(wo[i % wo.size()], u).weight[0]);
                       }));
    }
  }
  volatile double kept = used;
  (void)kept;
  std::vector<double> medians;
  for (auto& t : all) {
    std::nth_element(t.begin(), t.begin() + turns / 2, t.end());
    medians.push_back(t[turns / 2]);
  }
  return medians;
}

void show(const std::string& text) {
  const AnyBrdf material = make_brdf(parse_material(text));
  const RglWideTable f(fit_rgl(material).fields);
  const double start = study::thread_seconds();
  const auto packed = std::make_shared<const PackedSampler>(pack(build(AnyBrdf(f))));
  const double seconds = study::thread_seconds() - start;
  std::vector<Way> ways{ours("one-shot", OneShotSampler<RglWideTable>(f, packed), seconds),
                        ours("exact", ExactSampler<RglWideTable>(f, packed), seconds),
                        warp_chain(AnyBrdf(f))};
#ifdef REFLECTREE_POWITACQ
  ways.push_back(loader(material));
#endif
  std::vector<std::vector<double>> times;
  for (const double deg : degs) times.push_back(times_at(ways, deg));
  for (std::size_t k = 0; k < ways.size(); ++k) {
    std::printf("| %s | %s | %.0f | %.1f |", k == 0 ? text.c_str() : "", ways[k].name, ways[k].kib,
                ways[k].build_seconds);
    for (std::size_t i = 0; i < std::size(degs); ++i)
      std::printf(" %.0f (%.2f) |", times[i][k], times[i][k] / times[i][0]);
    for (const double deg : degs) std::printf(" %.4f |", variance_at(ways[k], deg));
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The warp chain beside our samplers on materials baked as RGL files, as Markdown.");
  std::vector<std::string> materials{"ggx:alpha_x=0.05,alpha_y=0.3", "ward:alpha_x=0.1,alpha_y=0.4"};
  app.add_option("MATERIAL", materials, "Models or sums; nothing: two");
  return study::run_program(app, argc, argv, [&] {
    std::printf("| RGL file of | sampler | KiB | build s |");
    for (const double deg : degs) std::printf(" ns at %g° |", deg);
    for (const double deg : degs) std::printf(" variance at %g° |", deg);
    std::printf("\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
    for (const std::string& material : materials) show(material);
    return 0;
  });
}
