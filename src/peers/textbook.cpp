// SPDX-License-Identifier: Apache-2.0
// What each model's paper, or the renderers that ship it, do: a lobe of its own and a cosine lobe, chosen by
// the albedos that the parameters name. Cook-Torrance takes the classical half vectors, D cos_theta_h, not
// visible normals: its V-cavities have none of Smith's.
#include "textbook.hpp"

#include "reflectree/brdf/material/registry.hpp"

namespace reflectree {

namespace {

float mean(Rgb c) { return (c.r + c.g + c.b) / 3; }

struct Term {
  const MaterialTerm& term;
  const ModelInfo& info;
  Rgb operator()(std::string_view name) const {
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
      if (info.parameters[i].name == name) return term.values[i];
    }
    return {};
  }
};

// For one elevation of wo; empty: no sampler was published. Weights are albedos.
std::vector<WeightedLobe> lobes_of(const Term& p, float cos_theta_o) {
  const std::string_view m = p.info.name;
  const WeightedLobe cosine{mean(p("kd")), ProposalLobe{}};
  if (m == "lambert" || m == "oren_nayar") return {{mean(p("rho")), ProposalLobe{}}};
  if (m == "ggx") return {{mean(p("f0")), {LobeKind::ggx, p("alpha").r}}};
  if (m == "phong") return {cosine, {mean(p("ks")), {LobeKind::power, p("n").r}}};
  if (m == "ward") return {cosine, {mean(p("ks")), {LobeKind::gaussian, p("alpha_x").r, p("alpha_y").r}}};
  if (m == "cook_torrance") {
    const float a = p("alpha").r, specular = mean(p("ks") * p("f0"));
    return {cosine, {specular, {LobeKind::gaussian, a, a}}};
  }
  if (m == "ashikhmin_shirley") {  // half and half, section 3 of the paper
    return {{0.5f, ProposalLobe{}}, {0.5f, {LobeKind::half_power, p("n_x").r, p("n_y").r}}};
  }
  if (m == "lafortune") {  // a lobe a channel: axes and exponents may differ
    std::vector<WeightedLobe> lobes{cosine};
    for (int c = 0; c < 3; ++c) {
      const auto of = [&](std::string_view name) { return channel_value(p(name), c); };
      lobes.push_back({of("ks") / 3, {LobeKind::power, of("n"), 1, {of("cx"), of("cy"), of("cz")}}});
    }
    return lobes;
  }
  if (m == "plastic") {  // by Fresnel reflectance of wo, as rough plastics are shipped
    const float f0 = p("f0").r, fresnel = f0 + (1 - f0) * std::pow(1 - cos_theta_o, 5.f);
    return {{(1 - fresnel) * mean(p("kd")), ProposalLobe{}}, {fresnel, {LobeKind::ggx, p("alpha").r}}};
  }
  return {};
}

}  // namespace

std::optional<LobeMixture> textbook_mixture(const Material& material) {
  constexpr std::size_t rows = 64;
  LobeMixture mixture;
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<WeightedLobe> all;
    for (const MaterialTerm& term : material.terms) {
      const ModelInfo* info = find_model(term.model);
      if (!info) return std::nullopt;
      auto lobes = lobes_of({term, *info}, float(std::cos(row_theta_o(row, rows))));
      if (lobes.empty()) return std::nullopt;
      for (WeightedLobe& l : lobes) all.push_back({l.weight * term.weight, l.lobe});
    }
    std::erase_if(all, [](const WeightedLobe& l) { return !(l.weight > 0); });
    if (all.empty()) return std::nullopt;
    mixture.rows.push_back(std::move(lobe_mixture(std::move(all)).rows[0]));
  }
  return mixture;
}

}  // namespace reflectree
