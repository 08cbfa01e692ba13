// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/materials/scattering_family.hpp"

#include <algorithm>
#include <cmath>

#include "adjoint.hpp"
#include "each.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree::render {

namespace {

struct Members final : Each<Members> {
  FamilySampler<AnyFamily> sampler;
  bool exact, anisotropic;
  std::vector<Texture> at;
  Members(FamilySampler<AnyFamily> s, bool rejects, std::vector<Texture> textures)
      : sampler(std::move(s)),
        exact(rejects),
        anisotropic(!sampler.exact.family().f.traits().isotropic_by_formula),
        at(std::move(textures)) {}
  Asks asks() const override { return anisotropic ? Asks::frame : Asks::nothing; }

  // Interpolation and its rounding stay inside of the range: a mean of texels, and they are.
  Parameters parameters(Place place) const {
    const std::vector<ParameterRange>& ranges = sampler.exact.family().ranges;
    Parameters values{};
    for (std::size_t i = 0; i < ranges.size(); ++i)
      values[i] = clamp(eval(at[i], place).r, ranges[i].lo, ranges[i].hi);
    return values;
  }
  template <class Use>
  decltype(auto) with_mode(const Use& use) const {
    return exact ? use(sampler.exact) : use(sampler.one_shot);
  }
  Rgb f(Direction wo, Direction wi, const Parameters& values) const {
    return wo.z > 0 && wi.z > 0 ? to_rgb(sampler.exact.family().f(shading_geometry(wo, wi), values)) : Rgb{};
  }
  float density(Direction wo, Direction wi, const Parameters& values) const {
    return wo.z > 0 && wi.z > 0 ? with_mode([&](const auto& mode) { return mode.pdf(wo, wi, values); }) : 0;
  }

  Rgb f_cos(Direction wo, Direction wi, Place place) const override {
    return wi.z * f(wo, wi, parameters(place));
  }
  float pdf(Direction wo, Direction wi, Place place) const override {
    return density(wo, wi, parameters(place));
  }
  Value value(Direction wo, Direction wi, Place place) const override {
    const Parameters values = parameters(place);
    return {wi.z * f(wo, wi, values), density(wo, wi, values)};
  }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    if (!(wo.z > 0)) return std::nullopt;
    const Parameters values = parameters(place);
    UniformBits bits = u.lend();
    const auto drawn = with_mode([&](const auto& mode) { return mode.sample(wo, values, bits); });
    u.take_back(bits);
    if (!drawn) return std::nullopt;
    return Scattered{drawn->wi, drawn->pdf, to_rgb(drawn->weight)};
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    if (!(wi.z > 0)) return std::nullopt;
    const Parameters values = parameters(place);
    return draw_adjoint(
        0.1f, u,
        [&](UniformBits& bits) {
          return with_mode([&](const auto& mode) { return mode.sample(wi, values, bits); });
        },
        [&](Direction wo) { return density(wi, wo, values); },
        [&](Direction wo) { return f(wo, wi, values); });
  }
};

void check(const Texture& texture, const ParameterRange& range, const std::string& family) {
  const std::string within = "from " + shortest_text(range.lo) + " to " + shortest_text(range.hi);
  if (texture.attribute >= 0)
    throw Error(range.name + " is an attribute of a mesh", family, "give a number or a picture");
  const auto [low, high] =
      texture.picture ? [&] {
        const auto [a, b] = std::minmax_element(texture.picture->values.begin(), texture.picture->values.end());
        return std::pair(*a, *b);
      }()
                      : std::pair(texture.colour.r, texture.colour.r);
  const bool finite =
      !texture.picture || std::all_of(texture.picture->values.begin(), texture.picture->values.end(),
                                      [](float v) { return std::isfinite(v); });
  if (!finite) throw Error(range.name + " is a picture with a NaN or an infinity", family, "stay " + within);
  if (range.contains(low) && range.contains(high)) return;
  const std::string found =
      low == high ? shortest_text(low) : shortest_text(low) + " to " + shortest_text(high);
  throw Error(range.name + " is " + found, family, "stay " + within + ", or give the material a wider range");
}

}  // namespace

ScatteringPtr sampled_family(FamilySampler<AnyFamily> sampler, bool exact, std::vector<Texture> at) {
  const auto& family = sampler.exact.family();
  for (std::size_t i = 0; i < family.ranges.size(); ++i) check(at.at(i), family.ranges[i], family.name);
  return std::make_shared<Members>(std::move(sampler), exact, std::move(at));
}

}  // namespace reflectree::render
