// SPDX-License-Identifier: Apache-2.0
// Sound triples of eval, sample and pdf, some with a knob that breaks them.
#pragma once

#include "doctor_spoiling.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "simple_samplers.hpp"

namespace reflectree::catalogue {

inline AnyBrdf material(const char* text) { return make_brdf(parse_material(text)); }

inline LobeMixture lobes(std::vector<WeightedLobe> all) { return lobe_mixture(std::move(all)); }
inline ProposalLobe visible_normals(float alpha) { return {LobeKind::ggx, alpha}; }
inline ProposalLobe cosine_lobe() { return {}; }

inline Patient of_lobes(const char* f, LobeMixture mixture) {
  return patient(material(f), AnySampler<Spectrum>(
                                  f, WeightedSampler<AnyBrdf, LobeMixture>(material(f), std::move(mixture))));
}

// The sound ones.
inline Patient metal() { return of_lobes("ggx:alpha=0.3,f0=1/0.8/0.3", lobes({{1, visible_normals(0.3f)}})); }
inline Patient plastic() {
  return of_lobes("plastic:alpha=0.2", lobes({{0.5f, cosine_lobe()}, {0.5f, visible_normals(0.2f)}}));
}
inline Patient diffuse() { return of_lobes("lambert", lobes({{1, cosine_lobe()}})); }
inline Patient brushed(float a = 0.15f, float b = 0.5f) {
  return of_lobes("ward:alpha_x=0.15,alpha_y=0.5",
                  lobes({{0.3f, cosine_lobe()}, {0.7f, {LobeKind::gaussian, a, b}}}));
}
// Not reciprocal: light comes back at another strength.
inline AnyBrdf one_way() {
  return AnyBrdf([](Direction wo, Direction wi) { return 0.1f + 0.2f * wo.z * wi.z * wi.z; });
}

inline Direction turned(Direction w, float angle) {
  return {std::cos(angle) * w.x - std::sin(angle) * w.y, std::sin(angle) * w.x + std::cos(angle) * w.y, w.z};
}
inline Direction cosine_direction(double u1, double u2) {
  const double r = std::sqrt(u1), phi = 2 * pi_v<double> * u2;
  return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(std::sqrt(std::max(1 - u1, 1e-12)))};
}
inline OfDirection mixed(float cosine, float alpha) {
  return directions_of(lobes({{cosine, cosine_lobe()}, {1 - cosine, visible_normals(alpha)}}));
}

// A density in a table over (phi, sin^2 theta), the same for every viewer; f is Lambert's.
struct Table {
  static constexpr int n = 32;
  std::array<double, n * n> cell{};
  Table() {
    double sum = 0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double x = (i + 0.5) / n, y = (j + 0.5) / n;
        cell[std::size_t(j * n + i)] = 0.3 + std::exp(-60 * (sqr(x - 0.3) + sqr(y - 0.6))) * 8 + x * y;
        sum += cell[std::size_t(j * n + i)];
      }
    }
    for (double& c : cell) c /= sum;
  }
  Direction draw(Pcg32& u) const {
    double rest = to_unit_double(u());
    std::size_t k = 0;
    for (; k + 1 < cell.size() && rest >= cell[k]; ++k) rest -= cell[k];
    const double x = (double(k % n) + to_unit_double(u())) / n, y = (double(k / n) + to_unit_double(u())) / n;
    return cosine_direction(y, x);
  }
  double pdf(Direction w, int di = 0, int dj = 0, bool transposed = false) const {
    if (!(w.z > 0)) return 0;
    double x = std::atan2(double(w.y), double(w.x)) / (2 * pi_v<double>);
    x -= std::floor(x);
    const double y = std::min(sqr(double(w.x)) + sqr(double(w.y)), 1 - 1e-9);
    int i = (int(x * n) + di) % n, j = (int(y * n) + dj) % n;
    if (transposed) std::swap(i, j);
    return cell[std::size_t(j * n + i)] * n * n / pi_v<double> * double(w.z);
  }
};
inline Patient of_table(int di = 0, int dj = 0, bool transposed = false) {
  static const Table table;
  Patient p = with_pdf(
      diffuse(), [=](Direction, Direction wi, double) { return table.pdf(wi, di, dj, transposed); }, false);
  return with_directions(std::move(p),
                         [](Direction, Pcg32& u) -> std::optional<Direction> { return table.draw(u); });
}

