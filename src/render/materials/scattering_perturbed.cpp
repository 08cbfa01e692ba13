// SPDX-License-Identifier: Apache-2.0
// Materials that let light pass, or stand about a normal of their own: masks, normal maps and bump maps.
#include <algorithm>
#include <cmath>

#include "cosine_lobe.hpp"
#include "each.hpp"
#include "reflectree/render/materials/scattering.hpp"
#include "reflectree/render/shapes/embree_scene.hpp"

namespace reflectree::render {

namespace {

struct Mask final : Each<Mask> {
  Texture opacity;
  ScatteringPtr inner;
  Mask(Texture t, ScatteringPtr i) : opacity(std::move(t)), inner(std::move(i)) {}
  float share(Place place) const { return clamp(eval(opacity, place).r, 0.f, 1.f); }
  Value value(Direction wo, Direction wi, Place place) const override {
    const float s = share(place);
    const Value v = inner->value(wo, wi, place);
    return {s * v.f_cos, s * v.pdf};
  }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override {
    return share(place) * inner->f_cos(wo, wi, place);
  }
  float pdf(Direction wo, Direction wi, Place place) const override {
    return share(place) * inner->pdf(wo, wi, place);
  }
  template <class Draw>
  std::optional<Scattered> drawn(Direction w, Place place, PathBits& u, const Draw& draw) const {
    const float s = share(place);
    if (!(to_unit_float(u()) < s)) return Scattered{-w, 0, {1, 1, 1}, true};
    auto found = draw();
    if (found) found->pdf *= s;
    return found;
  }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    return drawn(wo, place, u, [&] { return inner->sample(wo, place, u); });
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    return drawn(wi, place, u, [&] { return inner->sample_adjoint(wi, place, u); });
  }
  bool transmits() const override { return true; }
  Lobes lobes() const override { return inner->only_delta() ? Lobes::delta : Lobes::both; }
  bool has_pdf() const override { return inner->has_pdf(); }
  Asks asks() const override { return std::max(inner->asks(), asks_for(opacity)); }
};

// Both give a normal in the shading frame, of any length.
struct FromColours {
  Texture colours;
  Direction operator()(Place place) const {
    const Rgb c = eval(colours, place);
    return {2 * c.r - 1, 2 * c.g - 1, 2 * c.b - 1};
  }
  Scattering::Asks asks() const { return std::max(Scattering::Asks::frame, asks_for(colours)); }
};

// The surface's tangents, lifted by how the height grows along them (Blinn 1978); the normal's own change is
// left out, as in Mitsuba.
struct FromHeight {
  Texture height;
  float scale;
  Direction operator()(Place place) const {
    if (!place.detail) return {0, 0, 1};
    const Vec2<float> rise = gradient(height, place.uv);
    const Direction du{place.detail->du.x, place.detail->du.y, scale * rise.x},
        dv{place.detail->dv.x, place.detail->dv.y, scale * rise.y};
    const Direction n = cross(du, dv);
    return dot(place.detail->face, n) < 0 ? -n : n;
  }
  Scattering::Asks asks() const { return Scattering::Asks::detail; }
};

template <class Normal>
struct Perturbed final : Each<Perturbed<Normal>> {
  using Value = Scattering::Value;
  Normal normal;
  NormalRules rules;
  ScatteringPtr inner;
  Perturbed(Normal n, NormalRules r, ScatteringPtr i) : normal(std::move(n)), rules(r), inner(std::move(i)) {}

  LocalFrame<float> frame(Direction wo, Place place) const {
    Direction n = normal(place);
    if (rules.flip_invalid && !(wo.z * dot(wo, n) > 0)) n = {-n.x, -n.y, n.z};
    const float size2 = dot(n, n);
    return frame_along(size2 > 0 ? (1 / std::sqrt(size2)) * n : Direction{0, 0, 1}, {1, 0, 0});
  }
  // Smith's masking of a GGX surface whose width grows with the bend.
  float lit(Direction n, Direction wi) const {
    if (!rules.shadowing) return 1;
    const auto tan2 = [](Direction w) { return sin2_theta(w) / max(w.z * w.z, 1e-20f); };
    return 2 / (1 + std::sqrt(1 + min(.125f * tan2(n), 1.f) * tan2(wi)));
  }
  Value value(Direction wo, Direction wi, Place place) const override {
    const LocalFrame<float> f = frame(wo, place);
    const Direction in = to_local(f, wi);
    if (!(wi.z * in.z > 0)) return {};
    const Value v = inner->value(to_local(f, wo), in, place);
    return {lit(f.n, wi) * v.f_cos, v.pdf};
  }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override { return value(wo, wi, place).f_cos; }
  float pdf(Direction wo, Direction wi, Place place) const override { return value(wo, wi, place).pdf; }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    const LocalFrame<float> f = frame(wo, place);
    auto drawn = inner->sample(to_local(f, wo), place, u);
    if (!drawn) return drawn;
    const Direction wi = to_world(f, drawn->wi);
    if (!(wi.z * drawn->wi.z > 0)) return std::nullopt;
    drawn->wi = wi, drawn->weight = lit(f.n, wi) * drawn->weight;
    return drawn;
  }
  // A mirror about another normal is not reciprocal about this one.
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    auto drawn = Scattering::sample_adjoint(wi, place, u);
    if (drawn && drawn->delta) drawn->weight = std::abs(drawn->wi.z / wi.z) * drawn->weight;
    return drawn;
  }
  bool transmits() const override { return inner->transmits(); }
  Lobes lobes() const override { return inner->lobes(); }
  bool has_pdf() const override { return inner->has_pdf(); }
  Scattering::Asks asks() const override { return std::max(normal.asks(), inner->asks()); }
};

}  // namespace

ScatteringPtr mask(Texture opacity, ScatteringPtr inner) {
  return std::make_shared<Mask>(std::move(opacity), std::move(inner));
}
ScatteringPtr normal_map(Texture normals, NormalRules rules, ScatteringPtr inner) {
  return std::make_shared<Perturbed<FromColours>>(FromColours{std::move(normals)}, rules, std::move(inner));
}
ScatteringPtr bump_map(Texture height, float scale, NormalRules rules, ScatteringPtr inner) {
  return std::make_shared<Perturbed<FromHeight>>(FromHeight{std::move(height), scale}, rules,
                                                 std::move(inner));
}

}  // namespace reflectree::render
