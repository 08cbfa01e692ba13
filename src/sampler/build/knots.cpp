// SPDX-License-Identifier: Apache-2.0
#include "knots.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::detail {

namespace {

std::vector<float> borders_of(std::vector<float> knots, float end) {
  constexpr float least = 1e-4f;
  std::sort(knots.begin(), knots.end());
  std::vector<float> borders{0};
  for (const float knot : knots) {
    if (knot > borders.back() + least && knot < end - least) borders.push_back(knot);
  }
  borders.push_back(end);
  return borders;
}

// Where f tells of a step that was found within a rounding, it knows the place better.
float told_at(float theta, const BrdfTraits& traits) {
  constexpr float rounding = 3e-7f;
  for (const float knot : traits.theta_o_knots) {
    if (abs(knot - theta) <= rounding) return knot;
  }
  return theta;
}

// An azimuth of f's frame, as the viewer's frame knows it.
float folded(float phi, const ViewerFrame& frame) {
  const float turn = 2 * pi, span = azimuth_span(frame.symmetry);
  const float period = is_mirrored(frame.symmetry) ? 2 * span : span;
  phi = std::fmod(phi - frame.axis, min(period, turn));
  if (phi < 0) phi += period;
  return phi > span ? 2 * span - phi : phi;
}

}  // namespace

std::vector<float> theta_borders(const Field& field, const Jumps* jumps) {
  const BrdfTraits traits = field.f.traits();
  std::vector<float> knots;
  // What was found stands first: a knot beside it is the same one.
  if (jumps) {
    for (const ThetaJump& jump : jumps->theta_o) knots.push_back(told_at(jump.at, traits));
  }
  constexpr float same = 1e-4f;
  const auto add = [&](float theta) {
    if (std::none_of(knots.begin(), knots.end(), [&](float k) { return abs(k - theta) < same; }))
      knots.push_back(theta);
  };
  for (const float theta : traits.theta_o_knots) add(theta);
  if (!field.frame.isotropic()) {
    for (const AzimuthKnots& band : traits.phi_o_knots) add(band.theta_o_end);
  }
  return borders_of(knots, theta_max);
}

std::vector<float> told_azimuths(const Field& field) {
  std::vector<float> all;
  for (const AzimuthKnots& band : field.f.traits().phi_o_knots) {
    for (const float phi : band.phi_o) all.push_back(folded(phi, field.frame));
  }
  return all;
}

bool leaps_at_ends(const Field& field) {
  if (field.frame.isotropic() || is_mirrored(field.frame.symmetry)) return false;  // both sides are alike
  const float span = azimuth_span(field.frame.symmetry);
  const std::vector<float> told = told_azimuths(field);
  return std::any_of(told.begin(), told.end(), [span](float phi) { return min(phi, span - phi) < 1e-4f; });
}

std::vector<float> azimuth_borders(const Field& field, const Jumps* jumps, float theta_lo, float theta_hi) {
  if (field.frame.isotropic()) return {0, 0};
  constexpr float same = 1e-4f;
  const auto is_among = [](const std::vector<float>& all, float phi) {
    return std::any_of(all.begin(), all.end(), [phi](float p) { return abs(p - phi) < same; });
  };
  std::vector<float> knots;
  const std::vector<float> told = told_azimuths(field);
  float begin = 0;
  for (const AzimuthKnots& band : field.f.traits().phi_o_knots) {
    const bool meets = band.theta_o_end > theta_lo + same && begin < theta_hi - same;
    for (const float azimuth : band.phi_o) {
      const float phi = folded(azimuth, field.frame);
      if (meets && !is_among(knots, phi)) knots.push_back(phi);
    }
    begin = band.theta_o_end;
  }
  // What was found is told of, if only in another band.
  for (std::size_t k = 0; jumps && k < jumps->phi_o.size(); ++k) {
    if (!is_among(told, jumps->phi_o[k])) knots.push_back(jumps->phi_o[k]);
  }
  return borders_of(knots, azimuth_span(field.frame.symmetry));
}

}  // namespace reflectree::detail
