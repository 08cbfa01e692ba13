// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/prove_albedo.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "build/check_options.hpp"
#include "build/enclosed_field.hpp"
#include "form_integral.hpp"
#include "panels.hpp"
#include "reflectree/error.hpp"

namespace reflectree {

namespace {

using namespace detail;

// Elevations of one slab, where the table is allowed the same error: a slab, or one of its parts below and beyond
// 89.9 degrees.
struct Part {
  KnownRange known;
  Elevations theta;
  std::span<const PackedLeaf> leaves;
};

std::vector<Part> parts_of(const EnclosedField& field, const PackedSampler& packed) {
  // A little beyond, so that nobody whom the larger error is not allowed stands there.
  const double border = std::acos(1.745e-3) + 1e-7;
  const std::vector<float>& borders = packed.exact.lookup.borders();
  std::vector<Part> parts;
  for (std::size_t i = 0; i < packed.exact.slabs.size(); ++i) {
    const PackedSlab& slab = packed.exact.slabs[i];
    const KnownRange known{borders[i], min(borders[i + 1], 1.f)};
    const Elevations theta = field.elevations(known);
    const auto leaves = std::span(packed.exact.leaves).subspan(slab.first, slab.count);
    const double cut = std::clamp(border, theta.lo, theta.hi);
    if (cut > theta.lo) parts.push_back({known, {theta.lo, cut}, leaves});
    if (cut < theta.hi) parts.push_back({known, {cut, theta.hi}, leaves});
  }
  return parts;
}

// theta_o and the two coordinates across the leaf.
constexpr std::size_t axes = 3;

// T over one leaf: boxes are halved until each adds at most `most` to the error.
class LeafIntegral {
 public:
  LeafIntegral(const EnclosedField& field, const Part& part, const PackedLeaf& leaf, double most,
               std::uint64_t limit)
      : field_(field), part_(part), leaf_(leaf), most_(most), limit_(limit) {}

  void run() {
    Box whole;
    whole.box = {{part_.theta.lo, 0, 0}, {part_.theta.hi, 1, 1}};
    whole.line = enclose(whole.box);
    open_.push_back(whole);
    while (!open_.empty()) {
      const Box b = open_.back();
      open_.pop_back();
      if (b.line.error <= most_ || boxes_ >= limit_ || b.depth == deepest) {
        sum_.add(b.node, b.line);
      } else {
        divide(b);
      }
    }
  }
  const ElevationSum& sum() const { return sum_; }
  std::uint64_t boxes() const { return boxes_; }

 private:
  static constexpr int deepest = 100;
  struct Box {
    ProofBox box;
    ElevationLine line;
    std::size_t node = 0;  // of its elevations
    // What halving along each axis would take off the error, as last tried; falls with the square of the side.
    std::array<double, axes> gain{};
    int age = 0, depth = 0;
  };

  ElevationLine enclose(const ProofBox& box) {
    ++boxes_;
    const EnclosedPoint p = field_.over(box, part_.known, leaf_);
    ElevationLine line = mean_over_square(p.target);
    double share = double(area_of(leaf_));
    for (std::size_t i = 1; i < axes; ++i) share *= box.hi[i] - box.lo[i];
    if (p.mirrored) {
      const ElevationLine other = mean_over_square(*p.mirrored);
      line.lo += other.lo, line.hi += other.hi, line.error += other.error;
      share *= 0.5;
    }
    return {line.lo * share, line.hi * share, line.error * share};
  }

  std::array<Box, 2> halves(const Box& b, std::size_t axis) {
    const double cut = 0.5 * (b.box.lo[axis] + b.box.hi[axis]);
    std::array<Box, 2> out{b, b};
    out[0].box.hi[axis] = out[1].box.lo[axis] = cut;
    for (Box& half : out) half.line = enclose(half.box), ++half.depth;
    return out;
  }
  // Halves of the elevations are errors of different viewers.
  static double left(const std::array<Box, 2>& two, std::size_t axis) {
    return (two[0].line.error + two[1].line.error) * (axis == 0 ? 0.5 : 1);
  }
  void divide(const Box& b) {
    constexpr int trusted = 2;
    std::size_t axis = 0;
    std::array<Box, 2> chosen;
    if (!(b.line.error < infinity)) {
      axis = std::size_t(b.depth) % axes;
      chosen = halves(b, axis);
    } else if (b.age > 0 && b.age <= trusted) {
      axis = std::size_t(std::max_element(b.gain.begin(), b.gain.end()) - b.gain.begin());
      chosen = halves(b, axis);
      for (Box& half : chosen) half.gain[axis] *= 0.25, ++half.age;
    } else {
      std::array<double, axes> gain{};
      for (std::size_t i = 0; i < axes; ++i) {
        const std::array<Box, 2> tried = halves(b, i);
        gain[i] = b.line.error - left(tried, i);
        if (i == 0 || gain[i] > gain[axis]) axis = i, chosen = tried;
      }
      for (Box& half : chosen) half.gain = gain, half.gain[axis] *= 0.25, half.age = 1;
    }
    if (axis == 0) chosen[0].node = sum_.lower_half(b.node), chosen[1].node = sum_.upper_half(b.node);
    for (const Box& half : chosen) open_.push_back(half);
  }

