// SPDX-License-Identifier: Apache-2.0
// The same picture by every sampler: at equal samples and at equal time, against a converged one. Time is CPU
// time of one thread, so that what else the machine does counts for little. Prints Markdown; writes a few
// pictures of the first scene and their maps of error into the folder named first. After --scene NAME that
// scene alone is done. Measured data is that of REFLECTREE_DATA.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "reflectree/error.hpp"
#include "reflectree/io/image.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/render/film.hpp"
#include "reflectree/render/image_compare.hpp"
#include "reflectree/study/thread_time.hpp"
#include "study_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace reflectree;
using study::thread_seconds;

struct Shot {
  const char *name, *words;
  bool measured;  // needs REFLECTREE_DATA
};
constexpr Shot shots[] = {{"metal", "glossy metal in a room", false},
                          {"retro", "retro-reflective spheres under a sun", false},
                          {"ball", "a ball of a measured metallic paint under a measured sky", true},
                          {"plates", "Veach's plates", false}};
constexpr int samples = 25;

struct Options {
  std::string folder, scenes = "bench/study/scenes", only;
  int reference = 1024;
};

render::Scene load(const Options& o, const Shot& shot, const std::string& sampler) {
  render::SceneOptions options;
  options.sampler = sampler;
  if (const char* data = std::getenv("REFLECTREE_DATA")) {
    options.defines["material"] = std::string(data) + "/rgl/chm_light_blue_rgb.bsdf";
    options.defines["sky"] = std::string(data) + "/envmaps/venice_sunset_1k.hdr";
  }
  return render::load_scene(o.scenes + "/" + shot.name + ".xml", options);
}

struct Rendered {
  render::Film film;
  double seconds = 0;  // CPU
};
Rendered rendered(const render::Scene& scene, int spp, std::uint64_t seed) {
  render::RenderOptions how;
  how.samples = spp, how.seed = seed;
  Rendered r;
  const double start = thread_seconds();
  render::render_into(r.film, scene, how);
  r.seconds = thread_seconds() - start;
  return r;
}

// Mean over pixels and channels of (a - b)^2 / (b^2 + .01). Of the pixels whose error is largest one in a
// thousand is left out: a single bright path would be the whole figure.
struct Error2 {
  double all = 0, trimmed = 0;
};
Error2 relative_error(const Image& a, const Image& b) {
  std::vector<double> errors;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      double sum = 0;
      for (const char* channel : {"R", "G", "B"}) {
        const double p = double(a.values[a.index(x, y) + std::size_t(a.find(channel))]),
                     q = double(b.values[b.index(x, y) + std::size_t(b.find(channel))]);
        sum += (p - q) * (p - q) / (q * q + 0.01) / 3;
      }
      errors.push_back(sum);
    }
  }
  std::sort(errors.begin(), errors.end());
  Error2 e;
  const std::size_t kept = errors.size() - errors.size() / 1000;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    e.all += errors[i] / double(errors.size());
    if (i < kept) e.trimmed += errors[i] / double(kept);
  }
  return e;
}

void save(const Options& o, const Shot& shot, const std::string& name, const Image& image,
          const Image* reference) {
  constexpr const char* shown[] = {"reference", "cosine", "proxy", "paper", "exact", "one-shot"};
  if (o.folder.empty() || &shot != &shots[0]) return;
  if (std::find(std::begin(shown), std::end(shown), name) == std::end(shown)) return;
  const std::string path = o.folder + "/pictures-" + name;
  write_png(path + ".png", image);
  if (reference) write_png(path + "-error.png", render::difference_map(image, *reference, 2, 0.5));
}

void show(const Options& o, const Shot& shot) {
  std::printf("## %s\n\n", shot.words);
  const Image reference = render::to_image([&] {
    const render::Scene scene = load(o, shot, "one-shot");
    return rendered(scene, o.reference, 77).film;
  }());
  save(o, shot, "reference", reference, nullptr);
  std::printf(
      "| sampler | relMSE, %d samples | without .1 %% of the pixels | CPU s (*) | samples in the time of "
      "one-shot | relMSE at equal time | ours = 1 |\n|---|---|---|---|---|---|---|\n",
      samples);
  double time = 0, ours = 0;
  // One-shot first: its time is everyone's.
  std::vector<std::string> names{"one-shot"};
  for (const SamplerInfo& info : samplers()) {
    if (info.name != "one-shot") names.emplace_back(info.name);
  }
  for (const std::string& name : names) {
    try {
      const render::Scene scene = load(o, shot, name);
      const Rendered equal = rendered(scene, samples, 1);
      if (!(time > 0)) time = equal.seconds;
      const Image image = render::to_image(equal.film);
      const Error2 e = relative_error(image, reference);
      const int spp = std::max(1, int(std::lround(samples * time / equal.seconds)));
      const Image timed = render::to_image(rendered(scene, spp, 2).film);
      const Error2 at_time = relative_error(timed, reference);
      if (!(ours > 0)) ours = at_time.trimmed;
      std::printf("| %s | %.4f | %.4f | %.2f | %d | %.4f | %.2f |\n", name.c_str(), e.all, e.trimmed,
                  equal.seconds, spp, at_time.trimmed, at_time.trimmed / ours);
      save(o, shot, name, image, &reference);
    } catch (const Error& error) {
      std::printf("| %s | – | – | – | – | – | – |\n", name.c_str());
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    }
    std::fflush(stdout);
  }
  std::printf("\n");
  if (&shot != &shots[0]) return;
  std::printf(
      "The converged picture, then %d samples of each with the map of errors, red where it is too bright, "
      "blue "
      "where too dark, full at 50 %%.\n\n![converged](pictures-reference.png)\n\n",
      samples);
  for (const char* name : {"cosine", "proxy", "paper", "exact", "one-shot"})
    std::printf("%s\n\n![%s](pictures-%s.png) ![error of %s](pictures-%s-error.png)\n\n", name, name, name,
                name, name);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The study in pictures, as Markdown: the same scenes by every sampler.");
  Options o;
  app.add_option("FOLDER", o.folder, "where the pictures go; none are drawn without it")
      ->check(CLI::ExistingDirectory);
  app.add_option("--scene", o.only, "this one alone");
  app.add_option("--scenes", o.scenes, "the folder of the scenes")->check(CLI::ExistingDirectory);
  app.add_option("--reference", o.reference, "samples a pixel of the reference")->check(CLI::PositiveNumber);
  return study::run_program(app, argc, argv, [&] {
    std::printf(
        "# Pictures\n\n    REFLECTREE_DATA=... build/bin/study_pictures docs/results\n\n450 × 200 pixels, "
        "path "
        "tracing with lights and surfaces combined by the balance heuristic, against one of %d samples a "
        "pixel "
        "by one-shot mode with another seed. relMSE: mean over pixels and channels of (a − b)² / (b² + .01). "
        "Equal time: each sampler gets as many samples as fit into the CPU time of one-shot mode's %d; "
        "errors "
        "there are without the .1 %% worst pixels. (*): timings.\n\n",
        o.reference, samples);
    for (const Shot& shot : shots) {
      if (!o.only.empty() && o.only != shot.name) continue;
      if (shot.measured && !std::getenv("REFLECTREE_DATA")) {
        std::printf("## %s\n\nLeft out: REFLECTREE_DATA is not set.\n\n", shot.words);
        continue;
      }
      show(o, shot);
    }
    return 0;
  });
}
