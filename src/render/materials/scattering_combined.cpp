// SPDX-License-Identifier: Apache-2.0
// Any function with any sampler; and materials made of others.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "adjoint.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

namespace {

struct Sampled final : Scattering {
  AnyBrdf f;
  AnySampler<Spectrum> sampler;
  std::optional<AnySampler<Spectrum>> adjoint;
  bool anisotropic;
  Sampled(AnyBrdf function, AnySampler<Spectrum> s, std::optional<AnySampler<Spectrum>> light_side)
      : f(std::move(function)),
        sampler(std::move(s)),
        adjoint(std::move(light_side)),
        anisotropic(!f.traits().isotropic_by_formula) {}
  Asks asks() const override { return anisotropic ? Asks::frame : Asks::nothing; }
  Rgb f_cos(Direction wo, Direction wi, Place) const override {
    return wo.z > 0 && wi.z > 0 ? wi.z * to_rgb(eval(f, wo, wi)) : Rgb{};
  }
  float pdf(Direction wo, Direction wi, Place) const override {
    return wo.z > 0 && wi.z > 0 ? sampler.pdf(wo, wi) : 0;
  }
  std::optional<Scattered> sample(Direction wo, Place, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    UniformBits bits = u.lend();
    const auto drawn = sampler.sample(wo, bits);
    u.take_back(bits);
    if (!drawn) return std::nullopt;
    return Scattered{drawn->wi, drawn->pdf, to_rgb(drawn->weight)};
  }
  // f at up to `block` pairs, all above the surface, at once.
  static constexpr std::size_t block = 64;
  struct Together {
    const AnyBrdf& f;
    std::array<ShadingGeometry<float>, block> geometry;
    std::array<std::uint32_t, block> place;
    std::size_t count = 0;
    std::vector<float> channels = std::vector<float>(block * std::size_t(f.channels()));

