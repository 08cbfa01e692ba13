// SPDX-License-Identifier: Apache-2.0
// What the studies' tables say of a sampler: cost and worth over a few elevations, on one thread.
#pragma once

#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "reflectree/sampler/sampler.hpp"
#include "reflectree/study/measure.hpp"
#include "reflectree/study/thread_time.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree::study {

inline Direction wo_at_deg(double deg) { return direction_from_angles(float(deg * pi_v<double> / 180), 0.f); }

// A function with what is true of it at some elevations.
struct JudgedSubject {
  std::string name;
  AnyBrdf f;
  std::vector<double> thetas_deg;
  std::vector<double> albedo, albedo_error;
  std::vector<ReferenceDraws> reference;
};
inline JudgedSubject subject_of(std::string name, const AnyBrdf& f, std::vector<double> thetas_deg,
                                std::span<const Illumination> lights, const StudyOptions& o) {
  JudgedSubject s{std::move(name), f, std::move(thetas_deg), {}, {}, {}};
  const TargetFunction target = target_function(f);
  const auto exact = find_sampler("exact")->make({f, {}, {}, nullptr}, {});
  for (const double deg : s.thetas_deg) {
    const auto a = reference_albedo(target, wo_at_deg(deg));
    s.albedo.push_back(a.value), s.albedo_error.push_back(a.error);
    s.reference.push_back(reference_draws(*exact, wo_at_deg(deg), lights, o, 23));
  }
  return s;
}

struct Judged {
  double x_floor = 0;                   // time of a sample, in polar cosine-hemisphere samples (*)
  double ns = 0;                        // (*)
  double worst_bias = 0, interval = 0;  // and half the 95 % interval there
  double worst_variance = 0;
  double cost = 0;  // geometric mean of RMSE^2 x time over elevations and lights (*)
  double dead = 0;  // mean share
};

inline Judged judged(const AnySampler<Spectrum>& sampler, const JudgedSubject& s,
                     std::span<const Illumination> lights, const StudyOptions& o) {
  Judged j;
  double sum = 0, logs = 0, n = 0;
  Pcg32 g(5, 5);
  std::vector<Direction> wo(512);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const double deg = s.thetas_deg[i % s.thetas_deg.size()];
    wo[i] = direction_from_angles(float(deg * pi_v<double> / 180), 2 * pi * to_unit_float(g()));
  }
  UniformBits u{Pcg32(3)};
  const double floor = 1e9 * median_seconds(2e-3, [&](std::size_t) {
                         const float r2 = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(r2);
                         sum += double(r * cos(phi) + r * sin(phi) + sqrt(1 - r2));
                       });
  j.ns = 1e9 * median_seconds(2e-3, [&](std::size_t i) {
           if (const auto d = sampler.sample(wo[i % 512], u)) sum += double(d->pdf);
         });
  volatile double used = sum;
  (void)used;
  j.x_floor = j.ns / floor;
  for (std::size_t i = 0; i < s.thetas_deg.size(); ++i) {
    const StudyCell c = measure_cell(sampler, {}, wo_at_deg(s.thetas_deg[i]), s.albedo[i], s.albedo_error[i],
                                     lights, o, 7 + i, &s.reference[i]);
    if (std::abs(c.bias) >= std::abs(j.worst_bias)) j.worst_bias = c.bias, j.interval = c.bias_interval;
    j.worst_variance = max(j.worst_variance, c.target_variance);
    j.dead += c.dead / double(s.thetas_deg.size());
    for (const double e : c.error) logs += std::log(e * j.x_floor), n += 1;
  }
  j.cost = n > 0 ? std::exp(logs / n) : 0;
  return j;
}

// Least squares of log y over log x.
inline double log_slope(std::span<const double> x, std::span<const double> y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) continue;
    const double lx = std::log(x[i]), ly = std::log(y[i]);
    n += 1, sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace reflectree::study
