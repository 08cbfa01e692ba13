// SPDX-License-Identifier: Apache-2.0
#include "bound_search.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree::study {

namespace {

constexpr int starts = 16, steps = 48;

struct Place {
  float c, x, y;  // cos theta_o, and across the leaf
  bool mirrored;
};

// One leaf with the viewers of its slab.
class LeafSearch {
 public:
  LeafSearch(const PackedSampler& packed, const AnyBrdf& f, std::uint32_t slab, std::uint32_t leaf, Pcg32 u)
      : packed_(packed), f_(f), leaf_(packed.exact.leaves[leaf]), index_(leaf), u_(u) {
    const std::vector<float>& borders = packed.exact.lookup.borders();
    // The next slab begins at its border.
    lo_ = borders[slab];
    hi_ = slab + 1 == packed.exact.slabs.size() ? 1.f : std::nextafter(borders[slab + 1], 0.f);
  }

  BoundFindings run(std::uint64_t rounds) {
    for (std::uint64_t r = 0; r < rounds; ++r) {
      Place best = start();
      double height = ratio(best);
      for (int i = 1; i < starts; ++i) {
        const Place next = start();
        const double value = ratio(next);
        if (value > height) height = value, best = next;
      }
      for (int i = 0; i < steps; ++i) {
        const Place next = beside(best);
        const double value = ratio(next);
        if (value > height) height = value, best = next;
      }
    }
    out_.leaves = out_.above > 0;
    return out_;
  }

 private:
  float uniform() { return to_unit_float(u_()); }
  // In [0, 1]: anywhere, at an end, or near one.
  float across() {
    const std::uint32_t kind = u_() % 8;
    if (kind < 4) return uniform();
    const float off = kind == 4 ? 0 : std::exp2(-24 * uniform());
    return u_() & 1U ? off : 1 - off;
  }
  // Cosines, or their logarithms.
  Place start() {
    const float t = across();
    const float c = u_() & 1U ? lo_ + (hi_ - lo_) * t : lo_ * std::pow(hi_ / lo_, t);
    return {std::clamp(c, lo_, hi_), across(), across(), (u_() & 1U) != 0};
  }
  // One coordinate or all, by a share of itself or of the whole.
  Place beside(const Place& p) {
    const float size = std::exp2(-22 * uniform());
    const std::uint32_t which = u_() % 4;
    const auto moved = [&](float v, float lo, float hi) {
      const float by = (2 * uniform() - 1) * size;
      const float near = std::min(v - lo, hi - v);
      return std::clamp(v + by * (u_() & 1U ? near : hi - lo), lo, hi);
    };
    Place out = p;
    if (which == 0 || which == 3) out.c = moved(p.c, lo_, hi_);
    if (which == 1 || which == 3) out.x = moved(p.x, 0, 1);
    if (which == 2 || which == 3) out.y = moved(p.y, 0, 1);
    return out;
  }
  double ratio(const Place& p) {
    const Direction wo{std::sqrt((1 - p.c) * (1 + p.c)), 0, p.c};
    const bool half = packed_.domain.half();
    const detail::PointInLeaf at = detail::point_at(leaf_, half, p.x, p.y);
    const DomainPoint point = lift(packed_.domain, wo, at.p, half && p.mirrored);
    const double target = double(packed_.target(f_(point.geometry)) * point.projected_area);
    const double unit = double(packed_.viewer.albedo.at(p.c)) * double(at.height);
    const double value = unit > 0 ? target / unit : 0;
    out_.above += value > 1;
    if (value > out_.worst) out_.worst = value, out_.theta_o = std::acos(double(p.c)), out_.leaf = index_;
    return value;
  }

  const PackedSampler& packed_;
  const AnyBrdf& f_;
  const PackedLeaf& leaf_;
  std::uint32_t index_;
  float lo_ = 0, hi_ = 1;
  Pcg32 u_;
  BoundFindings out_;
};

}  // namespace

BoundFindings search_bounds(const PackedSampler& packed, const AnyBrdf& f, const BoundSearch& options,
                            const Host& host) {
  const std::size_t leaves = packed.exact.leaves.size();
  const std::uint64_t rounds = options.evaluations / (leaves * (starts + steps)) + 1;
  std::vector<std::uint32_t> slab_of(leaves);
  for (std::uint32_t s = 0; s < packed.exact.slabs.size(); ++s) {
    const PackedSlab& slab = packed.exact.slabs[s];
    std::fill_n(slab_of.begin() + slab.first, slab.count, s);
  }
  std::vector<BoundFindings> found(leaves);
  constexpr std::size_t batch = 16;
  for (std::size_t first = 0; first < leaves; first += batch) {
    host.progress(float(first) / float(leaves));
    host.parallel_for(std::min(batch, leaves - first), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = first + begin; k < first + end; ++k) {
        const auto leaf = std::uint32_t(k);
        found[k] = LeafSearch(packed, f, slab_of[k], leaf, Pcg32(options.seed, k)).run(rounds);
      }
    });
  }
  BoundFindings out;
  for (const BoundFindings& one : found) {
    out.above += one.above, out.leaves += one.leaves;
    if (one.worst > out.worst) out.worst = one.worst, out.theta_o = one.theta_o, out.leaf = one.leaf;
  }
  return out;
}

}  // namespace reflectree::study
