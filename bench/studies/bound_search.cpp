// SPDX-License-Identifier: Apache-2.0
#include "bound_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree::study {

namespace {

constexpr int starts = 16, steps = 48;

// What else is known of the viewer: its azimuth, a family's parameters.
constexpr std::size_t most_beyond = 1 + max_parameters;
struct Place {
  float c, x, y;  // cos theta_o, and across the leaf
  bool mirrored;
  std::array<float, most_beyond> beyond;
  std::uint32_t image;  // which of the viewers that fold to the same: bit 0 turns x around, bit 1 y
};

struct Range {
  float lo, hi;
};
struct KnownSlab {
  Range c;
  std::array<Range, most_beyond> beyond;
};

using Value = std::function<Spectrum(const ShadingGeometry<float>&, const Parameters&)>;
struct Searched {
  const PackedSampler& packed;
  Value f;
  bool turned;  // f is evaluated where wo has no y
  std::size_t beyond;
};

// In order of the packed slabs.
std::vector<KnownSlab> known_slabs(const SamplerData& data, const PackedSampler& packed) {
  const std::vector<KnownParameter>& parameters = data.parameters;
  const std::size_t axes = data.exact_partition.coordinates.size();
  const std::size_t first_parameter = axes - parameters.size();
  std::vector<KnownSlab> out;
  if (axes == 1) {
    const std::vector<float>& borders = packed.exact.lookup.borders();
    // The next slab begins at its border.
    for (std::size_t s = 0; s < packed.exact.slabs.size(); ++s) {
      const bool last = s + 1 == packed.exact.slabs.size();
      out.push_back({{borders[s], last ? 1.f : std::nextafter(borders[s + 1], 0.f)}, {}});
    }
    return out;
  }
  for (const SlabBox& box : slab_boxes(data.exact_partition)) {
    KnownSlab slab{{std::max(std::cos(box.hi[0]), min_cos_theta_o), std::cos(box.lo[0])}, {}};
    for (std::size_t k = 1; k < axes; ++k) {
      slab.beyond[k - 1] = {box.lo[k], box.hi[k]};
      if (k >= first_parameter) {
        const KnownParameter& p = parameters[k - first_parameter];
        slab.beyond[k - 1] = {value_of(p, box.lo[k]), value_of(p, box.hi[k])};
      }
    }
    out.push_back(slab);
  }
  return out;
}

// One leaf with the viewers of its slab.
class LeafSearch {
 public:
  LeafSearch(const Searched& searched, const KnownSlab& slab, std::uint32_t index, std::uint32_t leaf,
             Pcg32 u)
      : searched_(searched),
        packed_(searched.packed),
        known_(slab),
        slab_(packed_.exact.slabs[index]),
        leaf_(packed_.exact.leaves[leaf]),
        index_(leaf),
        u_(u) {}

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
    const auto [lo, hi] = known_.c;
    const float t = across();
    const float c = u_() & 1U ? lo + (hi - lo) * t : lo * std::pow(hi / lo, t);
    Place p{std::clamp(c, lo, hi), across(), across(), (u_() & 1U) != 0, {}, 0};
    for (std::size_t i = 0; i < searched_.beyond; ++i) {
      const Range& r = known_.beyond[i];
      p.beyond[i] = std::clamp(r.lo + (r.hi - r.lo) * across(), r.lo, r.hi);
    }
    if (searched_.beyond > 0) p.image = u_() % 4;
    return p;
  }
  // One coordinate or all, by a share of itself or of the whole.
  Place beside(const Place& p) {
    const float size = std::exp2(-22 * uniform());
    const std::uint32_t all = 3, which = u_() % std::uint32_t(4 + searched_.beyond);
    const auto moved = [&](float v, float lo, float hi) {
      const float by = (2 * uniform() - 1) * size;
      const float near = std::min(v - lo, hi - v);
      return std::clamp(v + by * (u_() & 1U ? near : hi - lo), lo, hi);
    };
    Place out = p;
    if (which == 0 || which == all) out.c = moved(p.c, known_.c.lo, known_.c.hi);
    if (which == 1 || which == all) out.x = moved(p.x, 0, 1);
    if (which == 2 || which == all) out.y = moved(p.y, 0, 1);
    for (std::uint32_t i = 0; i < searched_.beyond; ++i) {
      if (which == 4 + i || which == all)
        out.beyond[i] = moved(p.beyond[i], known_.beyond[i].lo, known_.beyond[i].hi);
    }
    return out;
  }
  Direction viewer(const Place& p) const {
    const float sine = std::sqrt((1 - p.c) * (1 + p.c));
    const ViewerSymmetry symmetry = packed_.viewer.frame.symmetry;
    if (packed_.viewer.frame.isotropic()) return {sine, 0, p.c};
    const float phi = p.beyond[0];
    Direction wo{sine * std::cos(phi), sine * std::sin(phi), p.c};
    const bool half_turn = symmetry == ViewerSymmetry::half_turn || symmetry == ViewerSymmetry::two_planes;
    if (half_turn && (p.image & 1U) != 0) wo.x = -wo.x, wo.y = -wo.y;
    if (is_mirrored(symmetry) && (p.image & 2U) != 0) wo.y = -wo.y;
    return turn(wo, packed_.viewer.cos_axis, packed_.viewer.sin_axis);
  }
  double ratio(const Place& p) {
    Parameters at{};
    const std::size_t first = packed_.viewer.frame.isotropic() ? 0 : 1;
    for (std::size_t i = first; i < searched_.beyond; ++i) at[i - first] = p.beyond[i];
    Incidence in;
    if (!find_incidence(packed_, viewer(p), at, in)) return 0;
    if (&slab_at(packed_, packed_.exact, in) != &slab_) return 0;  // rounded to the other side of a border
    const bool half = packed_.domain.half();
    const detail::PointInLeaf place = detail::point_at(leaf_, half, p.x, p.y);
    const DomainPoint point =
        lift(domain_at(packed_.viewer, packed_.domain, in), in.wo, place.p, half && p.mirrored);
    const Spectrum f = searched_.f(known_geometry(in, point.geometry, searched_.turned), at);
    const double target = double(packed_.target(f) * point.projected_area);
    const double unit = double(in.albedo) * double(place.height);
    const double value = unit > 0 ? target / unit : 0;
    out_.above += value > 1;
    if (value > out_.worst) out_.worst = value, out_.theta_o = std::acos(double(p.c)), out_.leaf = index_;
    return value;
  }

