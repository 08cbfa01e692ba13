// SPDX-License-Identifier: Apache-2.0
// What the paper left for later, one ablation each on the paper's own sampler. Prints Markdown.
#include <cstring>

#include "judged.hpp"
#include "reflectree/peers/haar_warp.hpp"
#include "reflectree/peers/paper_sampler.hpp"
#include "reflectree/peers/paper_statistics.hpp"
#include "study_program.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

constexpr const char* materials[] = {"lambert", "ggx:alpha=0.3", "ggx:alpha=0.05", "ward:alpha=0.1"};
constexpr double one_deg = 45;

StudyOptions options() {
  StudyOptions o;
  o.samples = 1U << 15U;
  return o;
}

AnySampler<Spectrum> paper_of(const AnyBrdf& f, const PaperOptions& o, double& seconds, PaperStatistics& s) {
  const double start = thread_seconds();
  const PaperSampler sampler(f, {}, o);
  seconds = thread_seconds() - start;
  s = paper_statistics(f, {}, sampler.trees(), o, 2);
  return {"paper", sampler, sampler.bytes()};
}

void head(const char* title, const char* columns, int count) {
  std::printf("## %s\n\n    build/bin/study_future_work\n\n%s\n|", title, columns);
  for (int i = 0; i < count; ++i) std::printf("---|");
  std::printf("\n");
}

void row(const char* material, const std::string& name, std::size_t leaves, double kib, double seconds,
         double trials, const Judged& j, double first_cost) {
  std::printf("| %s | %s | %zu | %.0f | %.2f | %.2f | %.1e ± %.0e | %.1e | %.1f | %.3g |\n", material,
              name.c_str(), leaves, kib, seconds, trials, j.worst_bias, j.interval, j.worst_variance,
              j.x_floor, j.cost / first_cost);
}
constexpr const char* row_head =
    "| material | step | leaves | KiB | build s (*) | trials | worst bias | worst variance | × floor (*) | "
    "cost "
    "(*) |";

// The tables of the whole sampler on each map; theta_o 10, 45, 75, 85.
void show_maps(std::span<const Illumination> lights) {
  head("Area-preserving and half-vector map against the disk", row_head, 10);
  constexpr std::pair<const char*, PaperMap> maps[] = {
      {"disk", PaperMap::disk}, {"equal-area", PaperMap::equal_area}, {"half-vector", PaperMap::half_vector}};
  for (const char* text : materials) {
    const JudgedSubject s =
        subject_of(text, make_brdf(parse_material(text)), {10, 45, 75, 85}, lights, options());
    double first = 0;
    for (const auto& [name, map] : maps) {
      PaperOptions o;
      o.map = map;
      if (map != PaperMap::disk) o.negligible = 1e-3;
      double seconds = 0;
      PaperStatistics statistics;
      const auto sampler = paper_of(s.f, o, seconds, statistics);
      const Judged j = judged(sampler, s, lights, options());
      if (!(first > 0)) first = j.cost;
      row(text, name, statistics.leaves, double(sampler.bytes()) / 1024, seconds, statistics.trials, j,
          first);
    }
  }
  std::printf("\n");
}

// The tree replaced by a thresholded Haar transform of f over the same square, for one wo.
struct WaveletDisk {
  using Value = Spectrum;
  AnyBrdf f;
  HaarWarp warp;

  template <RandomBits U>
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, U& u) const {
    std::optional<DirectionSample<Spectrum>> out;
    if constexpr (std::same_as<U, UniformBits>) {
      out = draw(wo, u);
    } else {
      UniformBits bits(u);
      out = draw(wo, bits);
      u = bits.rest();
    }
    return out;
  }
  float pdf(Direction, Direction wi) const {
    return wi.z > 0 ? warp.pdf({wi.x / 2 + 0.5f, wi.y / 2 + 0.5f}) / 4 * wi.z : 0;
  }

 private:
  std::optional<DirectionSample<Spectrum>> draw(Direction wo, UniformBits& u) const {
    const Vec2<float> p = warp.sample(u);
    const float x = 2 * p.x - 1, y = 2 * p.y - 1, z2 = 1 - x * x - y * y;
    if (!(z2 > 0)) return std::nullopt;
    const Direction wi{x, y, sqrt(z2)};
    const float density = pdf(wo, wi);
    if (!(density > 0)) return std::nullopt;
    return DirectionSample<Spectrum>{wi, density, scaled_value(eval(f, wo, wi), wi.z / density)};
  }
};

