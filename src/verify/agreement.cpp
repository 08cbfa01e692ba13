// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "neighbours.hpp"
#include "parallel.hpp"
#include "reflectree/verify/reference_target.hpp"

namespace reflectree {
namespace {

enum Kind { finite, pdf_agrees, weight_agrees, support, target, mode_agrees, kinds };
constexpr const char* names[kinds] = {"finite",  "pdf_agrees", "weight_agrees",
                                      "support", "target",     "mode_agrees"};

// At one viewer, by one way.
struct Counts {
  int drawn = 0;
  std::array<int, kinds> differs{};
  double worst = 0;  // relative, of whatever differed
};

Direction narrowed(Vec3<double> w) { return {float(w.x), float(w.y), float(w.z)}; }

struct Judge {
  const Suspect& s;
  const AgreementOptions& options;

  // f cos_i of each channel and t cos_i, over the neighbours of wi.
  void ranges(Direction wo, const std::array<Vec3<double>, 7>& around, std::vector<detail::Range>& f_cos,
              detail::Range& t_cos) const {
    const std::size_t channels = s.channels();
    std::vector<float> values(around.size() * channels);
    channel_values(s.f, normalize(Vec3<double>{wo.x, wo.y, wo.z}), around, values);
    f_cos.assign(channels, {});
    for (std::size_t k = 0; k < around.size(); ++k) {
      const std::span<const float> at = std::span(values).subspan(k * channels, channels);
      for (std::size_t c = 0; c < channels; ++c) f_cos[c].add(double(at[c]) * around[k].z);
      t_cos.add(reference_target(s.target, at) * around[k].z);
    }
  }

  void one(const WayIn& way, Direction wo, const DrawnAt& d, std::span<const float> weights,
           Counts& counts) const {
    bool all_finite = std::isfinite(d.wi.x) && std::isfinite(d.wi.y) && std::isfinite(d.wi.z) &&
                      std::isfinite(d.pdf) && d.pdf > 0 && d.wi.z > 0;
    for (const float w : weights) all_finite = all_finite && std::isfinite(w);
    ++counts.drawn;
    if (!all_finite) {
      ++counts.differs[finite];
      return;
    }
    const auto around = detail::neighbours(d.wi);
    std::vector<detail::Range> f_cos;
    detail::Range t_cos, pdf;
    ranges(wo, around, f_cos, t_cos);
    for (const Vec3<double>& w : around) {
      pdf.add(double((way.exact ? s.exact_pdf : s.one_shot_pdf)(wo, narrowed(w))));
    }
    counts.differs[pdf_agrees] += !pdf.holds(double(d.pdf), options.tolerance);
    // Of a channel that is dark beside the others, rounding is what the others leave.
    bool same = true;
    for (std::size_t c = 0; c < weights.size(); ++c) {
      const double product = double(weights[c]) * double(d.pdf), slack = 1e-6 * t_cos.hi;
      same = same && product >= f_cos[c].lo * (1 - options.tolerance) - slack &&
             product <= f_cos[c].hi * (1 + options.tolerance) + slack;
    }
    counts.differs[weight_agrees] += !same;
    // Below, 1 - x^2 - y^2 is rounding error: a map by way of the disk cannot know the direction.
    if (d.wi.z > 5e-4f && t_cos.lo > 0) {
      counts.differs[support] += !((way.exact ? s.one_shot_pdf : s.exact_pdf)(wo, d.wi) > 0);
    }
    if (!way.exact) return;
    const double albedo = s.albedo(wo);
    counts.differs[target] +=
        std::abs(reference_target(s.target, weights) / albedo - 1) > 1e-5 + 1e-7 * double(s.channels());
    counts.differs[mode_agrees] += !t_cos.holds(double(d.pdf) * albedo, options.tolerance);
  }
};

CheckResult verdict(Kind kind, const std::string& way, std::span<const Direction> viewers,
                    std::span<const Counts> counts, const AgreementOptions& options) {
  std::uint64_t drawn = 0, differs = 0;
  double worst = 0;
  std::size_t at = 0;
  for (std::size_t v = 0; v < counts.size(); ++v) {
    drawn += std::uint64_t(counts[v].drawn);
    differs += std::uint64_t(counts[v].differs[kind]);
    // A few of few are no share.
    const double share =
        counts[v].drawn > 0 ? double(std::max(counts[v].differs[kind] - 3, 0)) / counts[v].drawn : 0;
    if (share > worst) worst = share, at = v;
  }
  const double allowed = kind == finite ? 0 : options.max_exceptions;
  CheckResult result;
  result.name = names[kind];
  result.way = way;
  result.statistic = drawn > 0 ? double(differs) / double(drawn) : 0;
  result.threshold = allowed + (kind == finite ? 0 : 4 / double(std::max<std::uint64_t>(drawn, 1)));
  result.passed = result.statistic <= result.threshold && worst <= options.max_share;
  char buffer[200];
  std::snprintf(buffer, sizeof buffer,
                "%s, %llu of %llu draws differ, at %zu directions wo; most at %.3f deg", way.c_str(),
                static_cast<unsigned long long>(differs), static_cast<unsigned long long>(drawn),
                counts.size(), viewers.empty() ? 0 : double(theta_of(viewers[at])) * 180 / pi_v<double>);
  result.detail = buffer;
  return result;
}

}  // namespace

std::vector<CheckResult> check_agreement(const Suspect& s, std::span<const Direction> viewers,
                                         const AgreementOptions& options, const Host& host) {
  const std::size_t ways = s.ways.size(), channels = s.channels();
  std::vector<std::vector<Counts>> counts(ways, std::vector<Counts>(viewers.size()));
  const Judge judge{s, options};
  detail::for_each_index(host, s.concurrent(), viewers.size(), [&](std::size_t v) {
    std::vector<DrawnAt> drawn(std::size_t(options.draws));
    std::vector<float> weights(drawn.size() * channels);
    for (std::size_t k = 0; k < ways; ++k) {
      Pcg32 u = detail::part_generator(detail::mixed_seed(options.seed, k), v);
      s.ways[k].draw(viewers[v], u, drawn, weights);
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        if (!drawn[i].drawn) continue;
        judge.one(s.ways[k], viewers[v], drawn[i], std::span(weights).subspan(i * channels, channels),
                  counts[k][v]);
      }
    }
  });
  std::vector<CheckResult> results;
  for (std::size_t k = 0; k < ways; ++k) {
    for (int kind = 0; kind < (s.ways[k].exact ? kinds : target); ++kind) {
      results.push_back(verdict(Kind(kind), s.ways[k].name, viewers, counts[k], options));
    }
  }
  return results;
}

