// SPDX-License-Identifier: Apache-2.0
#include "examine.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "reflectree/error.hpp"
#include "refuse.hpp"
#include "symmetry_of.hpp"

namespace reflectree::detail {

namespace {

constexpr float symmetric_enough = 1e-4f;  // mirror images are one function, up to rounding

Direction flipped(Direction w) { return {w.x, -w.y, w.z}; }

// The azimuth along which lobes reach farthest, and how much farther than across.
struct Ellipse {
  float axis = 0, ratio = 1;
};
Ellipse ellipse_of(const AnyBrdf& f, const Target& target) {
  constexpr int azimuths = 36;
  std::vector<float> reach;
  for (int i = 0; i < azimuths; ++i) reach.push_back(reach_at(f, target, pi * float(i) / azimuths));
  const auto longest = std::size_t(std::max_element(reach.begin(), reach.end()) - reach.begin());
  const float shortest = *std::min_element(reach.begin(), reach.end());
  Ellipse e;
  e.axis = pi * float(longest) / azimuths;
  e.ratio = shortest > 0 ? clamp(reach[longest] / shortest, 1.f, 400.f) : 1.f;
  return e;
}

// The largest channel that a climb from the brightest pair finds, where that is suspiciously dark: the pairs
// may have met nothing but the tail of a lobe.
float summit(const AnyBrdf& f, float largest, Direction wo, Direction wi) {
  if (largest == 0 || largest > 1e-6f) return largest;
  const Ridge ridge = follow_ridge(f, {TargetKind::maximum, 0, 1e30f}, acos(min(wo.z, 1.f)), wi);
  std::vector<Direction> o, i;
  for (std::size_t k = 0; k < ridge.lobe.size(); ++k) {
    o.push_back(wo_from_cosine(cos(ridge.theta_o[k]))), i.push_back(ridge.lobe[k].centre);
  }
  const Values values = values_at(f, o, i);
  return max(largest, *std::max_element(values.begin(), values.end()));
}

// The power of two that brings values near 1 whose squares would leave the range of float.
float scale_for(const AnyBrdf& f, float largest) {
  if (largest == 0 || (largest > 1e-15f && largest < 1e15f)) return 1;
  if (largest < 1e-35f) {
    char what[96];
    std::snprintf(what, sizeof what, "the BRDF returned no more than %.3g, where floats have few digits left",
                  double(largest));
    throw Error(what, f.traits().name, "multiply it by a constant and divide the weights by it");
  }
  return std::ldexp(1.f, -std::ilogb(largest));
}

// Takes a pair to where the symmetry folds its viewer.
void fold_pair(ViewerSymmetry symmetry, Direction& wo, Direction& wi) {
  const auto half_turn = [&] {
    for (Direction* w : {&wo, &wi}) w->x = -w->x, w->y = -w->y;
  };
  const auto mirror = [&] {
    for (Direction* w : {&wo, &wi}) w->y = -w->y;
  };
  if (symmetry == ViewerSymmetry::two_planes && wo.x < 0) half_turn();
  if (symmetry == ViewerSymmetry::half_turn && wo.y < 0) half_turn();
  const bool plane = symmetry == ViewerSymmetry::two_planes || symmetry == ViewerSymmetry::one_plane;
  if (plane && wo.y < 0) mirror();
}

// The frame of an anisotropic function, from pairs whose viewers lie at azimuth 0: they are turned about the
// normal at random.
void examine_anisotropic(const AnyBrdf& f, std::uint64_t seed, std::vector<Direction> wo,
                         std::vector<Direction> wi, Examination& seen) {
  turn_at_random(seed, wo, wi);
  const Values values = values_at(f, wo, wi);
  refuse_bad_values(f, values, wo, wi);
  const Ellipse lobe = ellipse_of(f, seen.target);
  seen.frame = frame_of(f, values, wo, wi, lobe.axis, seed);
  seen.mirror_symmetric = false, seen.asymmetry = 1;
  // Where the axis of the symmetry is not that of the lobe, nothing is stretched.
  const bool along = abs(cos(seen.frame.axis - lobe.axis)) > 0.99f;
  seen.stretch = along ? sqrt(lobe.ratio) : 1.f;
  const auto largest = std::max_element(values.begin(), values.end());
  const auto k = std::size_t(largest - values.begin()) / std::size_t(f.channels());
  const float c = cos(seen.frame.axis), s = -sin(seen.frame.axis);
  seen.brightest_wo = turn(wo[k], c, s), seen.brightest_wi = turn(wi[k], c, s);
  fold_pair(seen.frame.symmetry, seen.brightest_wo, seen.brightest_wi);
}

}  // namespace

float reach_at(const AnyBrdf& f, const Target& target, float phi) {
  constexpr int steps = 160;
  std::vector<Direction> wo, wi;
  const Direction normal{0, 0, 1};
  for (int i = 0; i <= steps; ++i) {
    const float slope = i == 0 ? 0.f : std::pow(10.f, -4 + 4 * float(i) / steps) * 0.41f;
    const Direction wh = normalize(Direction{slope * cos(phi), slope * sin(phi), 1});
    wo.push_back(normal), wi.push_back(reflect(normal, wh));
  }
  const Values values = values_at(f, wo, wi);
  const auto t = [&](int i) { return target(&values[std::size_t(i * f.channels())], f.channels()); };
  const float ground = t(steps), top = t(0);
  if (!(top > 1.5f * ground)) return 1;
  for (int i = 1; i <= steps; ++i) {
    if (t(i) - ground < 0.5f * (top - ground)) {
      const float a = t(i - 1) - ground, b = t(i) - ground, half = 0.5f * (top - ground);
      const float x = float(i - 1) + (a - half) / max(a - b, 1e-30f);
      return std::pow(10.f, -4 + 4 * x / steps);
    }
  }
  return 1;
}

Examination examine(const AnyBrdf& f, const BuildOptions& options, const std::vector<Ridge>& ridges) {
  std::vector<Direction> wo, wi;
  make_pairs(options.seed, wo, wi);
  add_lobe_pairs(f, ridges, wo, wi);
  const Values first = values_at(f, wo, wi);
  refuse_bad_values(f, first, wo, wi);
  const Values second = values_at(f, wo, wi);
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (first[k] == second[k]) continue;
    const std::size_t i = k / std::size_t(f.channels());
    throw Error(
        "two calls with the same directions gave different values: a stochastic function has no bounds",
        f.traits().name + " at " + describe(wo[i], wi[i]), "average it into a deterministic function");
  }
  Examination seen;
  seen.target = options.target;
  const auto largest = std::max_element(first.begin(), first.end());
  const auto brightest = std::size_t(largest - first.begin()) / std::size_t(f.channels());
  seen.brightest_wo = wo[brightest], seen.brightest_wi = wi[brightest];
  if (options.target.scale == 1)
    seen.target.scale = scale_for(f, summit(f, *largest, wo[brightest], wi[brightest]));
  if (is_anisotropic(f, first, wo, wi, options.seed)) {
    if (f.traits().isotropic_by_formula) {
      throw Error("the BRDF says that it is isotropic and changes when both directions turn about the normal",
                  f.traits().name, "leave isotropic_by_formula false in its traits");
    }
    examine_anisotropic(f, options.seed, wo, wi, seen);
    return seen;
  }
  std::vector<Direction> other_wi = wi;
  for (Direction& w : other_wi) w = flipped(w);
  const Values other = values_at(f, wo, other_wi);
  refuse_bad_values(f, other, wo, other_wi);
  seen.asymmetry = difference(first, other);
  seen.mirror_symmetric = seen.asymmetry <= symmetric_enough;
  return seen;
}

}  // namespace reflectree::detail
