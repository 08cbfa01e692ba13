// SPDX-License-Identifier: Apache-2.0
#include "examine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "reflectree/error.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/math/random.hpp"
#include "refuse.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t pairs = 4096;
constexpr float symmetric_enough = 1e-4f;  // mirror images are one function, up to rounding
constexpr float isotropic_enough = 3e-4f;  // relative, of every pair, beyond what rounding explains

Direction flipped(Direction w) { return {w.x, -w.y, w.z}; }

// Pairs in the plane of incidence of wo, spread by the maps of two domains so that lobes are met.
void make_pairs(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi) {
  Pcg32 u(seed, 11);
  while (wo.size() < pairs) {
    const float cos_theta_o = max(to_unit_float(u()), 1e-3f);
    const float shrink = wo.size() % 4 < 2 ? 1.f : to_unit_float(u());
    const Vec2<float> p{shrink * (2 * to_unit_float(u()) - 1), shrink * (2 * to_unit_float(u()) - 1)};
    const Domain domain{wo.size() % 2 ? DomainKind::half_vector : DomainKind::equal_area, Symmetry::none, 0};
    const Direction known = wo_from_cosine(cos_theta_o);
    const DomainPoint q = lift(domain, known, p);
    if (!(q.geometry.wi.z > 1e-3f)) continue;
    wo.push_back(known), wi.push_back(q.geometry.wi);
  }
}

// Beside the lobes that f tells of, and the ridges.
void add_lobe_pairs(const AnyBrdf& f, const std::vector<Ridge>& ridges, std::vector<Direction>& wo,
                    std::vector<Direction>& wi) {
  const auto add = [&](Direction known, const SharpLobe& lobe) {
    const LocalFrame<float> frame = frame_from_normal(lobe.centre);
    for (const float r : {0.f, 0.3f, 0.6f}) {
      for (const Direction& along : {frame.s, frame.t}) {
        const Direction w = normalize(lobe.centre + r * lobe.width * along);
        if (w.z > 1e-3f) wo.push_back(known), wi.push_back(w);
      }
    }
  };
  for (int k = 0; k < 16; ++k) {
    const float theta = 0.05f + 0.1f * float(k);
    const Direction known = wo_from_cosine(max(cos(theta), 1e-3f));
    if (f.traits().sharp) {
      for (const SharpLobe& lobe : f.traits().sharp(known)) add(known, lobe);
    }
    for (const Ridge& ridge : ridges) {
      if (const auto lobe = ridge.at(theta)) add(known, *lobe);
    }
  }
}

using Values = std::vector<float>;
Values values_at(const AnyBrdf& f, const std::vector<Direction>& wo, const std::vector<Direction>& wi) {
  Values values(wo.size() * std::size_t(f.channels()));
  f.eval(wo, wi, values);
  return values;
}

void refuse_bad_values(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                       const std::vector<Direction>& wi) {
  const auto channels = std::size_t(f.channels());
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (is_good(values[k])) continue;
    const std::size_t i = k / channels;
    refuse_values(std::span(values).subspan(i * channels, channels), f.traits().name, wo[i], wi[i]);
  }
}

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

// Sum of |a - b| over half the sum of both.
float difference(const Values& a, const Values& b) {
  double miss = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    miss += double(abs(a[i] - b[i])), sum += 0.5 * (double(a[i]) + double(b[i]));
  }
  return sum > 0 ? float(miss / sum) : 0.f;
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

// Whether f changes when both directions turn about the normal.
bool is_anisotropic(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                    const std::vector<Direction>& wi, std::uint64_t seed) {
  Pcg32 u(seed, 12);
  std::vector<float> angle(wo.size());
  for (float& a : angle) a = 6.2831853f * to_unit_float(u());
  return change_under(f, values, wo, wi, seed,
                      [&](std::size_t k, Direction w) { return turn(w, cos(angle[k]), sin(angle[k])); })
      .has_value();
}

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

// The largest symmetry that every pair confirms, with its axis.
ViewerFrame frame_of(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                     const std::vector<Direction>& wi, const Ellipse& lobe, std::uint64_t seed) {
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
    const bool across = half_turn && abs(cos(guess - lobe.axis)) < 0.7f;
    return {half_turn ? ViewerSymmetry::two_planes : ViewerSymmetry::one_plane,
            across ? guess + 0.5f * pi : guess};
  }
  const float refined = nearest_plane(f, values, wo, wi, lobe.axis);
  if (mirrors(refined)) return {half_turn ? ViewerSymmetry::two_planes : ViewerSymmetry::one_plane, refined};
  // Tables made of patches stay in their own frame, in whose cells borders lie well.
  const float axis = f.traits().phi_o_knots.empty() ? lobe.axis : 0.f;
  return {half_turn ? ViewerSymmetry::half_turn : ViewerSymmetry::none, axis};
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

// Pairs whose viewers lie at azimuth 0, turned about the normal.
void turn_at_random(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi) {
  Pcg32 u(seed, 15);
  for (std::size_t k = 0; k < wo.size(); ++k) {
    const float phi = 6.2831853f * to_unit_float(u()), c = cos(phi), s = sin(phi);
    wo[k] = turn(wo[k], c, s), wi[k] = turn(wi[k], c, s);
  }
}

// The frame of an anisotropic function, from pairs whose viewers lie at azimuth 0: they are turned about the
// normal at random.
void examine_anisotropic(const AnyBrdf& f, std::uint64_t seed, std::vector<Direction> wo,
                         std::vector<Direction> wi, Examination& seen) {
  turn_at_random(seed, wo, wi);
  const Values values = values_at(f, wo, wi);
  refuse_bad_values(f, values, wo, wi);
  const Ellipse lobe = ellipse_of(f, seen.target);
  seen.frame = frame_of(f, values, wo, wi, lobe, seed);
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
