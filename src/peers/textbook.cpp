// SPDX-License-Identifier: Apache-2.0
// What each model's paper, or the renderers that ship it, do: a lobe of its own and a cosine lobe, chosen by
// the albedos that the parameters name. Cook-Torrance takes the classical half vectors, D cos_theta_h, not
// visible normals: its V-cavities have none of Smith's.
#include "textbook.hpp"

#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/brdf/models/all.hpp"

namespace reflectree {

namespace {

using Lobes = std::vector<WeightedLobe>;

float mean(Rgb c) { return (c.r + c.g + c.b) / 3; }
WeightedLobe cosine(Rgb albedo) { return {mean(albedo), ProposalLobe{}}; }

// lobes_of(model, cos_theta_o): for one elevation of wo; weights are albedos. A model for which no sampler
// was published has no such function.
Lobes lobes_of(const Lambert& m, float) { return {cosine(m.rho)}; }
Lobes lobes_of(const OrenNayar& m, float) { return {cosine(m.rho)}; }
Lobes lobes_of(const Ggx& m, float) {
  return {{mean(m.f0), {LobeKind::ggx, m.alpha.x, m.alpha.y, {}, m.phi}}};
}
Lobes lobes_of(const Phong& m, float) { return {cosine(m.kd), {mean(m.ks), {LobeKind::power, m.n}}}; }
Lobes lobes_of(const Ward& m, float) {
  return {cosine(m.kd), {mean(m.ks), {LobeKind::gaussian, m.alpha_x, m.alpha_y, {}, m.phi}}};
}
Lobes lobes_of(const CookTorrance& m, float) {
  return {cosine(m.kd), {mean(m.ks * m.f0), {LobeKind::gaussian, m.alpha.x, m.alpha.y, {}, m.phi}}};
}
// Half and half, section 3 of the paper.
Lobes lobes_of(const AshikhminShirley& m, float) {
  return {{0.5f, ProposalLobe{}}, {0.5f, {LobeKind::half_power, m.n_x, m.n_y, {}, m.phi}}};
}
// One lobe per channel: axes and exponents may differ.
Lobes lobes_of(const Lafortune& m, float) {
  Lobes lobes{cosine(m.kd)};
  for (int c = 0; c < 3; ++c) {
    const Vec3<float> axis{channel_value(m.cx, c), channel_value(m.cy, c), channel_value(m.cz, c)};
    lobes.push_back({channel_value(m.ks, c) / 3, {LobeKind::power, channel_value(m.n, c), 1, axis}});
  }
  return lobes;
}
// By Fresnel reflectance of wo, as rough plastics are shipped.
Lobes lobes_of(const Plastic& m, float cos_theta_o) {
  const float fresnel = m.f0 + (1 - m.f0) * std::pow(1 - cos_theta_o, 5.f);
  return {{(1 - fresnel) * mean(m.kd), ProposalLobe{}},
          {fresnel, {LobeKind::ggx, m.alpha.x, m.alpha.y, {}, m.phi}}};
}

struct Textbook {
  std::string_view model;
  Lobes (*lobes)(std::span<const Rgb> values, float cos_theta_o);
};

// The models that have one.
const std::vector<Textbook>& textbooks() {
  static const std::vector<Textbook> table = [] {
    std::vector<Textbook> rows;
    for_each_model([&rows]<class M>(std::type_identity<M>) {
      if constexpr (requires(const M& m) { lobes_of(m, 1.f); }) {
        rows.push_back({M::describe().name, [](std::span<const Rgb> values, float cos_theta_o) {
                          return lobes_of(model_from_values<M>(values), cos_theta_o);
                        }});
      }
    });
    return rows;
  }();
  return table;
}

const Textbook* find_textbook(std::string_view model) {
  for (const Textbook& row : textbooks()) {
    if (row.model == model) return &row;
  }
  return nullptr;
}

}  // namespace

std::optional<LobeMixture> bounded_mixture(const Material& material) {
  auto mixture = textbook_mixture(material);
  if (!mixture) return std::nullopt;
  bool any = false;
  for (auto& row : mixture->rows) {
    for (WeightedLobe& l : row) {
      if (l.lobe.kind == LobeKind::ggx) l.lobe.kind = LobeKind::ggx_bounded, any = true;
    }
  }
  return any ? mixture : std::nullopt;
}

std::optional<LobeMixture> textbook_mixture(const Material& material) {
  constexpr std::size_t rows = 64;
  LobeMixture mixture;
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<WeightedLobe> all;
    for (const MaterialTerm& term : material.terms) {
      const Textbook* textbook = find_textbook(term.model);
      if (!textbook) return std::nullopt;
      const float cos_theta_o = float(std::cos(row_theta_o(row, rows)));
      for (const WeightedLobe& l : textbook->lobes(term.values, cos_theta_o)) {
        all.push_back({l.weight * term.weight, l.lobe});
      }
    }
    std::erase_if(all, [](const WeightedLobe& l) { return !(l.weight > 0); });
    if (all.empty()) return std::nullopt;
    mixture.rows.push_back(std::move(lobe_mixture(std::move(all)).rows[0]));
  }
  return mixture;
}

}  // namespace reflectree