    void add(std::size_t i, const ShadingGeometry<float>& g) {
      geometry[count] = g, place[count++] = std::uint32_t(i);
    }
    template <class Visit>
    void evaluate(const Visit& visit) {
      const auto n = std::size_t(f.channels());
      f.eval(std::span(geometry).first(count), std::span(channels).first(count * n));
      for (std::size_t k = 0; k < count; ++k) {
        const float* v = channels.data() + k * n;
        visit(place[k], n < 3 ? to_rgb(v[0]) : Rgb{v[0], v[1], v[2]});
      }
      count = 0;
    }
  };
  void values(std::span<const View> views, std::span<const Direction> wi,
              std::span<Value> out) const override {
    Together together{f, {}, {}};
    const auto finish = [&](std::size_t i, Rgb value) {
      const Rgb f_cos = wi[i].z * value;
      if (f_cos != Rgb{}) out[i] = {f_cos, sampler.pdf(views[i].wo, wi[i])};
    };
    for (std::size_t i = 0; i < views.size(); ++i) {
      out[i] = {};
      if (views[i].wo.z > 0 && wi[i].z > 0) together.add(i, shading_geometry(views[i].wo, wi[i]));
      if (together.count == block) together.evaluate(finish);
    }
    together.evaluate(finish);
  }
  void samples(std::span<const View> views, std::span<PathBits* const> u,
               std::span<std::optional<Scattered>> out) const override {
    if (!sampler.proposes()) return Scattering::samples(views, u, out);
    Together together{f, {}, {}};
    const auto finish = [&](std::size_t i, Rgb value) { out[i]->weight = out[i]->weight * value; };
    for (std::size_t i = 0; i < views.size(); ++i) {
      out[i].reset();
      if (!(views[i].wo.z > 0)) continue;
      UniformBits bits = u[i]->lend();
      const auto drawn = sampler.propose(views[i].wo, bits);
      u[i]->take_back(bits);
      if (!drawn) continue;
      out[i] = Scattered{drawn->wi, drawn->pdf, to_rgb(drawn->scale)};
      together.add(i, drawn->geometry);
      if (together.count == block) together.evaluate(finish);
    }
    together.evaluate(finish);
  }
  std::size_t sample_n(Direction wo, Place place, std::span<PathBits> u,
                       std::span<Scattered> out) const override {
    if (!sampler.divides() || u.size() == 1) return Scattering::sample_n(wo, place, u, out);
    if (!(wo.z > 0)) return 0;
    // Once per thread: a spectrum has room for 256 channels, and clearing 64 of them costs more than drawing.
    thread_local std::array<DirectionSample<Spectrum>, max_split> drawn;
    UniformBits bits = u[0].lend();
    const std::size_t filled = sampler.sample_n(wo, bits, std::span(drawn).first(u.size()));
    u[0].take_back(bits);
    for (std::size_t i = 0; i < filled; ++i) out[i] = {drawn[i].wi, drawn[i].pdf, to_rgb(drawn[i].weight)};
    return filled;
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    if (!(wi.z > 0)) return std::nullopt;
    if (adjoint) {
      UniformBits bits = u.lend();
      const auto drawn = adjoint->sample(wi, bits);
      u.take_back(bits);
      if (!drawn) return std::nullopt;
      return Scattered{drawn->wi, drawn->pdf, to_rgb(drawn->weight)};
    }
    return draw_adjoint(
        sampler.has_pdf() ? .1f : 1, u, [&](UniformBits& bits) { return sampler.sample(wi, bits); },
        [&](Direction wo) { return pdf(wi, wo, place); },
        [&](Direction wo) { return to_rgb(eval(f, wo, wi)); });
  }
  bool has_pdf() const override { return sampler.has_pdf(); }
};

struct Swapped {
  AnyBrdf f;
  Spectrum operator()(Direction wo, Direction wi) const { return eval(f, wi, wo); }
  // What is known of theta_o, knots and a factor, is known of theta_i here.
  BrdfTraits traits() const {
    BrdfTraits t;
    t.name = "adjoint of " + f.traits().name;
    t.channels = f.channels(), t.concurrent = f.traits().concurrent;
    t.isotropic = f.traits().isotropic, t.isotropic_by_formula = f.traits().isotropic_by_formula;
    return t;
  }
};

Lobes both(const Scattering& a, const Scattering& b) {
  return a.lobes() == b.lobes() ? a.lobes() : Lobes::both;
}

constexpr Direction flipped(Direction w) { return {w.x, w.y, -w.z}; }

struct TwoSided final : Scattering {
  ScatteringPtr front, back;
  TwoSided(ScatteringPtr a, ScatteringPtr b) : front(std::move(a)), back(std::move(b)) {}
  Rgb f_cos(Direction wo, Direction wi, Place place) const override {
    return wo.z > 0 ? front->f_cos(wo, wi, place) : back->f_cos(flipped(wo), flipped(wi), place);
  }
  float pdf(Direction wo, Direction wi, Place place) const override {
    return wo.z > 0 ? front->pdf(wo, wi, place) : back->pdf(flipped(wo), flipped(wi), place);
  }
  Value value(Direction wo, Direction wi, Place place) const override {
    return wo.z > 0 ? front->value(wo, wi, place) : back->value(flipped(wo), flipped(wi), place);
  }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    if (wo.z > 0) return front->sample(wo, place, u);
    auto drawn = back->sample(flipped(wo), place, u);
    if (drawn) drawn->wi = flipped(drawn->wi);
    return drawn;
  }
  std::size_t sample_n(Direction wo, Place place, std::span<PathBits> u,
                       std::span<Scattered> out) const override {
    if (wo.z > 0) return front->sample_n(wo, place, u, out);
    const std::size_t filled = back->sample_n(flipped(wo), place, u, out);
    for (Scattered& s : out.first(filled)) s.wi = flipped(s.wi);
    return filled;
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    if (wi.z > 0) return front->sample_adjoint(wi, place, u);
    auto drawn = back->sample_adjoint(flipped(wi), place, u);
    if (drawn) drawn->wi = flipped(drawn->wi);
    return drawn;
  }
  Lobes lobes() const override { return both(*front, *back); }
  bool has_pdf() const override { return front->has_pdf() && back->has_pdf(); }
  Asks asks() const override { return std::max(front->asks(), back->asks()); }
};

