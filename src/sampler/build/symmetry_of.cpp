// SPDX-License-Identifier: Apache-2.0
#include "symmetry_of.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "examine.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree::detail {

namespace {

constexpr float isotropic_enough = 3e-4f;  // relative, of every pair, beyond what rounding explains

// What f takes on beside a pair, where rounding moves directions: lowest and highest, per channel.
struct Range {
  float lo, hi;
};
std::vector<Range> ranges_beside(const AnyBrdf& f, Direction wo, Direction wi, Pcg32& u) {
  constexpr std::size_t neighbours = 24;
  constexpr float far = 4e-7f;
  const auto moved = [&u](Direction w) {
    const auto shift = [&u] { return far * (2 * to_unit_float(u()) - 1); };
    return normalize(Direction{w.x + shift(), w.y + shift(), max(w.z + shift(), 1e-7f)});
  };
  std::vector<Direction> o{wo}, i{wi};
  while (o.size() < neighbours) o.push_back(moved(wo)), i.push_back(moved(wi));
  const auto channels = std::size_t(f.channels());
  const Values values = values_at(f, o, i);
  std::vector<Range> ranges(channels, {1e38f, -1e38f});
  for (std::size_t k = 0; k < values.size(); ++k) {
    Range& r = ranges[k % channels];
    r = {min(r.lo, values[k]), max(r.hi, values[k])};
  }
  return ranges;
}

// A pair at which f is not what it is at the images of both directions.
struct Change {
  std::size_t pair;
  float here, there;
};

// Whether f changes when `image(k, w)` takes both directions of pair k elsewhere, by more than rounding
// explains: the pairs that change most are looked at again among their neighbours.
template <class Image>
std::optional<Change> change_under(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                                   const std::vector<Direction>& wi, std::uint64_t seed, const Image& image) {
  const std::size_t looked_at = std::min<std::size_t>(64, wo.size());
  const auto channels = std::size_t(f.channels());
  std::vector<Direction> other_wo = wo, other_wi = wi;
  for (std::size_t k = 0; k < wo.size(); ++k) other_wo[k] = image(k, wo[k]), other_wi[k] = image(k, wi[k]);
  const Values other = values_at(f, other_wo, other_wi);
  refuse_bad_values(f, other, other_wo, other_wi);
  double mean = 0;
  for (const float v : values) mean += double(v) / double(values.size());
  const auto floor = float(1e-6 * mean);
  std::vector<float> change(wo.size(), 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const float c = abs(values[k] - other[k]) / (max(values[k], other[k]) + floor + 1e-38f);
    change[k / channels] = max(change[k / channels], c);
  }
  std::vector<std::size_t> order(wo.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::partial_sort(
      order.begin(), order.begin() + std::ptrdiff_t(looked_at), order.end(),
      [&](std::size_t a, std::size_t b) { return change[a] != change[b] ? change[a] > change[b] : a < b; });
  Pcg32 jitter(seed, 14);
  for (std::size_t n = 0; n < looked_at && change[order[n]] > isotropic_enough; ++n) {
    const std::size_t k = order[n];
    const auto here = ranges_beside(f, wo[k], wi[k], jitter),
               there = ranges_beside(f, other_wo[k], other_wi[k], jitter);
    for (std::size_t c = 0; c < channels; ++c) {
      const float gap = max(here[c].lo - there[c].hi, there[c].lo - here[c].hi);
      if (gap <= isotropic_enough * max(here[c].hi, there[c].hi) + floor) continue;
      return Change{k, values[k * channels + c], other[k * channels + c]};
    }
  }
  return std::nullopt;
}

// How much f differs from its mirror image about the vertical plane at an azimuth.
float lopsided(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
               const std::vector<Direction>& wi, float axis) {
  std::vector<Direction> other_wo = wo, other_wi = wi;
  const float c = cos(2 * axis), s = sin(2 * axis);
  const auto image = [&](Direction w) { return Direction{c * w.x + s * w.y, s * w.x - c * w.y, w.z}; };
  for (std::size_t k = 0; k < wo.size(); ++k) other_wo[k] = image(wo[k]), other_wi[k] = image(wi[k]);
  return difference(values, values_at(f, other_wo, other_wi));
}

// A mirror plane nearby, by golden sections of what the mirror image differs by.
float nearest_plane(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                    const std::vector<Direction>& wi, float guess) {
  constexpr float golden = 0.618034f;
  float lo = guess - 0.06f, hi = guess + 0.06f;
  float a = hi - golden * (hi - lo), b = lo + golden * (hi - lo);
  float at_a = lopsided(f, values, wo, wi, a), at_b = lopsided(f, values, wo, wi, b);
  for (int round = 0; round < 40 && hi - lo > 1e-6f; ++round) {
    if (at_a <= at_b) {
      hi = b, b = a, at_b = at_a, a = hi - golden * (hi - lo), at_a = lopsided(f, values, wo, wi, a);
    } else {
      lo = a, a = b, at_a = at_b, b = lo + golden * (hi - lo), at_b = lopsided(f, values, wo, wi, b);
    }
  }
  return at_a <= at_b ? a : b;
}

}  // namespace

bool is_anisotropic(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                    const std::vector<Direction>& wi, std::uint64_t seed) {
  Pcg32 u(seed, 12);
  std::vector<float> angle(wo.size());
  for (float& a : angle) a = 6.2831853f * to_unit_float(u());
  const auto turned = [&](std::size_t k, Direction w) { return turn(w, cos(angle[k]), sin(angle[k])); };
  if (change_under(f, values, wo, wi, seed, turned)) return true;
  if (f.traits().isotropic_by_formula) return false;  // it is asked at azimuth 0 alone
  // Pairs stand at azimuth 0. Where f leaps there, their neighbours take on all that it is on either side.
  std::vector<Direction> any_wo = wo, any_wi = wi;
  turn_at_random(seed, any_wo, any_wi);
  const Values there = values_at(f, any_wo, any_wi);
  refuse_bad_values(f, there, any_wo, any_wi);
  return change_under(f, there, any_wo, any_wi, seed, turned).has_value();
}

ViewerFrame frame_of(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                     const std::vector<Direction>& wi, float lobe_axis, std::uint64_t seed) {
  // Tables made of patches stay in their own frame, where their borders are those of slabs to the last bit: folded
  // or turned ones would round.
  if (!f.traits().patches.empty()) return {ViewerSymmetry::none, 0};
  const auto holds = [&](const auto& image) { return !change_under(f, values, wo, wi, seed, image); };
  const auto mirrors = [&](float axis) {
    const float c = cos(2 * axis), s = sin(2 * axis);
    return holds([&](std::size_t, Direction w) {
      return Direction{c * w.x + s * w.y, s * w.x - c * w.y, w.z};
    });
  };
  const bool half_turn = holds([](std::size_t, Direction w) { return Direction{-w.x, -w.y, w.z}; });
  std::vector<float> guesses{0, 0.5f * pi, 0.25f * pi, 0.75f * pi};
  if (f.traits().axis) guesses.insert(guesses.begin(), *f.traits().axis);
  for (const float guess : guesses) {
    if (!mirrors(guess)) continue;
    // Of both planes of a half turn the one along the lobe is the axis.
    const bool across = half_turn && abs(cos(guess - lobe_axis)) < 0.7f;
    return {half_turn ? ViewerSymmetry::two_planes : ViewerSymmetry::one_plane,
            across ? guess + 0.5f * pi : guess};
  }
  const float refined = nearest_plane(f, values, wo, wi, lobe_axis);
  if (mirrors(refined)) return {half_turn ? ViewerSymmetry::two_planes : ViewerSymmetry::one_plane, refined};
  // Tables stay in their own frame, in whose cells borders lie well.
  const float axis = f.traits().phi_o_knots.empty() ? lobe_axis : 0.f;
  return {half_turn ? ViewerSymmetry::half_turn : ViewerSymmetry::none, axis};
}

bool has_symmetry(const AnyBrdf& f, const ViewerFrame& frame, std::uint64_t seed) {
  if (frame.symmetry == ViewerSymmetry::none) return true;
  std::vector<Direction> wo, wi;
  make_pairs(seed, wo, wi);
  turn_at_random(seed, wo, wi);
  const Values values = values_at(f, wo, wi);
  const auto holds = [&](const auto& image) { return !change_under(f, values, wo, wi, seed, image); };
  if (frame.isotropic()) return !is_anisotropic(f, values, wo, wi, seed);
  const bool turns =
      frame.symmetry == ViewerSymmetry::half_turn || frame.symmetry == ViewerSymmetry::two_planes;
  if (turns && !holds([](std::size_t, Direction w) { return Direction{-w.x, -w.y, w.z}; })) return false;
  if (!is_mirrored(frame.symmetry)) return true;
  const float c = cos(2 * frame.axis), s = sin(2 * frame.axis);
  return holds([&](std::size_t, Direction w) {
    return Direction{c * w.x + s * w.y, s * w.x - c * w.y, w.z};
  });
}

}  // namespace reflectree::detail
