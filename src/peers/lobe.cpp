// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/lobe.hpp"

#include "reflectree/brdf/models/cook_torrance.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lobe.hpp"
#include "reflectree/math/frame.hpp"

namespace reflectree {

namespace {

// In (0, 1]: its logarithm is finite.
float positive_unit(UniformBits& u) { return float((double(u()) + 1) * 0x1p-32); }

Direction unit_or_up(Direction w) {
  const float l = length(w);
  return l > 0 ? (1 / l) * w : Direction{0, 0, 1};
}
Direction power_axis(const ProposalLobe& lobe, Direction wo) {
  return unit_or_up({lobe.axis.x * wo.x, lobe.axis.y * wo.y, lobe.axis.z * wo.z});
}

Direction sample_power(const ProposalLobe& lobe, Direction wo, float u1, float u2) {
  const float v = -std::expm1(std::log(u1) / (lobe.a + 1)), r = sqrt(v * (2 - v)), phi = 2 * pi * u2;
  return to_world(frame_from_normal(power_axis(lobe, wo)), Direction{r * cos(phi), r * sin(phi), 1 - v});
}

// How much of the spherical cap remains once normals that reflect below the horizon are bounded away: 1 for
// all of it. Listing 2 of Tokuyoshi and Eto 2024, "Bounded VNDF Sampling for the Smith-GGX BRDF".
float cap_share(const ProposalLobe& lobe, Direction wo) {
  if (lobe.kind != LobeKind::ggx_bounded) return 1;
  const float narrow2 = sqr(std::min({lobe.a, lobe.b, 1.f}));
  const float s2 = sqr(1 + sqrt(wo.x * wo.x + wo.y * wo.y));
  return (1 - narrow2) * s2 / (s2 + narrow2 * sqr(wo.z));
}

// A point uniform on the cap of the unit sphere that the stretched wo lights, plus that wo.
Direction sample_ggx_half(const ProposalLobe& lobe, Direction wo, float u1, float u2) {
  const Direction s = normalize(Direction{lobe.a * wo.x, lobe.b * wo.y, wo.z});
  const float z = 1 - u1 * (1 + cap_share(lobe, wo) * s.z), r = sqrt(max(1 - z * z, 0.f)), phi = 2 * pi * u2;
  const Direction h = Direction{r * cos(phi), r * sin(phi), z} + s;
  return unit_or_up({lobe.a * h.x, lobe.b * h.y, max(h.z, 0.f)});
}

Direction sample_gaussian_half(const ProposalLobe& lobe, float u1, float u2) {
  const float r = sqrt(-std::log(u1)), phi = 2 * pi * u2;
  return normalize(Direction{lobe.a * r * cos(phi), lobe.b * r * sin(phi), 1});
}

// Equations 9 and 10 of the paper, all quadrants at once.
Direction sample_half_power(const ProposalLobe& lobe, float u1, float u2) {
  const float psi = 2 * pi * u2;
  const float x = sqrt(lobe.b + 1) * cos(psi), y = sqrt(lobe.a + 1) * sin(psi), r2 = x * x + y * y;
  const float exponent = (lobe.a * x * x + lobe.b * y * y) / r2;
  const float v = -std::expm1(std::log(u1) / (exponent + 1)), s = sqrt(v * (2 - v) / r2);
  return {s * x, s * y, 1 - v};
}

float half_pdf(const ProposalLobe& lobe, Direction wh) {
  const float hz2 = max(sqr(wh.z), 1e-18f);
  if (lobe.kind == LobeKind::gaussian) {
    const float slope2 = (sqr(wh.x / lobe.a) + sqr(wh.y / lobe.b)) / hz2;
    return exp(-slope2) / (pi * lobe.a * lobe.b * hz2 * sqrt(hz2));
  }
  const float s2 = sin2_theta(wh);
  const float exponent = s2 > 0 ? (lobe.a * sqr(wh.x) + lobe.b * sqr(wh.y)) / s2 : lobe.a;
  return sqrt((lobe.a + 1) * (lobe.b + 1)) / (2 * pi) * exp(-0.5f * exponent * log1p(s2 / hz2));
}

}  // namespace

std::optional<Direction> ProposalLobe::sample(Direction wo, UniformBits& u) const {
  const auto wi = sample_own(in_frame_of(phi, wo), u);
  if (!wi || phi.degrees == 0) return wi;
  return Direction{phi.cosine * wi->x - phi.sine * wi->y, phi.sine * wi->x + phi.cosine * wi->y, wi->z};
}

float ProposalLobe::pdf(Direction wo, Direction wi) const {
  return pdf_own(in_frame_of(phi, wo), in_frame_of(phi, wi));
}

std::optional<Direction> ProposalLobe::sample_own(Direction wo, UniformBits& u) const {
  const float u1 = positive_unit(u), u2 = to_unit_float(u());
  Direction wi;
  if (kind == LobeKind::uniform || kind == LobeKind::cosine) {
    const float z = kind == LobeKind::uniform ? u1 : sqrt(u1);
    const float r = sqrt(max(1 - z * z, 0.f)), azimuth = 2 * pi * u2;
    wi = {r * cos(azimuth), r * sin(azimuth), z};
  } else if (kind == LobeKind::power) {
    wi = sample_power(*this, wo, u1, u2);
  } else {
    const Direction wh = is_ggx()                     ? sample_ggx_half(*this, wo, u1, u2)
                         : kind == LobeKind::gaussian ? sample_gaussian_half(*this, u1, u2)
                                                      : sample_half_power(*this, u1, u2);
    if (!(dot(wo, wh) > 0)) return std::nullopt;
    wi = normalize(reflect(wo, wh));
  }
  if (!(wi.z > 0)) return std::nullopt;
  return wi;
}

float ProposalLobe::pdf_own(Direction wo, Direction wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  if (kind == LobeKind::uniform) return 1 / (2 * pi);
  if (kind == LobeKind::cosine) return wi.z / pi;
  if (kind == LobeKind::power) return (a + 1) / (2 * pi) * cos_power(versine(wi, power_axis(*this, wo)), a);
  const ShadingGeometry<float> g = shading_geometry(wo, wi);
  if (is_ggx()) {
    // G1 D cos_d / cos_o over the reflection's 4 cos_d; Heitz 2014, eq. 16 and 43.
    const float own = cap_share(*this, wo) * wo.z;
    if (a == b) return ggx_distribution(g.wh, a) / (2 * (own + sqrt(a * a + (1 - a * a) * wo.z * wo.z)));
    return ggx_distribution(g.wh, Widths(a, b)) /
           (2 * (own + sqrt(sqr(wo.z) + sqr(a * wo.x) + sqr(b * wo.y))));
  }
  return half_pdf(*this, g.wh) / (4 * g.cos_theta_d);
}

const std::vector<WeightedLobe>& LobeMixture::row(Direction wo) const {
  if (rows.size() == 1) return rows[0];
  const auto i = std::size_t(theta_of(wo) / (pi / 2) * float(rows.size()));
  return rows[std::min(i, rows.size() - 1)];
}

std::optional<DrawnFromDensity> LobeMixture::sample(Direction wo, UniformBits& u) const {
  const auto& lobes = row(wo);
  std::size_t i = 0;
  if (lobes.size() > 1) {
    for (double rest = to_unit_double(u()); i + 1 < lobes.size() && rest >= double(lobes[i].weight); ++i) {
      rest -= double(lobes[i].weight);
    }
  }
  const auto wi = lobes[i].lobe.sample(wo, u);
  if (!wi) return std::nullopt;
  return DrawnFromDensity{*wi, pdf(wo, *wi)};
}

float LobeMixture::pdf(Direction wo, Direction wi) const {
  float sum = 0;
  for (const WeightedLobe& l : row(wo)) sum += l.weight * l.lobe.pdf(wo, wi);
  return sum;
}

std::size_t LobeMixture::bytes() const {
  std::size_t sum = 0;
  for (const auto& r : rows) sum += sizeof(r) + r.size() * sizeof(WeightedLobe);
  return sum;
}

LobeMixture lobe_mixture(std::vector<WeightedLobe> lobes) {
  float sum = 0;
  for (const WeightedLobe& l : lobes) sum += l.weight;
  for (WeightedLobe& l : lobes) l.weight = sum > 0 ? l.weight / sum : 1 / float(lobes.size());
  return {{std::move(lobes)}};
}

}  // namespace reflectree
