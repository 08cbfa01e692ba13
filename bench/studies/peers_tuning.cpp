// SPDX-License-Identifier: Apache-2.0
// How the tabulated competitors were tuned: memory, build and variance against their options, as Markdown.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "reflectree/formats/material_file.hpp"
#include "reflectree/peers/tabulated.hpp"
#include "reflectree/verify/reference.hpp"
#include "study_program.hpp"

namespace {

using namespace reflectree;

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

constexpr double angles_deg[] = {0, 30, 60, 75, 85};

struct TuningSubject {
  std::string name;
  PeerSubject peer;
  std::vector<double> albedo;  // at each angle, by cubature
};

TuningSubject subject_of(std::string name, PeerSubject peer) {
  TuningSubject subject{std::move(name), std::move(peer), {}};
  const TargetFunction f = target_function(subject.peer.f, subject.peer.target);
  for (const double deg : angles_deg) {
    const Direction wo = direction_from_angles(float(deg * double(pi) / 180), 0.f);
    subject.albedo.push_back(reference_albedo(f, wo).value);
  }
  return subject;
}

std::vector<TuningSubject> subjects() {
  std::vector<TuningSubject> all;
  for (const char* text : {"lambert", "ggx:alpha=0.3", "ggx:alpha=0.1", "plastic:alpha=0.1"}) {
    const Material material = parse_material(text);
    all.push_back(subject_of(text, {make_brdf(material), material, {}}));
  }
  const char* folder = std::getenv("REFLECTREE_DATA");
  if (!folder || !*folder) std::fprintf(stderr, "no measured materials: REFLECTREE_DATA is not set\n");
  if (folder && *folder) {
    for (const std::string name : {"cardboard", "satin_purple", "chm_mint"}) {
      const std::string path = std::string(folder) + "/rgl/" + name + "_rgb.bsdf";
      all.push_back(subject_of(name, {load_brdf(path), {}, {}}));
    }
  }
  return all;
}

// bias: of the mean weight against the albedo, the worst over angles in standard errors, and relative.
struct Measured {
  double kib = 0, seconds = 0, variance = 0, worst = 0, sigmas = 0, bias = 0;
};

Measured measure(const TuningSubject& subject, MakeTabulated* make, const TabulatedTuning& tuning,
                 int samples) {
  Measured out;
  const double start = thread_seconds();
  const MadePeer sampler = make(subject.peer, {}, tuning);
  out.seconds = thread_seconds() - start;
  out.kib = double(sampler->bytes()) / 1024;
  for (std::size_t a = 0; a < std::size(angles_deg); ++a) {
    const Direction wo = direction_from_angles(float(angles_deg[a] * double(pi) / 180), 0.f);
    Pcg32 u(1 + a);
    double sum = 0, sum2 = 0;
    for (int i = 0; i < samples; ++i) {
      const auto drawn = sampler->sample(wo, u);
      const double w = drawn ? double(subject.peer.target(drawn->weight)) : 0.0;
      sum += w, sum2 += w * w;
    }
    const double n = samples, mean = sum / n, variance = sum2 / n - mean * mean;
    const double relative = variance / (mean * mean);
    out.variance += relative / double(std::size(angles_deg)), out.worst = std::max(out.worst, relative);
    const double bias = mean / subject.albedo[a] - 1;
    const double sigmas = bias / (std::sqrt(relative / n) + 1e-5);
    if (std::abs(sigmas) > std::abs(out.sigmas)) out.sigmas = sigmas, out.bias = bias;
  }
  return out;
}

struct Variant {
  std::string text;
  MakeTabulated* make;
  TabulatedTuning tuning;
};

std::vector<Variant> variants() {
  std::vector<Variant> all;
  const auto add = [&](std::string text, MakeTabulated* make, const auto& change) {
    TabulatedTuning tuning;
    change(tuning);
    all.push_back({std::move(text), make, tuning});
  };
  const auto text = [](const char* format, auto... values) {
    char line[100];
    std::snprintf(line, sizeof line, format, values...);
    return std::string(line);
  };
  for (const int slices : {16, 32}) {
    for (const int nodes : {32, 64, 128}) {
      add(text("cdf-table, %d x %d^2", slices, nodes), make_cdf_table,
          [&](TabulatedTuning& t) { t.slices = slices, t.nodes = nodes; });
    }
  }
  add("alias-table, 32 x 64^2", make_alias_table, [](TabulatedTuning&) {});
  for (const int n : {1, 2, 4, 8}) {
    for (const int k : {1, 2, 4}) {
      add(text("factored, J %d, K %d, 64 x 32", n, k), make_factored,
          [&](TabulatedTuning& t) { t.factored.outer_terms = n, t.factored.inner_terms = k; });
    }
  }
  for (const int width : {32, 128}) {
    add(text("factored, J 4, K 2, %d x %d", width, width / 2), make_factored,
        [&](TabulatedTuning& t) { t.factored.width = width, t.factored.height = width / 2; });
  }
  for (const double floor : {0.0, 1e-4, 1e-2}) {
    add(text("factored, J 4, K 2, 64 x 32, floor %g", floor), make_factored,
        [&](TabulatedTuning& t) { t.factored.floor = float(floor); });
  }
  for (const double tolerance : {4e-3, 1e-3, 2.5e-4}) {
    for (const int cells : {128, 256}) {
      add(text("adaptive-cdf, %d^2, tolerance %g", cells, tolerance), make_adaptive_cdf,
          [&](TabulatedTuning& t) {
            t.cells = cells;
            t.curve = {float(tolerance), float(4 * tolerance)};
          });
    }
  }
  for (const double dropped : {1e-2, 1e-3, 1e-4}) {
    for (const int cells : {64, 128, 256}) {
      add(text("wavelet, %d^2, dropped %g", cells, dropped), make_wavelet,
          [&](TabulatedTuning& t) { t.cells = cells, t.dropped_energy = dropped; });
    }
  }
  for (const double floor : {0.0, 1e-4, 1e-3, 1e-2}) {
    add(text("adaptive-cdf, floor %g", floor), make_adaptive_cdf,
        [&](TabulatedTuning& t) { t.node_floor = t.cell_floor = float(floor); });
    add(text("wavelet, floor %g", floor), make_wavelet,
        [&](TabulatedTuning& t) { t.node_floor = t.cell_floor = float(floor); });
    add(text("cdf-table, floor %g", floor), make_cdf_table,
        [&](TabulatedTuning& t) { t.node_floor = t.cell_floor = float(floor); });
  }
  for (const int slices : {8, 16, 32}) {
    for (const int nodes : {32, 64}) {
      add(text("warp-chain, %d x %d^2", slices, nodes), make_warp_chain,
          [&](TabulatedTuning& t) { t.warp.slices = slices, t.warp.target_nodes = nodes; });
    }
  }
  add("warp-chain, 16 x 32^2, normals 64 x 32", make_warp_chain,
      [](TabulatedTuning& t) { t.warp.normals_width = 64, t.warp.normals_height = 32; });
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "How the tabulated competitors were tuned, as Markdown: memory, build and variance against their "
      "options. "
      "Measured files are those of REFLECTREE_DATA.");
  int samples = 100'000;
  std::string only;
  app.add_option("--samples", samples, "per cell")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--only", only, "competitors whose name contains this");
  return study::run_program(app, argc, argv, [&] {
    const std::vector<TuningSubject> all = subjects();
    std::printf("| peer | KiB | build s | variance * KiB | worst bias, sigmas |");
    for (const TuningSubject& subject : all) std::printf(" %s |", subject.name.c_str());
    std::printf("\n|---|---|---|---|---|");
    for (std::size_t i = 0; i < all.size(); ++i) std::printf("---|");
    std::printf("\n");
    for (const Variant& variant : variants()) {
      if (variant.text.find(only) == std::string::npos) continue;
      double kib = 0, seconds = 0, product = 0, bias = 0, sigmas = 0;
      std::string cells;
      for (const TuningSubject& subject : all) {
        const Measured m = measure(subject, variant.make, variant.tuning, samples);
        const double n = double(all.size());
        kib += m.kib / n, seconds += m.seconds / n,
            product += std::log(std::max(m.variance, 1e-6) * m.kib) / n;
        if (std::abs(m.sigmas) > std::abs(sigmas)) sigmas = m.sigmas, bias = m.bias;
        char cell[80];
        std::snprintf(cell, sizeof cell, " %.2g / %.2g |", m.variance, m.worst);
        cells += cell;
      }
      std::printf("| %s | %.0f | %.2f | %.3g | %+.1e, %+.1f |%s\n", variant.text.c_str(), kib, seconds,
                  std::exp(product), bias, sigmas, cells.c_str());
      std::fflush(stdout);
    }
    return 0;
  });
}
