// SPDX-License-Identifier: Apache-2.0
// pdf turned or shifted: the angle or shift by maximum likelihood over some draws, then judged by all of them.
#include <algorithm>

#include "density_search.hpp"
#include "findings.hpp"
#include "hypotheses.hpp"

namespace reflectree::detail {
namespace {

template <class Move>
double likelihood(const DensitySearch& s, const Move& move, double x, std::size_t most, bool of_disk) {
  Directions wo, wi;
  for (const ExaminedView& v : s.views) {
    for (std::size_t i = 0; i < std::min(most, v.wi.size()); ++i) {
      wo.push_back(v.wo), wi.push_back(narrow(move(widen(v.wi[i]), x)));
    }
  }
  const std::vector<double> pdf = s.f.pdf(wo, wi);
  double total = 0;
  for (std::size_t i = 0; i < pdf.size(); ++i) {
    const double measure = of_disk ? std::max(double(wi[i].z), 1e-4) : 1;
    total += std::log(std::max(sane_or_zero(pdf[i]) / measure, 1e-6));
  }
  return total;
}
template <class Move>
std::optional<double> moved_by(const DensitySearch& s, const Move& move, double from, double to, int steps,
                               bool of_disk = false) {
  double best = 0, most = -1e300, width = (to - from) / steps;
  for (int k = 0; k < steps; ++k) {
    const double x = from + width * (k + 0.5), l = likelihood(s, move, x, 200, of_disk);
    if (l > most) most = l, best = x;
  }
  for (const std::size_t draws : {400, 4000, 20'000}) {
    most = -1e300;
    const double centre = best;
    for (int k = -8; k <= 8; ++k) {
      const double x = centre + width * k / 8, l = likelihood(s, move, x, draws, of_disk);
      if (l > most) most = l, best = x;
    }
    width *= draws == 400 ? 0.3 : 0.2;
  }
  for (const ExaminedView& v : s.views) {
    if (v.wi.empty()) continue;
    const ExaminedView r = recounted(v, [&](DirectionPair p) {
      return DirectionPair{p.wo, move(p.wi, best)};
    });
    if (!s.fits(fit_of(r, v.pdf_mass, true)) || !s.total_fits(v, v.pdf_integral)) return std::nullopt;
  }
  return best;
}
Vec3<double> turn_by(Vec3<double> w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

}  // namespace

Explanation explain_turned(const DensitySearch& s) {
  const auto angle = moved_by(s, turn_by, -pi_v<double>, pi_v<double>, 360);
  if (!angle || std::abs(*angle) < 1e-3) return {};
  // Directions were turned by -angle.
  double off = std::remainder(-*angle, 2 * pi_v<double>);
  for (int a = -180; a <= 180; a += 5) {
    const double confused = std::remainder(double(a) - a * pi_v<double> / 180, 2 * pi_v<double>);
    if (a != 0 && std::abs(std::remainder(confused - off, 2 * pi_v<double>)) < 0.004) {
      return {"degrees_for_radians",
              text("directions are turned by %.4g degrees against pdf, which is %.0f radians in the place "
                   "of %.0f degrees",
                   degrees(off), a, a),
              nullptr};
    }
  }
  std::string words = text("directions are turned by %.4g degrees against pdf", degrees(off));
  const double cells = 2 * pi_v<double> / std::abs(off);
  if (cells > 7.5 && std::abs(cells - std::round(cells)) < 0.02 * cells) {
    words += text(": 1/%.0f of a turn, an index off by one in a table of as many cells?", std::round(cells));
    return {"table_off_by_one", words, nullptr};
  }
  return {"azimuth_turned", words, nullptr};
}

Explanation explain_shifted(const DensitySearch& s) {
  // r^2 and z, each plus a shift, modulo 1.
  const auto squared = [](Vec3<double> w, double by) {
    const double r2 = sqr(w.x) + sqr(w.y), to = r2 + by - std::floor(r2 + by),
                 scale = std::sqrt(to / std::max(r2, 1e-12));
    return Vec3<double>{scale * w.x, scale * w.y, std::sqrt(std::max(1 - to, 0.))};
  };
  const auto cosine = [](Vec3<double> w, double by) {
    const double z = w.z + by - std::floor(w.z + by),
                 scale = std::sqrt((1 - z * z) / std::max(1 - w.z * w.z, 1e-12));
    return Vec3<double>{scale * w.x, scale * w.y, z};
  };
  // The first keeps areas of the disk, the second solid angles; densities are compared in the same measure.
  const auto a = moved_by(s, squared, -0.25, 0.25, 400, true);
  const auto b = a ? std::nullopt : moved_by(s, cosine, -0.25, 0.25, 400);
  if (!a && !b) return {};
  const double by = a ? *a : *b;
  return {"table_off_by_one",
          text(a ? "directions and pdf differ by %.4g in sin^2 theta_i, 1/%.0f of its range: an index off "
                   "by one in a table?"
                 : "directions and pdf differ by %.4g in cos_theta_i, 1/%.0f of its range: an index off by "
                   "one in a table?",
               by, std::round(1 / std::abs(by))),
          nullptr};
}

}  // namespace reflectree::detail