  const EnclosedField& field_;
  const Part& part_;
  const PackedLeaf& leaf_;
  double most_;
  std::uint64_t limit_, boxes_ = 0;
  ElevationSum sum_;
  std::vector<Box> open_;
};

// How far the table may be from the integral over some elevations, and how much of that the forms leave open;
// relative.
struct Miss {
  double miss = 0, open = 0;
};
Miss miss_of(const EnclosedField& field, const Part& part, double lo, double hi, const ElevationLine& line) {
  const AffineForm table = field.albedo(lo, hi, part.known);
  if (table.range.hi <= 0) return {};  // viewers whose albedo is 0 get no sample
  const double least = std::min(line.lo, line.hi) - line.error;
  if (!(least > 0) || !(line.error < infinity)) return {infinity, infinity};
  AffineForm integral;
  integral.middle = 0.5 * (line.lo + line.hi), integral.slope[0] = 0.5 * (line.hi - line.lo);
  integral.error = line.error * (1 + 0x1p-40);
  integral.range = {least, std::max(line.lo, line.hi) + line.error};
  const double off =
      std::max(upper_of_difference(table, 1, integral), upper_of_difference(integral, 1, table));
  const double allowed = times_allowed(float(std::cos(lo)));
  return {off / least / allowed, line.error / least / allowed};
}

// One pass over a part.
struct Pass {
  Miss worst;
  std::uint64_t boxes = 0;
};
Pass integrate(const EnclosedField& field, const Part& part, double most, std::uint64_t limit,
               const Host& host) {
  std::vector<LeafIntegral> leaves;
  leaves.reserve(part.leaves.size());
  for (const PackedLeaf& leaf : part.leaves)
    leaves.emplace_back(field, part, leaf, most, limit / part.leaves.size());
  host.parallel_for(leaves.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) leaves[k].run();
  });
  ElevationSum sum;
  Pass out;
  for (const LeafIntegral& leaf : leaves) sum.add(leaf.sum()), out.boxes += leaf.boxes();
  sum.visit(part.theta.lo, part.theta.hi, [&](double lo, double hi, const ElevationLine& line) {
    const Miss m = miss_of(field, part, lo, hi, line);
    out.worst.miss = std::max(out.worst.miss, m.miss), out.worst.open = std::max(out.worst.open, m.open);
  });
  return out;
}

// The error goes with the root of what a box may add. The first guess is what GGX needs.
AlbedoProof prove_part(const EnclosedField& field, const Part& part, const AlbedoProofOptions& options,
                       const Host& host) {
  constexpr int passes = 4;
  const double asked = options.relative_error, allowed = times_allowed(float(std::cos(part.theta.lo)));
  const RealInterval table = field.albedo(part.theta.lo, part.theta.hi, part.known).range;
  double most = 0.03 * sqr(asked * allowed) * std::max(table.lo, 0.1 * table.hi);
  AlbedoProof best{infinity, 0};
  for (int pass = 0; pass < passes && best.boxes < options.boxes_per_slab; ++pass) {
    if (host.cancelled()) throw Cancelled();
    const Pass p = integrate(field, part, most, options.boxes_per_slab - best.boxes, host);
    best.relative_error = std::min(best.relative_error, p.worst.miss);
    best.boxes += p.boxes;
    if (best.relative_error <= asked) break;
    const double shrink = p.worst.open > 0 ? 0.8 * asked / p.worst.open : 0.5;
    most *= sqr(std::clamp(shrink, 0.1, 0.9));
  }
  return best;
}

}  // namespace

AlbedoProof prove_albedo(SamplerData& data, const AnyBrdf& f, const AlbedoProofOptions& options,
                         const Host& the_host) {
  if (!(options.relative_error > 0 && options.relative_error < 1))
    throw Error("the relative error is not in (0, 1)", "proof of the albedo", "take the default");
  std::string refusal = no_proof(f);
  if (refusal.empty() && !(data.frame.isotropic() && data.parameters.empty() && data.domain.half()))
    refusal = "no integral of forms beyond half squares of isotropic functions";
  if (!refusal.empty()) throw Error(refusal, data.material, "its albedo keeps the error that was measured");
  const Host host = completed(the_host);
  host.stage("proving the albedo");
  const PackedSampler packed = pack(data);
  const EnclosedField field(f, packed);
  if (field.axes() != axes)
    throw Error("no integral of forms where the formula sees an azimuth", data.material,
                "its albedo keeps the error that was measured");
  const std::vector<Part> parts = parts_of(field, packed);
  AlbedoProof proof;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    host.progress(float(k) / float(parts.size()));
    const AlbedoProof part = prove_part(field, parts[k], options, host);
    proof.relative_error = std::max(proof.relative_error, part.relative_error);
    proof.boxes += part.boxes;
  }
  if (proof.relative_error < 1) data.albedo.proved_error = std::nextafter(float(proof.relative_error), 1.f);
  host.progress(1);
  return proof;
}

}  // namespace reflectree
