// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/furnace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "parallel.hpp"
#include "reflectree/math/sum.hpp"

namespace reflectree {
namespace {

struct Comparison {
  double theta_o, table, reference, excess;  // excess: relative difference over its tolerance
};

}  // namespace

CheckResult check_albedo_table(const std::function<double(Direction wo)>& albedo, const TargetFunction& f,
                               const FurnaceOptions& options, const Host& host) {
  const auto directions = std::size_t(options.directions);
  std::vector<Comparison> list(options.cosines.size() + directions + 1);
  Pcg32 u = detail::part_generator(options.seed, 0);
  for (std::size_t i = 0; i < directions; ++i) list[i].theta_o = options.max_theta_o * to_unit_double(u());
  for (std::size_t i = 0; i < options.cosines.size(); ++i) {
    list[directions + i].theta_o = pi_v<double> / 2 - std::asin(std::min(options.cosines[i], 1.));
  }
  // Every place at an azimuth of its own.
  std::vector<double> phi;
  for (std::size_t i = 0; i < list.size(); ++i) phi.push_back(2 * pi_v<double> * to_unit_double(u()));
  list.back().theta_o = options.grazing_theta_o;
  detail::for_each_index(host, f.concurrent, list.size(), [&](std::size_t i) {
    Comparison& c = list[i];
    const double s = std::sin(c.theta_o), z = std::sin(pi_v<double> / 2 - c.theta_o);
    const Direction wo{float(s * std::cos(phi[i])), float(s * std::sin(phi[i])), float(z)};
    const double tolerance = c.theta_o > options.max_theta_o ? options.grazing_tolerance : options.tolerance;
    ReferenceOptions reference_options;
    reference_options.relative_tolerance = 0.2 * tolerance;
    reference_options.max_evaluations = options.max_evaluations;
    CubatureResult reference = reference_albedo(f, wo, reference_options);
    c.table = albedo(wo);
    const auto excess = [&] {
      const double difference = std::abs(c.table - reference.value);
      return difference == 0 ? 0 : difference / (tolerance * reference.value);
    };
    if (excess() > 1) {  // kinks deceive one cubature in twenty: a tighter one decides
      reference_options.relative_tolerance *= 0.05;
      reference_options.max_evaluations *= 4;
      reference = reference_albedo(f, wo, reference_options);
    }
    const double allowed = tolerance * reference.value;
    c.reference = reference.value;
    c.excess = excess();
    if (!std::isfinite(c.excess) || reference.error > 20 * allowed) c.excess = INFINITY;
  });
  const auto worst = *std::max_element(
      list.begin(), list.end(), [](const Comparison& a, const Comparison& b) { return a.excess < b.excess; });
  CheckResult result;
  result.name = "albedo_table";
  result.statistic = worst.excess;
  result.threshold = 1;
  result.passed = worst.excess <= 1;
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "worst of %zu at theta_o %.4f deg: table %.8g, cubature %.8g",
                list.size(), worst.theta_o * 180 / pi_v<double>, worst.table, worst.reference);
  result.detail = buffer;
  return result;
}

CheckResult check_albedo_estimates(const std::string& name, const AlbedoEstimate& estimate,
                                   const TargetFunction& f, Direction wo, std::uint64_t count,
                                   std::uint64_t seed, const Host& host) {
  constexpr std::uint64_t chunk = 1 << 16;
  const std::uint64_t chunks = (count + chunk - 1) / chunk;
  std::vector<double> sums(chunks), squares(chunks);
  detail::for_each_index(host, f.concurrent, chunks, [&](std::size_t c) {
    Pcg32 u = detail::part_generator(seed, c);
    for (std::uint64_t i = std::min(chunk, count - c * chunk); i > 0; --i) {
      const double x = estimate(wo, u);
      sums[c] += x;
      squares[c] += x * x;
    }
  });
  CompensatedSum sum, square;
  for (std::size_t c = 0; c < chunks; ++c) sum += sums[c], square += squares[c];
  const double n = double(count), mean = sum.value() / n;
  const double error = std::sqrt(std::max(square.value() / n - mean * mean, 0.) / (n - 1));
  const CubatureResult reference = reference_albedo(f, wo);
  CheckResult result;
  result.name = name;
  result.statistic = std::abs(mean - reference.value);
  result.threshold = 4 * error + reference.error + 1e-6 * reference.value;  // float weights
  result.passed = result.statistic <= result.threshold;
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "mean %.8g, cubature %.8g, standard error %.2g", mean, reference.value,
                error);
  result.detail = buffer;
  return result;
}

}  // namespace reflectree
