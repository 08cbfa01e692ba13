// SPDX-License-Identifier: Apache-2.0
// Models with random parameters, and random pairs of directions.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/models/all.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {

inline double uniform(Pcg32& bits) { return to_unit_double(bits()); }

// A model with parameters drawn from their ranges: logarithmically where a range spans more than two decades.
template <class M>
M random_model(Pcg32& bits) {
  for (;;) {
    M model;
    for (const auto& p : M::describe().parameters) {
      const auto draw = [&] {
        const double u = uniform(bits);
        if (p.lo > 0 && p.hi / p.lo > 100) return float(p.lo * std::pow(double(p.hi) / double(p.lo), u));
        return float(p.lo + (p.hi - p.lo) * u);
      };
      const float grey = draw();
      const bool colour = uniform(bits) < 0.5;
      p.set(model, colour ? Rgb{grey, draw(), draw()} : Rgb{grey, grey, grey});
    }
    if constexpr (requires { model.fault(); }) {
      if (model.fault()) continue;
    }
    return model;
  }
}

inline Direction random_direction(Pcg32& bits) {
  const double z = std::max(uniform(bits), 1e-3), phi = 2 * pi_v<double> * uniform(bits),
               r = std::sqrt(1 - z * z);
  return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
}

struct Pair {
  Direction wo, wi;
};
// Any two directions, pairs near the mirror and back directions (at any distance from 1e-4 on), and pairs of
// which one or both graze at cos = 1e-5, which no lobe may turn into NaN or infinity.
inline std::vector<Pair> test_pairs(int count, Pcg32& bits) {
  std::vector<Pair> pairs;
  const auto near = [&](Direction w) {
    const float d = float(std::pow(10.0, -4 * uniform(bits)));
    const Direction e = random_direction(bits);
    w = normalize(Direction{w.x + d * e.x, w.y + d * e.y, w.z});
    return w;
  };
  for (int i = 0; i < count; ++i) {
    const Direction wo = random_direction(bits);
    pairs.push_back({wo, random_direction(bits)});
    pairs.push_back({wo, near({-wo.x, -wo.y, wo.z})});
    pairs.push_back({wo, near(wo)});
  }
  const float z = 1e-5f;
  const Direction grazing{1, 0, z}, slanted{-std::sqrt(0.75f), 0.5f, z}, up{0, 0, 1}, tilted{0.6f, 0, 0.8f};
  for (const Direction a : {grazing, slanted, Direction{-1, 0, z}, up, tilted}) {
    for (const Direction b : {grazing, slanted, Direction{-1, 0, z}, up, tilted}) pairs.push_back({a, b});
  }
  return pairs;
}

// All pairs in one call, from directions and from their geometry.
struct Evaluated {
  std::vector<ShadingGeometry<float>> geometry;
  std::vector<Rgb> of_directions, of_geometry;
};
inline Evaluated evaluated(const AnyBrdf& f, const std::vector<Pair>& pairs) {
  Evaluated e;
  std::vector<Direction> wo, wi;
  for (const Pair& p : pairs) {
    wo.push_back(p.wo), wi.push_back(p.wi);
    e.geometry.push_back(shading_geometry(p.wo, p.wi));
  }
  e.of_directions.resize(pairs.size()), e.of_geometry.resize(pairs.size());
  f.eval(wo, wi, {&e.of_directions[0].r, 3 * pairs.size()});
  f.eval(e.geometry, {&e.of_geometry[0].r, 3 * pairs.size()});
  return e;
}

}  // namespace reflectree