// Means of f over the cells of the square, 0 off the disk; on it at least 1e-3 of their mean, as the wavelet
// peer has it: what the transform takes for nothing would weigh too much where it is drawn.
std::vector<float> disk_cells(const AnyBrdf& f, Direction wo, int size) {
  constexpr int points = 3;  // per side of a cell
  std::vector<float> cells;
  std::vector<std::size_t> lit;
  double all = 0;
  for (int i = 0; i < size * size; ++i) {
    double sum = 0;
    for (int k = 0; k < points * points; ++k) {
      const double x = 2 * (i % size + (k % points + 0.5) / points) / size - 1;
      const double y = 2 * (i / size + (k / points + 0.5) / points) / size - 1;
      const double z2 = 1 - x * x - y * y;
      if (z2 > 0) sum += double(Target{}(eval(f, wo, {float(x), float(y), float(std::sqrt(z2))})));
    }
    // The cell's corner nearest to the centre.
    const auto nearest = [&](int k) { return 2. * (k < size / 2 ? k + 1 : k) / size - 1; };
    if (std::hypot(nearest(i % size), nearest(i / size)) < 1) lit.push_back(cells.size());
    all += sum / (points * points);
    cells.push_back(float(sum / (points * points)));
  }
  const auto least = float(1e-3 * all / double(lit.size()));
  for (const std::size_t i : lit) cells[i] = std::max(cells[i], least);
  return cells;
}

void show_wavelets(std::span<const Illumination> lights) {
  head("Wavelets in the place of the quadtree, for one wo at 45°",
       "| material | step | leaves or kept | KiB | build s (*) | trials | worst bias | worst variance | × "
       "floor "
       "(*) | cost (*) |",
       10);
  const Direction wo = wo_at_deg(one_deg);
  for (const char* text : materials) {
    const JudgedSubject s = subject_of(text, make_brdf(parse_material(text)), {one_deg}, lights, options());
    const double start = thread_seconds();
    const PaperSampler tree(s.f, {}, wo, {});
    const double seconds = thread_seconds() - start;
    const PaperStatistics statistics = paper_statistics(s.f, {}, tree.trees(), {}, 2);
    // The tree of one wo, asked at phi_o = 0 alone.
    const Judged of_tree = judged({"tree", tree, tree.bytes()}, s, lights, options());
    row(text, "quadtree, rejection", statistics.leaves, double(tree.bytes()) / 1024, seconds,
        statistics.trials, of_tree, of_tree.cost);
    for (const double dropped : {1e-2, 1e-4, 1e-6}) {
      const double from = thread_seconds();
      const WaveletDisk wavelet{s.f, HaarWarp(disk_cells(s.f, wo, 256), 256, dropped)};
      const double took = thread_seconds() - from;
      const Judged j = judged({"wavelet", wavelet, wavelet.warp.bytes()}, s, lights, options());
      char name[64];
      std::snprintf(name, sizeof name, "Haar, 256², %g of the energy dropped", dropped);
      row(text, name, wavelet.warp.bytes() / 28, double(wavelet.warp.bytes()) / 1024, took, 1, j,
          of_tree.cost);
    }
  }
  std::printf("\n");
}

