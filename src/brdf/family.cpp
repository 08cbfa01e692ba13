// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/family.hpp"

#include <cmath>

#include "reflectree/text/number_text.hpp"

namespace reflectree {

namespace {

// A member that keeps its family alive, evaluated in batches.
struct OwnedMember {
  AnyFamily family;
  Parameters at;

  BrdfTraits traits() const { return family.traits(at); }
  Spectrum operator()(const ShadingGeometry<float>& g) const { return family(g, at); }
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
    const std::vector<Parameters> same(geometry.size(), at);
    family.eval(geometry, same, out);
  }
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const {
    const auto channels = std::size_t(family.channels());
    std::vector<ShadingGeometry<float>> geometry;
    std::vector<std::size_t> above;
    for (std::size_t i = 0; i < wo.size(); ++i) {
      if (!(wo[i].z > 0 && wi[i].z > 0)) continue;
      geometry.push_back(shading_geometry(wo[i], wi[i]));
      above.push_back(i);
    }
    std::vector<float> values(geometry.size() * channels);
    eval(geometry, values);
    std::fill(out.begin(), out.end(), 0.f);
    for (std::size_t k = 0; k < above.size(); ++k)
      std::copy_n(&values[k * channels], channels, &out[above[k] * channels]);
  }
};

}  // namespace

AnyBrdf AnyFamily::member(const Parameters& at) const {
  for (std::size_t i = 0; i < ranges().size(); ++i) {
    const ParameterRange& r = ranges()[i];
    if (r.contains(at[i])) continue;
    throw Error(std::isfinite(at[i]) ? r.name + " is " + shortest_text(at[i]) : r.name + " is not finite",
                traits().name, "give it a number from " + shortest_text(r.lo) + " to " + shortest_text(r.hi));
  }
  return OwnedMember{*this, at};
}

}  // namespace reflectree
