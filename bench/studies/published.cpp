// SPDX-License-Identifier: Apache-2.0
// Are the competitors no straw men? Their variances beside those that were published or measured on other
// people's code. Prints Markdown; measured files are those of REFLECTREE_DATA.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <tuple>

#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/peers/density.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/peers/sliced_density.hpp"
#include "reflectree/peers/tabulated.hpp"
#include "reflectree/peers/warp_chain.hpp"
#include "rgl_own_sampler.hpp"
#include "study_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace reflectree;

Direction at(double deg) { return direction_from_angles(float(deg * pi_v<double> / 180), 0.f); }

struct Spread {
  // Relative variance of the weight's target; share of none and of weight 0.
  double variance = 0, lost = 0;
  double deviation() const { return std::sqrt(variance); }
};
Spread spread_of(const AnySampler<Spectrum>& sampler, const Target& target, double deg) {
  constexpr int samples = 400'000;
  UniformBits u{Pcg32(3)};
  double sum = 0, sum2 = 0, none = 0;
  for (int i = 0; i < samples; ++i) {
    const auto drawn = sampler.sample(at(deg), u);
    const double w = drawn ? double(target(drawn->weight)) : 0;
    sum += w, sum2 += w * w, none += !(w > 0);
  }
  const double mean = sum / samples;
  return {sum2 / samples / (mean * mean) - 1, none / samples};
}

void show_visible_normals() {
  std::printf(
      "## Visible normals\n\n    build/bin/study_published\n\nRelative variance of the weight, by 400 000 "
      "samples at theta_o = 0, 30, 60, 80°; in brackets what was measured on other people's code (spherical "
      "caps, Dupuy and Benyoub 2023). F = 1.\n\n| GGX | 0° | 30° | 60° "
      "| "
      "80° |\n|---|---|---|---|---|\n");
  struct Row {
    const char *name, *text, *known[4];
  };
  for (const Row& row : {Row{"0.3", "ggx:alpha=0.3,f0=1", {"0.11", "0.11", "0.13", "0.09"}},
                         Row{"0.1", "ggx:alpha=0.1,f0=1", {"0.011", "0.012", "0.019", "0.057"}}}) {
    const Material material = parse_material(row.text);
    const auto sampler = find_sampler("textbook")->make({make_brdf(material), material, {}}, {});
    std::printf("| %s |", row.name);
    constexpr double degs[] = {0, 30, 60, 80};
    for (int i = 0; i < 4; ++i)
      std::printf(" %.3f (%s) |", spread_of(*sampler, {}, degs[i]).variance, row.known[i]);
    std::printf("\n");
  }
  std::printf("\n");
}

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
  return x[x.size() / 2];
}

void show_warp_chain(const std::string& folder) {
  constexpr double degs[] = {0, 30, 60, 75, 80, 85};
  std::printf(
      "## The warp chain on the RGL files\n\n    REFLECTREE_DATA=... build/bin/study_published\n\nStandard "
      "deviation of the weight over its mean, for the luminance: the chain fitted from f / that of the "
      "tables "
      "which the file carries, both drawn by 400 000 samples; in brackets the share that these lose. "
      "Published "
      "and measured elsewhere on these files: 0.03 to 0.31, and up to 0.57 at 85° (chm_mint).\n\n| file |");
  for (const double deg : degs) std::printf(" %g° |", deg);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".bsdf") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  Target target;
  target.kind = TargetKind::luminance;
  std::vector<double> fitted[std::size(degs)], own[std::size(degs)];
  for (const std::string& path : paths) {
    const AnyBrdf f = load_brdf(path);
    const auto chain = find_sampler("warp-chain")->make({f, {}, target}, {});
    const AnySampler<Spectrum> file = study::rgl_own_sampler(path, f);
    std::printf("| %s |", fs::path(path).stem().string().c_str());
    for (std::size_t i = 0; i < std::size(degs); ++i) {
      const Spread a = spread_of(*chain, target, degs[i]), b = spread_of(file, target, degs[i]);
      fitted[i].push_back(a.deviation()), own[i].push_back(b.deviation());
      std::printf(" %.2f / %.2f (%.1f %%) |", a.deviation(), b.deviation(), 100 * b.lost);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  std::printf("| median |");
  for (std::size_t i = 0; i < std::size(degs); ++i)
    std::printf(" %.2f / %.2f |", median(fitted[i]), median(own[i]));
  std::printf("\n");
}

// The fitted chain with other sizes and elevations: which of them is short where it is worse than the file's?
void show_hardest(const std::string& path) {
  const AnyBrdf f = load_brdf(path);
  Target target;
  target.kind = TargetKind::luminance;
  const std::vector<float> elevations = study::rgl_elevations(path);
  std::printf(
      "\n## chm_mint beyond 60°\n\n    REFLECTREE_DATA=... build/bin/study_published\n\nStandard deviation "
      "for "
      "the luminance, by 400 000 samples. The file's elevations:");
  for (const float theta : elevations) std::printf(" %.1f", double(theta) * 180 / pi_v<double>);
  std::printf("°.\n\n| theta_o | file's own tables |");
  std::vector<AnySampler<Spectrum>> all{study::rgl_own_sampler(path, f)};
  for (const auto& [name, slices, nodes, normals] :
       {std::tuple{"16 elevations", 16, 64, 128}, std::tuple{"48 elevations", 48, 64, 128},
        std::tuple{"16, target 256²", 16, 256, 128}, std::tuple{"16, normals 512 × 256", 16, 64, 512}}) {
    TabulatedTuning tuning;
    tuning.warp = {slices, normals, normals / 2, nodes};
    all.push_back(*make_warp_chain({f, {}, target}, {}, tuning));
    std::printf(" %s |", name);
  }
  WarpOptions options;
  auto slices = fit_warp_chain(f, target, elevations, options);
  const SlicedDensity<WarpSlice> aligned(SquareChart::half_vector, elevations, std::move(slices));
  all.emplace_back("aligned", WeightedSampler<AnyBrdf, SlicedDensity<WarpSlice>>(f, aligned));
  std::printf(" at the file's elevations |\n|---|---|---|---|---|---|---|\n");
  for (const double deg : {60., 70., 74., 76., 78., 80., 82., 84., 86., 88.}) {
    std::printf("| %g° |", deg);
    for (const auto& sampler : all) std::printf(" %.2f |", spread_of(sampler, target, deg).deviation());
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Competitors beside their papers, as Markdown. Measured files are those of REFLECTREE_DATA.");
  return study::run_program(app, argc, argv, [] {
    std::printf("# Competitors beside their papers\n\n");
    show_visible_normals();
    const char* data = std::getenv("REFLECTREE_DATA");
    const std::string folder = data ? std::string(data) + "/rgl" : "";
    if (!data || !fs::is_directory(folder)) {
      std::printf("The RGL files are left out: REFLECTREE_DATA names no folder with rgl/.\n");
      return 0;
    }
    show_warp_chain(folder);
    show_hardest(folder + "/chm_mint_rgb.bsdf");
    return 0;
  });
}
