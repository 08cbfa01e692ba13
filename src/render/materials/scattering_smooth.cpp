// SPDX-License-Identifier: Apache-2.0
// Lambert, and the smooth metal, plastic and glass, whose reflections are deltas.
#include <cmath>

#include "cosine_lobe.hpp"
#include "fresnel.hpp"
#include "reading/each.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

namespace {

struct Diffuse final : Each<Diffuse> {
  Texture reflectance;
  explicit Diffuse(Texture t) : reflectance(std::move(t)) {}
  Rgb f_cos(Direction wo, Direction wi, Uv uv) const override {
    return wo.z > 0 && wi.z > 0 ? (wi.z / reflectree::pi) * eval(reflectance, uv) : Rgb{};
  }
  float pdf(Direction wo, Direction wi, Uv) const override { return wo.z > 0 ? cosine_pdf(wi) : 0; }
  std::optional<Scattered> sample(Direction wo, Uv uv, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const Direction wi = cosine_direction(u);
    return Scattered{wi, cosine_pdf(wi), eval(reflectance, uv)};
  }
};

struct Conductor final : Each<Conductor> {
  Rgb eta, k;
  Texture specular;
  Conductor(Rgb e, Rgb absorption, Texture t) : eta(e), k(absorption), specular(std::move(t)) {}
  Rgb f_cos(Direction, Direction, Uv) const override { return {}; }
  Lobes lobes() const override { return Lobes::delta; }
  float pdf(Direction, Direction, Uv) const override { return 0; }
  std::optional<Scattered> sample(Direction wo, Uv uv, PathBits&) const override {
    if (!(wo.z > 0)) return std::nullopt;
    return Scattered{mirror_direction(wo), 0, eval(specular, uv) * fresnel_conductor(wo.z, eta, k), true};
  }
};

// Light that is not reflected enters, is scattered by a Lambertian ground, and leaves or turns back at the
// interface, (1 - F_i) (1 - F_o) rho / (pi eta^2 (1 - rho F_inside)); Mitsuba's default drops the rho below.
struct SmoothPlastic final : Each<SmoothPlastic> {
  PlasticParameters p;
  float inside, specular_weight;
  explicit SmoothPlastic(PlasticParameters parameters)
      : p(std::move(parameters)), inside(fresnel_diffuse(1 / p.eta)), specular_weight(specular_share(p)) {}
  float chance(float reflectance) const {
    const float s = reflectance * specular_weight, d = (1 - reflectance) * (1 - specular_weight);
    return s + d > 0 ? s / (s + d) : 1;
  }
  Lobes lobes() const override { return Lobes::both; }
  Rgb f_cos(Direction wo, Direction wi, Uv uv) const override {
    if (!(wo.z > 0 && wi.z > 0)) return {};
    const float t = (1 - fresnel(wo.z, p.eta).reflectance) * (1 - fresnel(wi.z, p.eta).reflectance);
    return (cosine_pdf(wi) * t / (p.eta * p.eta)) * ground(eval(p.diffuse, uv), inside, p.nonlinear);
  }
  float pdf(Direction wo, Direction wi, Uv) const override {
    if (!(wo.z > 0 && wi.z > 0)) return 0;
    return (1 - chance(fresnel(wo.z, p.eta).reflectance)) * cosine_pdf(wi);
  }
  std::optional<Scattered> sample(Direction wo, Uv uv, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const float reflectance = fresnel(wo.z, p.eta).reflectance, specular = chance(reflectance);
    const float u1 = to_unit_float(u()), u2 = to_unit_float(u());
    if (to_unit_float(u()) < specular) {
      return Scattered{mirror_direction(wo), 0, (reflectance / specular) * eval(p.specular, uv), true};
    }
    const Direction wi = cosine_direction(u1, u2);
    const float density = (1 - specular) * cosine_pdf(wi);
    if (!(density > 0)) return std::nullopt;
    return Scattered{wi, density, (1 / density) * f_cos(wo, wi, uv)};
  }
};

// Radiance that is refracted is scaled by the square of the relative index: it is squeezed into a narrower
// cone (Veach 1997, 5.2).
struct Glass final : Each<Glass> {
  float eta;
  Texture reflectance, transmittance;
  Glass(float e, Texture r, Texture t) : eta(e), reflectance(std::move(r)), transmittance(std::move(t)) {}
  Rgb f_cos(Direction, Direction, Uv) const override { return {}; }
  bool transmits() const override { return true; }
  Lobes lobes() const override { return Lobes::delta; }
  float pdf(Direction, Direction, Uv) const override { return 0; }
  std::optional<Scattered> sample(Direction wo, Uv uv, PathBits& u) const override {
    const Dielectric f = fresnel(wo.z, eta);
    return scatter(wo, uv, f, 1 / (f.eta * f.eta), u);
  }
  // Power is not squeezed.
  std::optional<Scattered> sample_adjoint(Direction wi, Uv uv, PathBits& u) const override {
    return scatter(wi, uv, fresnel(wi.z, eta), 1, u);
  }
  Scattered scatter(Direction w, Uv uv, const Dielectric& f, float squeeze, PathBits& u) const {
    if (to_unit_float(u()) < f.reflectance) return {mirror_direction(w), 0, eval(reflectance, uv), true};
    return {{-w.x / f.eta, -w.y / f.eta, f.cos_theta_t}, 0, squeeze * eval(transmittance, uv), true};
  }
};

}  // namespace

ScatteringPtr diffuse(Texture reflectance) { return std::make_shared<Diffuse>(std::move(reflectance)); }
ScatteringPtr conductor(Rgb eta, Rgb k, Texture specular) {
  return std::make_shared<Conductor>(eta, k, std::move(specular));
}
ScatteringPtr plastic(PlasticParameters parameters) {
  return std::make_shared<SmoothPlastic>(std::move(parameters));
}
ScatteringPtr dielectric(float eta, Texture reflectance, Texture transmittance) {
  return std::make_shared<Glass>(eta, std::move(reflectance), std::move(transmittance));
}

}  // namespace reflectree::render
