// SPDX-License-Identifier: Apache-2.0
// Lambert, and the smooth metal, plastic and glass, whose reflections are deltas.
#include <algorithm>
#include <cmath>

#include "cosine_lobe.hpp"
#include "each.hpp"
#include "fresnel.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

namespace {

struct Diffuse final : Each<Diffuse> {
  Texture reflectance;
  explicit Diffuse(Texture t) : reflectance(std::move(t)) {}
  Asks asks() const override { return asks_for(reflectance); }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override {
    return wo.z > 0 && wi.z > 0 ? (wi.z / reflectree::pi) * eval(reflectance, place) : Rgb{};
  }
  float pdf(Direction wo, Direction wi, Place) const override { return wo.z > 0 ? cosine_pdf(wi) : 0; }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const Direction wi = cosine_direction(u);
    return Scattered{wi, cosine_pdf(wi), eval(reflectance, place)};
  }
};

struct Conductor final : Each<Conductor> {
  Rgb eta, k;
  Texture specular;
  Conductor(Rgb e, Rgb absorption, Texture t) : eta(e), k(absorption), specular(std::move(t)) {}
  Asks asks() const override { return asks_for(specular); }
  Rgb f_cos(Direction, Direction, Place) const override { return {}; }
  Lobes lobes() const override { return Lobes::delta; }
  float pdf(Direction, Direction, Place) const override { return 0; }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits&) const override {
    if (!(wo.z > 0)) return std::nullopt;
    return Scattered{mirror_direction(wo), 0, eval(specular, place) * fresnel_conductor(wo.z, eta, k), true};
  }
};

// Light that is not reflected enters, is scattered by a Lambertian ground, and leaves or turns back at the
// interface, (1 - F_i) (1 - F_o) rho / (pi eta^2 (1 - rho F_inside)); Mitsuba's default drops the rho below.
struct SmoothPlastic final : Each<SmoothPlastic> {
  PlasticParameters p;
  float inside, specular_weight;
  explicit SmoothPlastic(PlasticParameters parameters)
      : p(std::move(parameters)), inside(fresnel_diffuse(1 / p.eta)), specular_weight(specular_share(p)) {}
  Asks asks() const override { return std::max(asks_for(p.diffuse), asks_for(p.specular)); }
  float chance(float reflectance) const {
    const float s = reflectance * specular_weight, d = (1 - reflectance) * (1 - specular_weight);
    return s + d > 0 ? s / (s + d) : 1;
  }
  Lobes lobes() const override { return Lobes::both; }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override {
    if (!(wo.z > 0 && wi.z > 0)) return {};
    const float t = (1 - fresnel(wo.z, p.eta).reflectance) * (1 - fresnel(wi.z, p.eta).reflectance);
    return (cosine_pdf(wi) * t / (p.eta * p.eta)) * ground(eval(p.diffuse, place), inside, p.nonlinear);
  }
  float pdf(Direction wo, Direction wi, Place) const override {
    if (!(wo.z > 0 && wi.z > 0)) return 0;
    return (1 - chance(fresnel(wo.z, p.eta).reflectance)) * cosine_pdf(wi);
  }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const float reflectance = fresnel(wo.z, p.eta).reflectance, specular = chance(reflectance);
    const float u1 = to_unit_float(u()), u2 = to_unit_float(u());
    if (to_unit_float(u()) < specular) {
      return Scattered{mirror_direction(wo), 0, (reflectance / specular) * eval(p.specular, place), true};
    }
    const Direction wi = cosine_direction(u1, u2);
    const float density = (1 - specular) * cosine_pdf(wi);
    if (!(density > 0)) return std::nullopt;
    return Scattered{wi, density, (1 / density) * f_cos(wo, wi, place)};
  }
};

// What mirrors some of the light and lets the rest through: into two directions, and nowhere else.
template <class Self>
struct Clear : Each<Self> {
  float eta;
  Texture reflectance, transmittance;
  Clear(float e, Texture r, Texture t) : eta(e), reflectance(std::move(r)), transmittance(std::move(t)) {}
  Scattering::Asks asks() const override { return std::max(asks_for(reflectance), asks_for(transmittance)); }
  Rgb f_cos(Direction, Direction, Place) const override { return {}; }
  bool transmits() const override { return true; }
  Lobes lobes() const override { return Lobes::delta; }
  float pdf(Direction, Direction, Place) const override { return 0; }
};

// Radiance that is refracted is scaled by the square of the relative index: it is squeezed into a narrower
// cone (Veach 1997, 5.2).
struct Glass final : Clear<Glass> {
  using Clear::Clear;
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    const Dielectric f = fresnel(wo.z, eta);
    return scatter(wo, place, f, 1 / (f.eta * f.eta), u);
  }
  // Power is not squeezed.
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    return scatter(wi, place, fresnel(wi.z, eta), 1, u);
  }
  Scattered scatter(Direction w, Place place, const Dielectric& f, float squeeze, PathBits& u) const {
    if (to_unit_float(u()) < f.reflectance) return {mirror_direction(w), 0, eval(reflectance, place), true};
    return {{-w.x / f.eta, -w.y / f.eta, f.cos_theta_t}, 0, squeeze * eval(transmittance, place), true};
  }
};

// The light that is mirrored once, three times, ... inside: r + t r t + t r^3 t + ... = 2 r / (1 + r), where
// r + t = 1.
struct Pane final : Clear<Pane> {
  using Clear::Clear;
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    const float once = fresnel(std::abs(wo.z), eta).reflectance, all = 2 * once / (1 + once);
    if (to_unit_float(u()) < all) return Scattered{mirror_direction(wo), 0, eval(reflectance, place), true};
    return Scattered{-wo, 0, eval(transmittance, place), true};
  }
};

}  // namespace

ScatteringPtr thin_dielectric(float eta, Texture reflectance, Texture transmittance) {
  return std::make_shared<Pane>(eta, std::move(reflectance), std::move(transmittance));
}
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
