// SPDX-License-Identifier: Apache-2.0
// Metal and plastic with a microfacet interface.
#include <algorithm>
#include <array>

#include "cosine_lobe.hpp"
#include "each.hpp"
#include "fresnel.hpp"
#include "microfacet.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

namespace {

struct RoughConductor final : Each<RoughConductor> {
  Roughness roughness;
  Rgb eta, k;
  Texture specular, alpha_x, alpha_y;
  bool one_width;  // along x and y
  Asks asked;
  RoughConductor(Roughness r, Rgb e, Rgb absorption, Texture t, Texture x, Texture y)
      : roughness(r),
        eta(e),
        k(absorption),
        specular(std::move(t)),
        alpha_x(std::move(x)),
        alpha_y(std::move(y)),
        one_width(varies(alpha_x) || varies(alpha_y) ? alpha_x == alpha_y : r.alpha.round()),
        asked(std::max({one_width ? Asks::nothing : Asks::frame, asks_for(specular), asks_for(alpha_x),
                        asks_for(alpha_y)})) {}
  Asks asks() const override { return asked; }
  Microfacets normals_at(Place place) const {
    Roughness here = roughness;
    if (varies(alpha_x)) here.alpha.x = eval(alpha_x, place).r;
    if (varies(alpha_y)) here.alpha.y = one_width ? here.alpha.x : eval(alpha_y, place).r;
    return Microfacets(here);
  }
  // For both directions above the surface: f cos, and the density with which wi is drawn.
  Value about(const Microfacets& normals, Direction wh, Direction wo, Direction wi, Place place) const {
    const float d = normals.d(wh), g1_o = normals.g1(wo), cosine = dot(wo, wh);
    const float common = d * g1_o * normals.g1(wi) / (4 * wo.z);
    return {common * (eval(specular, place) * fresnel_conductor(cosine, eta, k)),
            normals.pdf(wo, wh, d, g1_o) / (4 * cosine)};
  }
  Value value(Direction wo, Direction wi, Place place) const override {
    return wo.z > 0 && wi.z > 0 ? about(normals_at(place), normalize(wo + wi), wo, wi, place) : Value{};
  }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override { return value(wo, wi, place).f_cos; }
  float pdf(Direction wo, Direction wi, Place place) const override { return value(wo, wi, place).pdf; }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const Microfacets here = normals_at(place);
    const Direction wh = here.sample(wo, u), wi = reflect(wo, wh);
    if (!(wi.z > 0) || !(dot(wo, wh) > 0)) return std::nullopt;
    const Value v = about(here, wh, wo, wi, place);
    if (!(v.pdf > 0)) return std::nullopt;
    return Scattered{wi, v.pdf, (1 / v.pdf) * v.f_cos};
  }
};

// Mitsuba tabulates what the interface lets through at 64 cosines from 0 to 1 and takes the plain mean of
// the table for diffuse light from inside; its plastic's albedo depends on both, and ours must be its.
constexpr std::size_t nodes = 64;

struct RoughPlastic final : Each<RoughPlastic> {
  PlasticParameters p;
  Microfacets normals;
  std::array<float, nodes> through{};
  float inside = 0, specular_weight;
  RoughPlastic(PlasticParameters parameters, Roughness r)
      : p(std::move(parameters)), normals(r), specular_weight(specular_share(p)) {
    r.sample_visible = true;  // the means are over visible normals, however directions are drawn
    const Microfacets visible(r);
    double sum = 0;
    for (std::size_t i = 0; i < nodes; ++i) {
      const float mu = max(1e-6f, float(i) / float(nodes - 1));
      through[i] = rough_transmittance(visible, mu, p.eta, 32);
      sum += double(rough_reflectance(visible, mu, 1 / p.eta, 128) * mu);
    }
    inside = float(2 * sum / double(nodes));
  }
  Asks asks() const override { return std::max(asks_for(p.diffuse), asks_for(p.specular)); }
  float transmittance(float cosine) const {
    const float x = cosine * float(nodes - 1);
    const std::size_t i = std::min(std::size_t(x), nodes - 2);
    return linear_mix(x - float(i), through[i], through[i + 1]);
  }
  float chance(Direction wo) const {
    const float t = transmittance(wo.z), s = (1 - t) * specular_weight, d = t * (1 - specular_weight);
    return s + d > 0 ? s / (s + d) : 1;
  }
  // For both directions above the surface: f cos, and the density with which wi is drawn.
  Value about(Direction wh, Direction wo, Direction wi, float specular, Place place) const {
    const float d = normals.d(wh), g1_o = normals.g1(wo), cosine = dot(wo, wh);
    const float gloss = fresnel(cosine, p.eta).reflectance * d * g1_o * normals.g1(wi) / (4 * wo.z);
    const float t = transmittance(wo.z) * transmittance(wi.z) * cosine_pdf(wi) / (p.eta * p.eta);
    return {gloss * eval(p.specular, place) + t * ground(eval(p.diffuse, place), inside, p.nonlinear),
            specular * normals.pdf(wo, wh, d, g1_o) / (4 * cosine) + (1 - specular) * cosine_pdf(wi)};
  }
  Value value(Direction wo, Direction wi, Place place) const override {
    return wo.z > 0 && wi.z > 0 ? about(normalize(wo + wi), wo, wi, chance(wo), place) : Value{};
  }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override { return value(wo, wi, place).f_cos; }
  float pdf(Direction wo, Direction wi, Place place) const override { return value(wo, wi, place).pdf; }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const float u1 = to_unit_float(u()), u2 = to_unit_float(u());  // first, for points that are a net in two
    const float specular = chance(wo);
    const Direction wi =
        to_unit_float(u()) < specular ? reflect(wo, normals.sample(wo, u1, u2)) : cosine_direction(u1, u2);
    if (!(wi.z > 0)) return std::nullopt;
    const Value v = about(normalize(wo + wi), wo, wi, specular, place);
    if (!(v.pdf > 0)) return std::nullopt;
    return Scattered{wi, v.pdf, (1 / v.pdf) * v.f_cos};
  }
};

}  // namespace

ScatteringPtr rough_conductor(Roughness roughness, Rgb eta, Rgb k, Texture specular, Texture alpha_x,
                              Texture alpha_y) {
  return std::make_shared<RoughConductor>(roughness, eta, k, std::move(specular), std::move(alpha_x),
                                          std::move(alpha_y));
}
ScatteringPtr rough_plastic(PlasticParameters parameters, Roughness roughness) {
  return std::make_shared<RoughPlastic>(std::move(parameters), roughness);
}

}  // namespace reflectree::render
