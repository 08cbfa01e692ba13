// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/erased.hpp"

namespace reflectree {
namespace {

ShadingGeometry<float> narrow(const ShadingGeometry<double>& g) {
  const auto vector = [](Vec3<double> v) { return Direction{float(v.x), float(v.y), float(v.z)}; };
  return {vector(g.wo),         vector(g.wi),         vector(g.wh),        float(g.cos_theta_o),
          float(g.cos_theta_i), float(g.cos_theta_h), float(g.cos_theta_d)};
}

}  // namespace

TargetFunction target_function(AnyBrdf f, Target target) {
  TargetFunction result;
  result.concurrent = f.traits().concurrent;
  result.eval = [f = std::move(f), target](Vec3<double> wo, std::span<const Vec3<double>> wi,
                                           std::span<double> t) {
    const auto channels = std::size_t(f.channels());
    std::vector<ShadingGeometry<float>> geometry;
    std::vector<std::size_t> place;
    geometry.reserve(wi.size());
    place.reserve(wi.size());
    for (std::size_t i = 0; i < wi.size(); ++i) {
      t[i] = 0;
      if (!(wo.z > 0) || !(wi[i].z > 0)) continue;
      const ShadingGeometry<float> g = narrow(shading_geometry(wo, wi[i]));
      if (!(g.cos_theta_i > 0)) continue;
      geometry.push_back(g);
      place.push_back(i);
    }
    std::vector<float> values(geometry.size() * channels);
    f.eval(geometry, values);
    for (std::size_t k = 0; k < place.size(); ++k) {
      t[place[k]] = target(values.data() + k * channels, int(channels));
    }
  };
  return result;
}

}  // namespace reflectree
