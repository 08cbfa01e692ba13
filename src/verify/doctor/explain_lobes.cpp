// SPDX-License-Identifier: Apache-2.0
// Other lobes than those of pdf, or other weights.
#include <algorithm>
#include <array>

#include "density_search.hpp"
#include "findings.hpp"

namespace reflectree::detail {
namespace {

// The truth as a formula, where the weights are the same for all viewers.
std::function<std::vector<double>(std::span<const Direction>, std::span<const Direction>)> mix(
    const Functions& f, double a, double b, bool cosine, const std::vector<std::array<double, 3>>& found) {
  for (const auto& x : found) {
    if (std::abs(x[0] - a) > 0.02 * std::abs(a)) return nullptr;
  }
  return [f, a, b, cosine](std::span<const Direction> wo, std::span<const Direction> wi) {
    std::vector<double> p = f.pdf(wo, wi);
    for (std::size_t i = 0; i < p.size(); ++i) {
      p[i] = std::max(a * p[i] + b * (cosine ? double(wi[i].z) / pi_v<double> : 0.5 / pi_v<double>), 0.);
    }
    return p;
  };
}

}  // namespace

Explanation explain_other_density(const DensitySearch& s) {
  const auto like_f = [&](const ExaminedView& v) { return normalised_to(v.f_mass, drawn_share(v)); };
  if (s.statistic(like_f, false)) {
    return {"draws_f_cos", "directions follow f cos_theta_i exactly, and pdf says something else", nullptr};
  }
  const auto without = [&](const ExaminedView& v) {
    return normalised_to(
        reweighted(v, v.f_mass, v.f_cos_at,
                   [&](std::size_t i) { return v.f_cos_at[i] / std::max(double(v.nodes.wi[i].z), 1e-9); }),
        drawn_share(v));
  };
  if (s.statistic(without, false)) {
    return {"draws_f", "directions follow f without its cosine, and pdf says something else", nullptr};
  }
  for (const bool cosine : {true, false}) {
    if (!s.statistic(
            [&](const ExaminedView& v) {
              return normalised_to(lobe_masses(v, cosine, s.host), drawn_share(v));
            },
            false))
      continue;
    return {cosine ? "draws_cosine" : "draws_uniform",
            cosine ? "directions follow a cosine lobe whatever pdf says: its other lobes are never drawn"
                   : "directions are uniform whatever pdf says: its lobes are never drawn",
            [cosine](std::span<const Direction> wo, std::span<const Direction> wi) {
              std::vector<double> p(wo.size());
              for (std::size_t i = 0; i < p.size(); ++i)
                p[i] = cosine ? double(wi[i].z) / pi_v<double> : 0.5 / pi_v<double>;
              return p;
            }};
  }
  return {};
}

Explanation explain_mixture(const DensitySearch& s) {
  for (const bool cosine : {true, false}) {
    std::vector<std::array<double, 3>> found;  // a, b, least ratio of the truth to pdf
    bool all = true;
    for (const ExaminedView& v : s.views) {
      if (v.wi.empty()) continue;
      const Masses c = lobe_masses(v, cosine, s.host);
      double pp = 0, pc = 0, cc = 0, py = 0, cy = 0;
      for (int round = 0, rounds = 4; round < rounds; ++round) {
        const double a0 = round ? found.back()[0] : 1, b0 = round ? found.back()[1] : 0;
        pp = pc = cc = py = cy = 0;
        for (std::size_t i = 0; i < c.size(); ++i) {
          const double p = v.pdf_mass[i], y = v.count[i] / v.draws;
          const double variance = std::max({a0 * p + b0 * c[i], 0.02 * p, 5 / v.draws});
          pp += p * p / variance, pc += p * c[i] / variance, cc += c[i] * c[i] / variance;
          py += p * y / variance, cy += c[i] * y / variance;
        }
        const double determinant = pp * cc - pc * pc;
        if (!(determinant > 1e-12 * pp * cc)) break;
        if (round) found.pop_back();
        found.push_back({(py * cc - cy * pc) / determinant, (cy * pp - py * pc) / determinant, 0});
      }
      if (!(pp * cc - pc * pc > 1e-12 * pp * cc)) {
        all = false;
        break;
      }
      Masses m(c.size());
      double least = 1e9;
      for (std::size_t i = 0; i < c.size(); ++i) {
        m[i] = std::max(found.back()[0] * v.pdf_mass[i] + found.back()[1] * c[i], 0.);
        if (v.pdf_mass[i] * v.draws > 50) least = std::min(least, m[i] / v.pdf_mass[i]);
        if (m[i] < 0.01 * v.pdf_mass[i])
          m[i] = std::max(m[i], v.count[i] / v.draws < 0.03 * v.pdf_mass[i] ? v.count[i] / v.draws : m[i]);
      }
      found.back()[2] = least;
      if (!s.fits(fit_of(v, m, true))) {
        all = false;
        break;
      }
    }
    if (!all || found.empty()) continue;
    const char* lobe = cosine ? "cosine lobe" : "uniform lobe";
    double a = 0, b = 0, ratio = 1e9;
    for (const auto& x : found)
      a += x[0] / double(found.size()), b += x[1] / double(found.size()), ratio = std::min(ratio, x[2]);
    double integral = 0;
    for (const ExaminedView& v : s.views) integral += v.pdf_integral / double(s.views.size());
    if (b > 0 && integral < 0.99 && std::abs(a - 1) < 0.03) {
      return {"pdf_drops_lobe",
              std::string("the pdf leaves out a ") + lobe +
                  text(", to which %.3g %% of the directions belong", 100 * b),
              mix(s.f, a, b, cosine, found)};
    }
    if (b > 0 && a < 1 && integral > 0.99 && std::abs(a + b - 1) > 0.03) continue;
    if (b < 0 && ratio < 0.25) {
      return {"dropped_lobe",
              std::string("the ") + lobe +
                  text(" that pdf counts with %.3g %% is never drawn, or hardly ever", 100 * -b / a),
              mix(s.f, a, b, cosine, found)};
    }
    return {"mixture_weight",
            std::string("a mixture is drawn with other weights than pdf has: ") +
                (b < 0 ? std::string("the ") + lobe + text(" %.3g times as often", ratio)
                       : std::string("lobes other than the ") + lobe + text(" %.3g times as often", a)),
            mix(s.f, a, b, cosine, found)};
  }
  return {};
}

}  // namespace reflectree::detail
