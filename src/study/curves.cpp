// SPDX-License-Identifier: Apache-2.0
// Error against the number of samples, with rotations drawn one by one: for stratified points there is no
// closed form over them.
#include "reflectree/math/low_discrepancy.hpp"
#include "reflectree/study/measure.hpp"

namespace reflectree::study {

namespace {

// Shoemake 1992, "Uniform random rotations": a unit quaternion from three uniform numbers.
struct Rotation {
  Vec3<double> v;
  double w = 1;
  explicit Rotation(Pcg32& u) {
    const double a = to_unit_double(u()), b = 2 * pi_v<double> * to_unit_double(u()),
                 c = 2 * pi_v<double> * to_unit_double(u());
    const double p = std::sqrt(1 - a), q = std::sqrt(a);
    v = {p * std::sin(b), p * std::cos(b), q * std::sin(c)};
    w = q * std::cos(c);
  }
  Direction operator()(Direction d) const {
    const Vec3<double> x{d.x, d.y, d.z}, t = 2. * cross(v, x), y = x + w * t + cross(v, t);
    return {float(y.x), float(y.y), float(y.z)};
  }
};

using Sums = std::vector<double>;  // per channel

// The running sums of one run at n = 1, 4, 16, ...: at[light][step][channel].
using Run = std::vector<std::vector<Sums>>;

Run run(const AnySampler<Spectrum>& sampler, Direction wo, std::span<const Illumination> lights,
        const Rotation& rotate, std::span<const std::uint32_t> steps, std::uint64_t seed, bool stratified) {
  Run at(lights.size());
  std::vector<Sums> sum(lights.size());
  UniformBits bits{Pcg32(seed, 3)};
  std::size_t next = 0;
  for (std::uint32_t i = 0; next < steps.size(); ++i) {
    const auto scramble = std::uint32_t(seed);
    const UniformBits point({scrambled_sobol_bits(i, 0, scramble), scrambled_sobol_bits(i, 1, scramble)},
                            Pcg32(seed + i, 4));
    if (stratified) bits = point;
    if (const auto s = sampler.sample(wo, bits)) {
      const Direction w = rotate(s->wi);
      for (std::size_t e = 0; e < lights.size(); ++e) {
        sum[e].resize(std::size_t(s->weight.channels()));
        const auto l = double(lights[e].map.at(w));
        for (int c = 0; c < s->weight.channels(); ++c) sum[e][std::size_t(c)] += l * double(s->weight[c]);
      }
    }
    if (i + 1 == steps[next]) {
      for (std::size_t e = 0; e < lights.size(); ++e) at[e].push_back(sum[e]);
      ++next;
    }
  }
  return at;
}

}  // namespace

std::vector<ErrorCurve> measure_curves(const AnySampler<Spectrum>& sampler, Direction wo, double albedo,
                                       std::span<const Illumination> lights, const StudyOptions& o,
                                       std::uint64_t seed) {
  constexpr int runs = 4;  // with one rotation
  std::vector<std::uint32_t> steps;
  for (std::uint32_t n = 1; n <= o.curve_samples; n *= 4) steps.push_back(n);
  std::vector<ErrorCurve> curves(lights.size());
  for (ErrorCurve& c : curves) {
    c.n = steps;
    c.random.assign(steps.size(), 0), c.stratified.assign(steps.size(), 0);
  }
  const int rotations = std::max(1, o.curve_repeats / runs);
  Pcg32 u(seed, 2);
  for (int r = 0; r < rotations; ++r) {
    const Rotation rotate(u);
    for (const bool stratified : {false, true}) {
      std::vector<Run> all;
      for (int k = 0; k < runs; ++k) {
        all.push_back(run(sampler, wo, lights, rotate, steps,
                          seed + std::uint64_t(r * runs + k) * 0x9e3779b97f4a7c15ULL, stratified));
      }
      for (std::size_t e = 0; e < lights.size(); ++e) {
        for (std::size_t i = 0; i < steps.size(); ++i) {
          double mean_square = 0;
          std::vector<double> mean;
          for (const Run& one : all) {
            const Sums& s = one[e][i];
            mean.resize(std::max(mean.size(), s.size()));
            for (std::size_t c = 0; c < s.size(); ++c)
              mean_square += s[c] * s[c] / runs, mean[c] += s[c] / runs;
          }
          for (const double m : mean) mean_square -= m * m;
          const double scale = double(steps[i]) * lights[e].mean * albedo;
          auto& curve = stratified ? curves[e].stratified : curves[e].random;
          curve[i] += max(0., mean_square) * runs / (runs - 1) / (scale * scale) / rotations;
        }
      }
    }
  }
  return curves;
}

}  // namespace reflectree::study