// Drawn by rejection from uniform directions under a bound of f cos_theta_i, which is at most 1.
inline Patient by_rejection(double bound) {
  const LowSmoothSampler sampler{low_smooth(3)};
  Patient p = patient(
      "rejection", AnyBrdf(sampler.f), [sampler](Direction wo, Pcg32& u) { return sampler.sample(wo, u); },
      [sampler](Direction wo, Direction wi) { return sampler.pdf(wo, wi); });
  return with_directions(std::move(p), [bound](Direction wo, Pcg32& u) -> std::optional<Direction> {
    for (;;) {
      const double z = 1 - to_unit_double(u()), phi = 2 * pi_v<double> * to_unit_double(u()),
                   r = std::sqrt(1 - z * z);
      const Direction wi{float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
      const double d2 = sqr(double(wo.x) + double(wi.x)) + sqr(double(wo.y) + double(wi.y));
      if (to_unit_double(u()) * bound < z / (1 + 3 * d2)) return wi;
    }
  });
}

// A cosine lobe and cos^n about the mirror direction; pdf does not ask for the horizon. Directions below are
// lost, or drawn again.
inline Patient power_lobe(bool again) {
  const LobeMixture mixture = lobes({{0.3f, cosine_lobe()}, {0.7f, {LobeKind::power, 20}}});
  Patient p = with_pdf(
      diffuse(),
      [](Direction wo, Direction wi, double) {
        const double c = std::max(double(dot(mirror_direction(wo), wi)), 0.);
        return 0.3 * std::max(double(wi.z), 0.) / pi_v<double> +
               0.7 * 21 / (2 * pi_v<double>)*std::pow(std::min(c, 1.), 20);
      },
      false);
  return with_directions(std::move(p), [own = directions_of(mixture), again](Direction wo, Pcg32& u) {
    auto wi = own(wo, u);
    while (again && !wi) wi = own(wo, u);
    return wi;
  });
}

inline Patient rough_lobe(float alpha, bool rounded) {
  const std::string text = "ggx:alpha=" + std::to_string(alpha);
  Patient p = with_pdf(
      of_lobes(text.c_str(), lobes({{1, visible_normals(alpha)}})),
      [alpha](Direction wo, Direction wi, double) {
        const auto g = shading_geometry(Vec3<double>{wo.x, wo.y, wo.z}, Vec3<double>{wi.x, wi.y, wi.z});
        if (!(wi.z > 0)) return 0.;
        return ggx_distribution(g.wh, double(alpha)) * g.cos_theta_h / (4 * g.cos_theta_d);
      },
      false);
  return with_directions(std::move(p), [alpha, rounded](Direction wo, Pcg32& u) -> std::optional<Direction> {
    const double v = to_unit_double(u()), tan2 = sqr(double(alpha)) * v / (1 - v),
                 phi = 2 * pi_v<double> * to_unit_double(u());
    double c = 1 / std::sqrt(1 + tan2), s = std::sqrt(tan2) * c;
    if (rounded) c = double(float(c)), s = std::sqrt(std::max(1 - c * c, 0.));
    const Vec3<double> wh{s * std::cos(phi), s * std::sin(phi), c}, w{wo.x, wo.y, wo.z};
    const Vec3<double> wi = normalize(reflect(w, wh));
    if (!(wi.z > 0) || !(dot(w, wh) > 0)) return std::nullopt;
    return Direction{float(wi.x), float(wi.y), float(wi.z)};
  });
}

}  // namespace reflectree::catalogue
