// SPDX-License-Identifier: Apache-2.0
// One sampler at one wo: moments of its weight, by its own samples or by those of exact mode.
#include "reflectree/study/measure.hpp"

namespace reflectree::study {

namespace {

using Draws = std::vector<DirectionSample<Spectrum>>;

constexpr std::size_t group = 16;  // samples whose pairs give the variance under a light

// Mean and variance of one number, by Welford 1962.
struct Moments {
  double n = 0, mean = 0, m2 = 0;
  void add(double x) {
    n += 1;
    const double d = x - mean;
    mean += d / n;
    m2 += d * (x - mean);
  }
  double variance() const { return n > 1 ? m2 / (n - 1) : 0; }
  double standard_error() const { return n > 0 ? std::sqrt(variance() / n) : 0; }
  double mean_square() const { return mean * mean + (n > 0 ? m2 / n : 0); }
};

// E[x] and E[x^2] of the target, the channel sum, and every channel.
struct Square {
  double mean = 0, square = 0;
  double relative() const { return mean > 0 ? max(0., square / (mean * mean) - 1) : 0; }
};
struct Weights {
  Square target, sum;
  std::vector<Square> channels;
  double target_square_error = 0;  // standard error of target.square
  double total() const {
    double t = 0;
    for (const Square& s : channels) t += s.square;
    return t;
  }
};

double product(const Spectrum& a, const Spectrum& b) {
  double sum = 0;
  for (int c = 0; c < std::min(a.channels(), b.channels()); ++c) sum += double(a[c]) * double(b[c]);
  return sum;
}
double sum_of(const Spectrum& w) {
  double sum = 0;
  for (int c = 0; c < w.channels(); ++c) sum += double(w[c]);
  return sum;
}

// The mean of w.w' C over the pairs of each group: the mean square of the mean radiance; illumination.hpp.
double mean_product(std::span<const DirectionSample<Spectrum>> draws, const Illumination& light) {
  double sum = 0;
  for (std::size_t from = 0; from + group <= draws.size(); from += group) {
    for (std::size_t i = from + 1; i < from + group; ++i) {
      for (std::size_t k = from; k < i; ++k) {
        const double w = product(draws[i].weight, draws[k].weight);
        if (w > 0) sum += w * light.correlation_at(double(dot(draws[i].wi, draws[k].wi)));
      }
    }
  }
  const double pairs = double(draws.size() / group) * double(group * (group - 1)) / 2;
  return pairs > 0 ? sum / pairs : 0;
}

// Every sample as it comes; none weighs nothing.
Draws draws_of(const AnySampler<Spectrum>& sampler, Direction wo, std::uint32_t n, UniformBits& u) {
  Draws draws;
  draws.reserve(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto s = sampler.sample(wo, u);
    draws.push_back(s ? *s : DirectionSample<Spectrum>{{0, 0, 1}, 0, Spectrum(0), 0});
  }
  return draws;
}

int channels_of(const Draws& draws) {
  int most = 0;
  for (const auto& d : draws) most = std::max(most, d.weight.channels());
  return most;
}

Weights weights_of(const Draws& draws, const Target& target, Moments& of_target) {
  Moments sum, squares;
  std::vector<Moments> channels(std::size_t(channels_of(draws)));
  for (const auto& d : draws) {
    const Spectrum& w = d.weight;
    for (std::size_t c = 0; c < channels.size(); ++c)
      channels[c].add(int(c) < w.channels() ? double(w[int(c)]) : 0);
    const double t = w.channels() ? double(target(w)) : 0;
    sum.add(sum_of(w)), of_target.add(t), squares.add(t * t);
  }
  const auto square = [](const Moments& m) { return Square{m.mean, m.mean_square()}; };
  Weights all{square(of_target), square(sum), {}, squares.standard_error()};
  for (const Moments& m : channels) all.channels.push_back(square(m));
  return all;
}

// The same of a density p, at the draws of exact mode; draws where p = 0 are marked as never drawn.
Weights weights_by_density(const AnySampler<Spectrum>& sampler, const Target& target, Direction wo,
                           Draws& draws) {
  Weights all;
  all.channels.resize(std::size_t(channels_of(draws)));
  Moments squares;
  const double n = double(draws.size());
  for (auto& d : draws) {
    const float p = d.weight.channels() ? sampler.pdf(wo, d.wi) : 0;
    if (!(p > 0)) {
      d.weight = Spectrum(0);
      squares.add(0);
      continue;
    }
    const double r = double(d.pdf) / double(p), t = double(target(d.weight)), s = sum_of(d.weight);
    all.target.mean += t / n, squares.add(t * t * r);
    all.sum.mean += s / n, all.sum.square += s * s * r / n;
    for (int c = 0; c < d.weight.channels(); ++c) {
      const auto w = double(d.weight[c]);
      Square& channel = all.channels[std::size_t(c)];
      channel.mean += w / n, channel.square += w * w * r / n;
    }
  }
  all.target.square = squares.mean, all.target_square_error = squares.standard_error();
  return all;
}

}  // namespace

ReferenceDraws reference_draws(const AnySampler<Spectrum>& exact, Direction wo,
                               std::span<const Illumination> lights, const StudyOptions& o,
                               std::uint64_t seed) {
  UniformBits u{Pcg32(seed, 5)};
  ReferenceDraws reference{draws_of(exact, wo, o.samples, u), {}};
  for (const Illumination& light : lights) reference.products.push_back(mean_product(reference.draws, light));
  return reference;
}

StudyCell measure_cell(const AnySampler<Spectrum>& sampler, const Target& target, Direction wo, double albedo,
                       double albedo_error, std::span<const Illumination> lights, const StudyOptions& o,
                       std::uint64_t seed, const ReferenceDraws* reference) {
  UniformBits u{Pcg32(seed, 1)};
  Draws draws = draws_of(sampler, wo, o.samples, u);
  Moments of_target;
  Weights weights = weights_of(draws, target, of_target);
  StudyCell cell;
  for (const auto& d : draws)
    cell.dead += !(d.weight.channels() && target(d.weight) > 0) / double(draws.size());
  if (reference && sampler.has_pdf()) {
    Draws common = reference->draws;
    const Weights known = weights_by_density(sampler, target, wo, common);
    const double most = known.target.square + 5 * (known.target_square_error + weights.target_square_error);
    const double spread = std::sqrt(max(0., known.target.square - sqr(known.target.mean)) / of_target.n);
    // The table of exact mode's albedo is right to 1e-4.
    const bool same_mean =
        std::abs(of_target.mean - known.target.mean) <= 5 * spread + 1.5e-4 * known.target.mean;
    cell.by_density = same_mean && weights.target.square <= most * 1.01;
    if (cell.by_density) weights = known, draws = std::move(common);
  }
  cell.target_variance = weights.target.relative();
  cell.sum_variance = weights.sum.relative();
  for (const Square& s : weights.channels) cell.worst_variance = max(cell.worst_variance, s.relative());
  cell.bias = of_target.mean / albedo - 1;
  const double variance = max(0., weights.target.square - sqr(weights.target.mean));
  const double se = std::sqrt(variance / of_target.n) / albedo, open = albedo_error / albedo;
  cell.bias_interval = 1.96 * se + open;
  // The albedo of exact mode is tabulated to 1e-4 by design: a stated error, not a bias of the method.
  cell.biased = std::abs(cell.bias) > 5 * se + open + 1.5e-4;
  // Where the density misses nothing the products are the reference's own.
  const bool whole = cell.by_density && std::none_of(draws.begin(), draws.end(),
                                                     [](const auto& d) { return d.weight.channels() == 0; });
  for (std::size_t e = 0; e < lights.size(); ++e) {
    const double products = whole ? reference->products[e] : mean_product(draws, lights[e]);
    const double one = max(0., lights[e].mean_square * weights.total() - products);
    cell.error.push_back(one / sqr(lights[e].mean * albedo) + o.mean_of * sqr(cell.sure_bias()));
  }
  return cell;
}

}  // namespace reflectree::study