struct Blend final : Scattering {
  Texture weight;
  ScatteringPtr a, b;
  Blend(Texture w, ScatteringPtr first, ScatteringPtr second)
      : weight(std::move(w)), a(std::move(first)), b(std::move(second)) {}
  float share(Place place) const { return clamp(eval(weight, place).r, 0.f, 1.f); }
  Rgb f_cos(Direction wo, Direction wi, Place place) const override {
    const float w = share(place);
    return (1 - w) * a->f_cos(wo, wi, place) + w * b->f_cos(wo, wi, place);
  }
  float pdf(Direction wo, Direction wi, Place place) const override {
    const float w = share(place);
    return (1 - w) * a->pdf(wo, wi, place) + w * b->pdf(wo, wi, place);
  }
  Value value(Direction wo, Direction wi, Place place) const override {
    const float w = share(place);
    const Value of_a = a->value(wo, wi, place), of_b = b->value(wo, wi, place);
    return {(1 - w) * of_a.f_cos + w * of_b.f_cos, (1 - w) * of_a.pdf + w * of_b.pdf};
  }
  // One part is drawn by its share; where both have densities, its direction is weighed by the sum of both.
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    const float w = share(place);
    auto drawn = to_unit_float(u()) < w ? b->sample(wo, place, u) : a->sample(wo, place, u);
    if (!drawn || drawn->delta || !has_pdf()) return drawn;
    const Value v = value(wo, drawn->wi, place);
    if (!(v.pdf > 0)) return std::nullopt;
    drawn->pdf = v.pdf, drawn->weight = (1 / v.pdf) * v.f_cos;
    return drawn;
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    return to_unit_float(u()) < share(place) ? b->sample_adjoint(wi, place, u)
                                             : a->sample_adjoint(wi, place, u);
  }
  bool transmits() const override { return a->transmits() || b->transmits(); }
  Lobes lobes() const override { return both(*a, *b); }
  bool has_pdf() const override { return a->has_pdf() && b->has_pdf(); }
  Asks asks() const override { return std::max({a->asks(), b->asks(), asks_for(weight)}); }
};

}  // namespace

void Scattering::values(std::span<const View> views, std::span<const Direction> wi,
                        std::span<Value> out) const {
  for (std::size_t i = 0; i < views.size(); ++i) out[i] = value(views[i].wo, wi[i], views[i].place);
}

void Scattering::samples(std::span<const View> views, std::span<PathBits* const> u,
                         std::span<std::optional<Scattered>> out) const {
  for (std::size_t i = 0; i < views.size(); ++i) out[i] = sample(views[i].wo, views[i].place, *u[i]);
}

std::size_t Scattering::sample_n(Direction wo, Place place, std::span<PathBits> u,
                                 std::span<Scattered> out) const {
  std::size_t filled = 0;
  for (const PathBits& own : u) {
    PathBits bits = own;
    const auto drawn = sample(wo, place, bits);
    if (drawn) out[filled] = *drawn, u[filled++] = bits;
  }
  return filled;
}

std::optional<Scattered> Scattering::sample_adjoint(Direction wi, Place place, PathBits& u) const {
  auto drawn = sample(wi, place, u);
  if (!drawn || drawn->delta) return drawn;  // mirrors are reciprocal
  const Direction wo = drawn->wi;
  drawn->weight = std::abs(wo.z / wi.z) / drawn->pdf * f_cos(wo, wi, place);
  return drawn;
}

ScatteringPtr sampled(AnyBrdf f, AnySampler<Spectrum> sampler, std::optional<AnySampler<Spectrum>> adjoint) {
  return std::make_shared<Sampled>(std::move(f), std::move(sampler), std::move(adjoint));
}
AnyBrdf adjoint_of(AnyBrdf f) { return AnyBrdf(Swapped{std::move(f)}); }
ScatteringPtr two_sided(ScatteringPtr front, ScatteringPtr back) {
  return std::make_shared<TwoSided>(std::move(front), std::move(back));
}
ScatteringPtr blend(Texture weight, ScatteringPtr a, ScatteringPtr b) {
  return std::make_shared<Blend>(std::move(weight), std::move(a), std::move(b));
}

}  // namespace reflectree::render