  const Searched& searched_;
  const PackedSampler& packed_;
  const KnownSlab& known_;
  const PackedSlab& slab_;
  const PackedLeaf& leaf_;
  std::uint32_t index_;
  Pcg32 u_;
  BoundFindings out_;
};

BoundFindings search_all(const SamplerData& data, const PackedSampler& packed, Value f, bool turned,
                         const BoundSearch& options, const Host& host) {
  const Searched searched{packed, std::move(f), turned && packed.viewer.frame.isotropic(),
                          data.exact_partition.coordinates.size() - 1};
  const std::vector<KnownSlab> known = known_slabs(data, packed);
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
        const std::uint32_t slab = slab_of[k];
        found[k] = LeafSearch(searched, known[slab], slab, leaf, Pcg32(options.seed, k)).run(rounds);
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

}  // namespace

BoundFindings search_bounds(const SamplerData& data, const PackedSampler& packed, const AnyBrdf& f,
                            const BoundSearch& options, const Host& host) {
  const auto value = [&f](const ShadingGeometry<float>& g, const Parameters&) { return f(g); };
  return search_all(data, packed, value, f.traits().isotropic_by_formula, options, host);
}
BoundFindings search_bounds(const SamplerData& data, const PackedSampler& packed, const AnyFamily& f,
                            const BoundSearch& options, const Host& host) {
  const auto value = [&f](const ShadingGeometry<float>& g, const Parameters& at) { return f(g, at); };
  return search_all(data, packed, value, f.traits().isotropic_by_formula, options, host);
}

}  // namespace reflectree::study
