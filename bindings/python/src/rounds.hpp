// SPDX-License-Identifier: Apache-2.0
// Directions as Python draws them, for judges: by rounds, into rows of their own.
#pragma once

#include "reflectree/simd/sample_rounds.hpp"
#include "sampler.hpp"

namespace reflectree::python {

enum class Mode { exact, one_shot, points };  // points: one-shot mode from pairs of uniforms

class DrawnRows {
 public:
  DrawnRows(const PySampler& s, std::size_t n)
      : channels(std::size_t(s.brdf.f.channels())), wi(n), pdf(n), weight(n * channels), valid(n) {}
  SampleRows rows() { return {wi, pdf, weight, valid}; }

  std::size_t channels;
  std::vector<Direction> wi;
  std::vector<float> pdf, weight;
  std::vector<std::uint8_t> valid;
};

// One direction for each wo.
inline DrawnRows draw(const PySampler& s, Mode mode, std::span<const Direction> wo, Pcg32& u) {
  DrawnRows drawn(s, wo.size());
  const LaneFunction* lanes = s.brdf.lanes.get();
  if (mode == Mode::exact) {
    sample_rounds(s.sampler.exact, wo, {}, u, drawn.rows(), s.brdf.batch(), NoStatistics{}, lanes);
    return drawn;
  }
  std::vector<Vec2<double>> points(mode == Mode::points ? wo.size() : 0);
  for (auto& p : points) p.x = to_unit_double(u()), p.y = to_unit_double(u());
  sample_rounds(s.sampler.one_shot, wo, points, u, drawn.rows(), s.brdf.batch(), lanes);
  return drawn;
}

}  // namespace reflectree::python
