// SPDX-License-Identifier: Apache-2.0
// Medians over the materials of a table of fits (such as the 100 SGD fits of MERL): relative standard
// deviation of the weight's target, for the samplers that know a material by a few numbers. Printed as the
// Markdown of its table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/verify/reference.hpp"
#include "study_program.hpp"

namespace reflectree {
namespace {

constexpr const char* names[] = {"cosine", "proxy", "proxy-oracle"};
constexpr double thetas_deg[] = {10, 45, 75};

// sqrt(int T^2 / p / (int T)^2 - 1) by cubature: the heavy tails of a cosine lobe hide from samples.
double relative_deviation(const AnySampler<Spectrum>& sampler, const TargetFunction& f, Direction wo) {
  ReferenceOptions options;
  options.relative_tolerance = 1e-3;
  options.max_evaluations = 100'000;
  options.mirror_symmetric = true;
  const double mean = reference_albedo(f, wo, options).value;
  const TargetFunction moment{[&](Vec3<double> o, std::span<const Vec3<double>> wi, std::span<double> t) {
    f.eval(o, wi, t);
    for (std::size_t i = 0; i < wi.size(); ++i) {
      const double p = double(sampler.pdf(wo, {float(wi[i].x), float(wi[i].y), float(wi[i].z)}));
      t[i] = t[i] > 0 && p > 0 ? t[i] * t[i] * wi[i].z / p : 0;
    }
  }};
  return std::sqrt(std::max(0.0, reference_albedo(moment, wo, options).value / (mean * mean) - 1));
}

double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[std::size_t(q * double(values.size() - 1) + 0.5)];
}

int run(const std::string& path, Target target) {
  const std::vector<std::string> members = list_members(path);
  std::printf("| sampler | theta_o | median | 90th percentile |\n|---|---|---|---|\n");
  for (const char* name : names) {
    std::vector<double> deviations[std::size(thetas_deg)];
    for (const std::string& member : members) {
      const PeerSubject subject{load_brdf(path, member), {}, target};
      const auto sampler = find_sampler(name)->make(subject, {});
      if (!sampler) continue;
      for (std::size_t k = 0; k < std::size(thetas_deg); ++k) {
        const Direction wo = direction_from_angles(float(thetas_deg[k] * pi_v<double> / 180), 0.f);
        deviations[k].push_back(relative_deviation(*sampler, target_function(subject.f, target), wo));
      }
    }
    for (std::size_t k = 0; k < std::size(thetas_deg); ++k) {
      std::printf("| %s | %g | %.3f | %.3f |\n", name, thetas_deg[k], quantile(deviations[k], 0.5),
                  quantile(deviations[k], 0.9));
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace reflectree

int main(int argc, char** argv) {
  CLI::App app("How far samplers that know a material by a few numbers vary, as Markdown.");
  std::string fits;
  reflectree::Target target;
  bool luminance = false;
  app.add_option("FITS.csv", fits, "a table of fits, one material per line")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_flag("--luminance", luminance, "aim at luminance, not at the norm of the channels");
  return reflectree::study::run_program(app, argc, argv, [&] {
    if (luminance) target.kind = reflectree::TargetKind::luminance;
    return reflectree::run(fits, target);
  });
}