CheckResult check_round_trip(const Suspect& s, std::span<const Direction> viewers,
                             const AgreementOptions& options, const Host& host) {
  struct Found {
    int drawn = 0, differs = 0;
    double worst = 0;
  };
  std::vector<Found> found(viewers.size());
  detail::for_each_index(host, s.concurrent(), viewers.size(), [&](std::size_t v) {
    Pcg32 u = detail::part_generator(detail::mixed_seed(options.seed, 99), v);
    Found& at = found[v];
    for (int i = 0; i < options.draws; ++i) {
      const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
      const auto wi = s.point(viewers[v], u1, u2);
      if (!wi) continue;
      ++at.drawn;
      const auto back = s.invert(viewers[v], *wi);
      const auto again = back ? s.point(viewers[v], back->x, back->y) : std::nullopt;
      // A rounding of wi, and what a flat piece of the map makes of it.
      double distance = 2;
      if (again) {
        const Direction d = *again - *wi;
        distance = std::sqrt(double(dot(d, d)));
      }
      at.differs += !(distance < 1e-5);
      at.worst = std::max(at.worst, distance);
    }
  });
  std::uint64_t drawn = 0, differs = 0;
  double worst = 0;
  for (const Found& f : found) {
    drawn += std::uint64_t(f.drawn), differs += std::uint64_t(f.differs);
    worst = std::max(worst, f.worst);
  }
  CheckResult result;
  result.name = "round_trip";
  result.statistic = drawn > 0 ? double(differs) / double(drawn) : 0;
  result.threshold = 2e-3 + 4 / double(std::max<std::uint64_t>(drawn, 1));
  result.passed = result.statistic <= result.threshold;
  char buffer[160];
  std::snprintf(buffer, sizeof buffer,
                "%llu of %llu directions do not come back from invert(); worst by %.2g",
                static_cast<unsigned long long>(differs), static_cast<unsigned long long>(drawn), worst);
  result.detail = buffer;
  return result;
}

}  // namespace reflectree
