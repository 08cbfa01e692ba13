// SPDX-License-Identifier: Apache-2.0
#include "physics.hpp"

#include <cstdio>

#include "elevations.hpp"
#include "findings.hpp"
#include "parallel.hpp"

namespace reflectree::detail {
namespace {

double asymmetry(std::span<const double> a, std::span<const double> b) {
  double difference = 0, total = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!sane(a[i]) || !sane(b[i])) continue;
    difference += std::abs(a[i] - b[i]);
    total += std::max(a[i], b[i]);
  }
  return total > 0 ? difference / total : 0;
}

}  // namespace

Pairs random_pairs(std::size_t count, std::uint64_t seed) {
  Pairs pairs;
  Pcg32 u = part_generator(seed, 33);
  for (std::size_t i = 0; i < count; ++i) {
    const auto any = [&] {
      return viewer(0.1 + 0.9 * to_unit_double(u()), 2 * pi_v<double> * to_unit_double(u()));
    };
    const Direction wo = any();
    Direction wi = any();
    if (i % 2 == 1) {
      const double far = std::pow(10., -2 * to_unit_double(u()));
      Vec3<double> w{-wo.x + far * (wi.x + wo.x), -wo.y + far * (wi.y + wo.y), wo.z + far * (wi.z - wo.z)};
      w = normalize(w);
      wi = {float(w.x), float(w.y), float(w.z)};
    }
    pairs.wo.push_back(wo), pairs.wi.push_back(wi);
  }
  return pairs;
}

Reciprocity reciprocity_of(const Functions& raw, std::uint64_t seed, std::size_t count) {
  const Pairs pairs = random_pairs(count, seed);
  std::vector<double> a = raw.raw(pairs.wo, pairs.wi), b = raw.raw(pairs.wi, pairs.wo);
  Reciprocity r;
  r.f = asymmetry(a, b);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] /= double(pairs.wi[i / raw.channels()].z);
    b[i] /= double(pairs.wo[i / raw.channels()].z);
  }
  r.f_cos = asymmetry(a, b);
  return r;
}

void remark_on_physics(const Functions& f, std::span<const ExaminedView> views, std::uint64_t seed,
                       Diagnosis& d) {
  const Reciprocity r = reciprocity_of(f, mixed_seed(seed, 36), 4000);
  const double off = f.eval_kind() == EvalKind::f ? r.f : r.f_cos;
  d.figures.push_back({"mean_miss_of_reciprocity", "", off});
  char buffer[160];
  if (off > 0.01) {
    std::snprintf(buffer, sizeof buffer,
                  "f is not reciprocal: f(wi, wo) differs from f(wo, wi) by %.2g %% in the mean", 100 * off);
    d.findings.push_back(a_finding("reciprocity", "not_reciprocal", buffer, {}, false));
  }
  double most = 0;
  const ExaminedView* where = nullptr;
  for (const ExaminedView& view : views) {
    for (const double a : view.channel_albedo) {
      if (a > most) most = a, where = &view;
    }
  }
  d.figures.push_back({"largest_albedo", where ? where->where : "", most});
  if (most > 1.01) {
    std::snprintf(buffer, sizeof buffer, "f reflects more light than it receives: albedo %.4g at %s", most,
                  where->where.c_str());
    d.findings.push_back(a_finding("energy", "gains_energy", buffer, {}, false));
  }
}

}  // namespace reflectree::detail
