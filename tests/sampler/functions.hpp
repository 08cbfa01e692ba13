// SPDX-License-Identifier: Apache-2.0
// Functions to sample, directions, threads and verdicts that the tests of the sampler share.
#pragma once

#include <cmath>
#include <thread>
#include <vector>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/verify/chi_square.hpp"

namespace reflectree {

inline Direction wo_at(double theta_deg, double phi = 0) {
  const double theta = theta_deg * pi_v<double> / 180, s = std::sin(theta);
  return {float(s * std::cos(phi)), float(s * std::sin(phi)), float(std::cos(theta))};
}

inline AnyBrdf material(const char* text) { return make_brdf(parse_material(text)); }

// A lobe about the direction that lies at (theta, phi) from the azimuth of wo, on a matt ground:
// phi = pi is forwards; any other than 0 and pi breaks mirror symmetry.
struct Bump {
  float theta, phi, width, height;
  float operator()(Direction wo, Direction wi) const {
    const float s = sqrt(wo.x * wo.x + wo.y * wo.y);
    const float c_o = s > 0 ? wo.x / s : 1, s_o = s > 0 ? wo.y / s : 0;
    const Direction local{wi.x * c_o + wi.y * s_o, wi.y * c_o - wi.x * s_o, wi.z};
    const Direction centre = direction_from_angles(theta, phi), d = local - centre;
    return 0.2f + height * exp(-dot(d, d) / (width * width));
  }
};

// Isotropic, and brighter on one side of the plane of incidence.
struct Lopsided {
  float amount;
  float operator()(Direction wo, Direction wi) const {
    return 0.3f * (1 + amount * (wo.x * wi.y - wo.y * wi.x));
  }
};

// Lopsided where wo grazes, and there alone; a mean over all wo hardly tells.
struct LopsidedAtGrazing {
  float operator()(Direction wo, Direction wi) const {
    const float side = wo.x * wi.y - wo.y * wi.x;
    return 0.3f + 0.25f * max(0.f, 1 - 4 * wo.z) * side / sqrt(0.02f + side * side);
  }
};

// (mean over calls - expected) / standard error.
template <class Call>
double z_score(double expected, int calls, Call&& call) {
  double sum = 0, square = 0;
  for (int i = 0; i < calls; ++i) {
    const double x = call();
    sum += x, square += x * x;
  }
  const double mean = sum / calls, variance = square / calls - mean * mean;
  return (mean - expected) / std::sqrt(variance / (calls - 1));
}

// Runs every loop on `threads` threads in uneven chunks, the last chunks first.
inline Host uneven_threads(int threads) {
  Host host;
  host.parallel_for = [threads](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::vector<std::pair<std::size_t, std::size_t>> chunks;
    for (std::size_t begin = 0, size = 1; begin < n; begin += size, size = size % 7 + 1) {
      chunks.insert(chunks.begin(), {begin, std::min(n, begin + size)});
    }
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t) {
      pool.emplace_back([&, t] {
        for (std::size_t i = std::size_t(t); i < chunks.size(); i += std::size_t(threads)) {
          body(chunks[i].first, chunks[i].second);
        }
      });
    }
    for (std::thread& t : pool) t.join();
  };
  return host;
}

// Both modes against a target function: the counts of exact mode, the weights of both.
inline std::vector<CheckResult> judge(const ErasedSampler& exact, const ErasedSampler& one_shot,
                                      const TargetFunction& f, Direction wo,
                                      std::uint64_t samples = 200'000) {
  ChiSquareOptions options;
  options.samples = samples;
  options.tests = 200;  // what all tests of the room together do, about
  const Bins bins = equal_mass_bins(f, wo);
  const Tally e = tally_of(exact, bins, options);
  options.seed = 2;
  const Tally o = tally_of(one_shot, bins, options);
  return {check_counts(e, bins, options), check_weights(e, bins, options), check_weights(o, bins, options),
          check_mean_weight(o, bins, options)};
}
template <class F>
std::vector<CheckResult> judge(const Sampler<F>& s, const TargetFunction& f, Direction wo,
                               std::uint64_t samples = 200'000) {
  const Target target = s.exact.packed().target;
  return judge(erase(s.exact, target, "exact"), erase(s.one_shot, target, "one-shot"), f, wo, samples);
}
inline std::string to_text(const std::vector<CheckResult>& results) {
  std::string text;
  for (const CheckResult& r : results) text += to_line(r) + "\n";
  return text;
}

}  // namespace reflectree