void show_qmc() {
  std::printf(
      "## QMC against random numbers\n\n    build/bin/study_future_work\n\nRMSE at N = 1024 under the sky, "
      "theta_o = 45°, and the slope from N = 4; Owen-scrambled Sobol' points place the first trial.\n\n"
      "| material | choice of the leaf | n_max | random | slope | Sobol' | slope | gain in samples "
      "|\n|---|---|---|---|---|---|---|---|\n");
  const std::vector<Illumination> lights{procedural_illuminations()[1]};
  StudyOptions o;
  o.curve_repeats = 256, o.curve_samples = 1024;
  const Direction wo = wo_at_deg(one_deg);
  for (const char* text : materials) {
    const AnyBrdf f = make_brdf(parse_material(text));
    const double albedo = reference_albedo(target_function(f), wo).value;
    for (const double n_max : {4., 1.2}) {
      for (const auto& [name, choice] :
           {std::pair{"cdf, the paper's", PaperChoice::cdf}, std::pair{"warp", PaperChoice::warp}}) {
        PaperOptions p;
        p.choice = choice, p.n_max = n_max;
        const AnySampler<Spectrum> sampler("paper", PaperSampler(f, {}, wo, p));
        const ErrorCurve c = measure_curves(sampler, wo, albedo, lights, o, 31)[0];
        std::vector<double> n, random, sobol;
        for (std::size_t i = 1; i < c.n.size(); ++i) {
          n.push_back(c.n[i]);
          random.push_back(std::sqrt(c.random[i])), sobol.push_back(std::sqrt(c.stratified[i]));
        }
        std::printf("| %s | %s | %g | %.2e | %.2f | %.2e | %.2f | %.1f |\n", text, name, n_max, random.back(),
                    log_slope(n, random), sobol.back(), log_slope(n, sobol),
                    sqr(random.back() / sobol.back()));
      }
    }
  }
  std::printf("\n");
}

void show_steps(std::span<const Illumination> lights) {
  head("Faster, step by step, from the paper's scheme to ours", row_head, 10);
  struct Step {
    const char* name;
    PaperOptions o;
  };
  std::vector<Step> steps{{"the paper's: 90 elevations, n_max 4, nearest", {}}};
  steps[0].o.between = PaperBetween::nearest;
  const auto then = [&](const char* name, const auto& change) {
    steps.push_back({name, steps.back().o});
    change(steps.back().o);
  };
  then("+ mixed between elevations", [](PaperOptions& o) { o.between = PaperBetween::mixed; });
  then("+ n_max 1.5", [](PaperOptions& o) { o.n_max = 1.5; });
  then("+ leaves by alias", [](PaperOptions& o) { o.choice = PaperChoice::alias; });
  then("+ rejected ones start again from the root", [](PaperOptions& o) { o.retry_from_root = true; });
  then("+ half-vector map", [](PaperOptions& o) { o.map = PaperMap::half_vector, o.negligible = 1e-3; });
  for (const char* text : materials) {
    const JudgedSubject s =
        subject_of(text, make_brdf(parse_material(text)), {10, 45, 75, 85}, lights, options());
    double first = 0;
    for (const Step& step : steps) {
      double seconds = 0;
      PaperStatistics statistics;
      const auto sampler = paper_of(s.f, step.o, seconds, statistics);
      const Judged j = judged(sampler, s, lights, options());
      if (!(first > 0)) first = j.cost;
      row(text, step.name, statistics.leaves, double(sampler.bytes()) / 1024, seconds, statistics.trials, j,
          first);
    }
    const double start = thread_seconds();
    const SamplerData data = build(s.f);
    const double seconds = thread_seconds() - start;
    const auto packed = std::make_shared<const PackedSampler>(pack(data));
    const PeerSubject subject{s.f, {}, {}, packed};
    for (const char* mode : {"exact", "one-shot"}) {
      std::size_t leaves = 0;
      const bool exact = std::strcmp(mode, "exact") == 0;
      if (exact) {
        for (const MajorantTree& t : data.exact) leaves += t.mass.size();
      } else {
        for (const DensityTree& t : data.one_shot) leaves += t.mass.size();
      }
      const auto sampler = find_sampler(mode)->make(subject, {});
      row(text, std::string("ours: ") + mode, leaves, double(sampler->bytes()) / 1024, seconds,
          exact ? double(data.report.expected_trials) : 1, judged(*sampler, s, lights, options()), first);
    }
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What the paper left for later, one ablation each on the paper's own sampler, as Markdown.");
  return run_program(app, argc, argv, [] {
    const std::vector<Illumination> lights{procedural_illuminations()[1]};
    std::printf(
        "# What the paper left for later\n\nAblations on the paper's own sampler. Columns with (*) are "
        "timings. "
        "Floor: a polar cosine-hemisphere sample; cost: RMSE² × time under the sky, the first row of a "
        "material "
        "= 1; variance and bias: relative, of the weight, the worst elevation.\n\n");
    show_wavelets(lights);
    std::fflush(stdout);
    show_maps(lights);
    std::fflush(stdout);
    show_qmc();
    std::fflush(stdout);
    show_steps(lights);
    return 0;
  });
}
