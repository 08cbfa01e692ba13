// SPDX-License-Identifier: Apache-2.0
// materials x samplers x theta_o: what each sampler costs and what it is worth. Everything but the timings
// depends on the seed alone, never on threads or on which other samplers are measured.
#pragma once

#include <optional>

#include "reflectree/peers/registry.hpp"
#include "reflectree/study/illumination.hpp"
#include "reflectree/study/slices.hpp"

namespace reflectree::study {

struct StudyOptions {
  std::vector<double> theta_o_deg{10, 45, 75, 85};
  double phi_o_deg = 37;  // azimuth of wo where the function depends on it: on no axis, at no node of a table
  std::uint32_t samples = 1U << 16U;  // per cell; a multiple of 16
  std::uint32_t mean_of = 1024;       // samples in the mean whose RMSE counts: there bias tells
  int curve_repeats = 32;             // runs behind each point of an error curve
  std::uint32_t curve_samples = 1024;
  double round_seconds = 2e-3;  // a seventh of the time spent on a timing
  std::size_t cubature_evaluations = 1'000'000;
  std::uint64_t seed = 1;
  friend bool operator==(const StudyOptions&, const StudyOptions&) = default;
};
// Fewer samples: seconds for each material and sampler.
inline StudyOptions quick_study() {
  StudyOptions o;
  o.samples = 1U << 13U, o.round_seconds = 5e-4, o.curve_repeats = 8, o.cubature_evaluations = 200'000;
  o.curve_samples = 256;
  return o;
}

// One sampler at one theta_o. "No sample" counts as weight 0.
struct StudyCell {
  double target_variance = 0, sum_variance = 0, worst_variance = 0;  // relative, of the weight
  double dead = 0;                                                   // share of weight 0 and of none
  bool by_density = false;             // the variances are from draws of exact mode: see ReferenceDraws
  double bias = 0, bias_interval = 0;  // mean weight / cubature - 1, and half its 95 % interval
  bool biased = false;                 // beyond five standard errors and what cubature leaves open
  // What is left of |bias| without its interval: no method pays for what cannot be told from noise.
  double sure_bias() const { return std::max(0., std::abs(bias) - bias_interval); }
  double sample_ns = 0, pdf_ns = 0, floor_ns = 0;  // pdf_ns 0: no density; floor: polar cosine hemisphere
  // Per light: N RMSE^2 of the mean of N = mean_of samples, relative to (mean light * albedo)^2: the variance
  // of one sample + N sure_bias^2. Under a light that is not uniform the bias may be larger, never smaller in
  // the mean: a biased method is let off lightly.
  std::vector<double> error;
  double efficiency(std::size_t light) const { return 1 / (error[light] * sample_ns * 1e-9); }
};

// RMSE^2, relative, of the mean of n samples under one light at theta_o = curve_theta_o_deg.
struct ErrorCurve {
  std::vector<std::uint32_t> n;
  std::vector<double> random, stratified;  // from pcg32; from Owen-scrambled Sobol' points
};
inline constexpr double curve_theta_o_deg = 45;

struct SamplerResult {
  std::string sampler;
  std::string fault;  // what building it threw; then nothing else is measured
  std::size_t bytes = 0;
  double build_seconds = 0;        // thread CPU time, one thread
  std::vector<StudyCell> cells;    // per theta_o
  std::vector<ErrorCurve> curves;  // per light
  // Per theta_o: its density in the plane of incidence at plane_angles(); empty without a density.
  std::vector<std::vector<double>> slices;
};

struct MaterialResult {
  std::string material;
  std::vector<double> albedo, albedo_error;  // per theta_o, of the target, by cubature
  std::vector<std::vector<double>> slices;   // per theta_o: the target's own
  std::vector<SamplerResult> samplers;       // those that are for this material
};

struct StudyMaterial {
  std::string name;  // as in tables
  Material material;
  AnyBrdf f;
};

// The known direction at an elevation; at azimuth 0 where the function is isotropic.
Direction study_wo(const AnyBrdf& f, double theta_o_deg, const StudyOptions& options);

// Cubature and cells at once on the host's threads. Throws Cancelled.
MaterialResult measure(const StudyMaterial& material, std::span<const SamplerInfo* const> samplers,
                       std::span<const Illumination> lights, const StudyOptions& options, const Host& host);

// Of a density p that falls far below a sharp target f, the weights that make the variance are seldom drawn,
// and it seems small. But with draws of exact mode, of density q ~ f and weights v = f / q,
//   E_p[w^2] = E_q[v^2 q / p],
// and its estimate never varies more: with r = q / p that is E_p[r^3] <= E_p[r^4], for moments grow beyond
// the first, E_p[r] = 1 (Lyapunov). So wherever a method has a density it is judged by these draws, unless
// its own samples vary more, or have another mean, than the density admits: then they are not of that
// density, and they count.
struct ReferenceDraws {
  std::vector<DirectionSample<Spectrum>> draws;  // a multiple of 16
  std::vector<double> products;                  // per light: the mean of v.v' C(angle(wi, wi'))
};
ReferenceDraws reference_draws(const AnySampler<Spectrum>& exact, Direction wo,
                               std::span<const Illumination> lights, const StudyOptions& options,
                               std::uint64_t seed);

// The parts, for tests. `reference`: null where there is none.
StudyCell measure_cell(const AnySampler<Spectrum>& sampler, const Target& target, Direction wo, double albedo,
                       double albedo_error, std::span<const Illumination> lights, const StudyOptions& options,
                       std::uint64_t seed, const ReferenceDraws* reference = nullptr);
std::vector<ErrorCurve> measure_curves(const AnySampler<Spectrum>& sampler, Direction wo, double albedo,
                                       std::span<const Illumination> lights, const StudyOptions& options,
                                       std::uint64_t seed);

// Ours, whose modes share one build.
inline bool is_ours(const SamplerInfo& info) { return info.source == "Reflectree"; }

}  // namespace reflectree::study
