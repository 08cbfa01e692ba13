// SPDX-License-Identifier: Apache-2.0
#include "leaf_proof.hpp"

#include <vector>

namespace reflectree::detail {

namespace {

// What floats may add to a bound between the proof and its use: the product majorant q albedo, the leaf's
// height and its mass are rounded.
constexpr double margin = 0x1p-19;

// Of theta_o and across the leaf. Floats beside narrower boxes need not lie in them.
constexpr double smallest_width[ProofBox::axes] = {1e-10, 0x1p-23, 0x1p-23};

struct OpenBox {
  ProofBox box;
  EnclosedPoint point;
  // What halving the box along each axis would bring, as last tried; falls with the square of the side.
  std::array<double, ProofBox::axes> gain{};
  int age = 0;  // halvings since it was tried
};

double upper(const EnclosedPoint& p, double bound) {
  if (p.unit.range.hi <= 0) return 0;  // viewers whose albedo is 0 get no sample
  const double own = upper_of_difference(p.target, bound, p.unit);
  return p.mirrored ? std::max(own, upper_of_difference(*p.mirrored, bound, p.unit)) : own;
}

class Proof {
 public:
  Proof(const EnclosedField& field, CosineRange cosines, const PackedLeaf& leaf, const ProofLimits& limits)
      : field_(field), cosines_(cosines), leaf_(leaf), limits_(limits) {
    out_.bound = double(leaf.height);
  }

  LeafProof run() {
    const Elevations theta = field_.elevations(cosines_);
    open({{theta.lo, 0, 0}, {theta.hi, 1, 1}});
    look_around(boxes_.back());
    while (!boxes_.empty()) {
      if (out_.boxes >= limits_.boxes) return settle();
      ease();
      const OpenBox worst = boxes_.back();
      boxes_.pop_back();
      if (holds(worst.point)) continue;
      look_into(worst);
      if (!holds(worst.point)) divide(worst);
    }
    return settle();
  }

 private:
  // A leaf that is hard gets more room: twice the tolerance after a quarter of the boxes, four times after half.
  void ease() {
    double wanted = limits_.tolerance;
    for (std::uint64_t part = limits_.boxes / 4; part > 0 && out_.boxes > part; part *= 2) wanted *= 2;
    tolerance_ = std::min(wanted, limits_.loosest - 1);
  }
  double proved_bound() const { return out_.bound * (1 - margin); }
  bool holds(const EnclosedPoint& p) const { return upper(p, proved_bound()) <= 0; }

  EnclosedPoint enclose(const ProofBox& box) {
    ++out_.boxes;
    return field_.over(box, cosines_, leaf_);
  }
  void open(const ProofBox& box) { boxes_.push_back({box, enclose(box)}); }

  // Values at corners and between, so that something was seen however quick the proof is.
  void look_around(const OpenBox& b) {
    for (int i = 0; i < 27; ++i) {
      const std::array<int, ProofBox::axes> at{i % 3, i / 3 % 3, i / 9};
      ProofPoint point;
      for (std::size_t k = 0; k < ProofBox::axes; ++k)
        point[k] = b.box.lo[k] + 0.5 * at[k] * (b.box.hi[k] - b.box.lo[k]);
      see(b, point);
    }
    out_.bound = std::max(out_.bound, out_.seen);
  }
  void see(const OpenBox& b, const ProofPoint& point) {
    const PointValue v = field_.at(point, cosines_, leaf_);
    if (!(v.unit > 0)) return;
    check_value(b.point, v);
    out_.seen = std::max(out_.seen, double(v.target) / double(v.unit));
  }

  // Values at the middle, and at the corner to which the difference rises.
  void look_into(const OpenBox& b) {
    const AffineForm::Slopes rise = slopes_of_difference(b.point.target, proved_bound(), b.point.unit);
    const std::array<double, 3> along{rise[0], rise[2], rise[3]};
    ProofPoint middle, corner;
    for (std::size_t i = 0; i < ProofBox::axes; ++i) {
      middle[i] = 0.5 * (b.box.lo[i] + b.box.hi[i]);
      corner[i] = along[i] > 0 ? b.box.hi[i] : b.box.lo[i];
    }
    for (const ProofPoint& point : {middle, corner}) see(b, point);
    out_.bound = std::max(out_.bound, out_.seen * (1 + tolerance_));
  }

  std::array<OpenBox, 2> halves(const OpenBox& b, std::size_t axis) {
    const double cut = 0.5 * (b.box.lo[axis] + b.box.hi[axis]);
    std::array<OpenBox, 2> out{b, b};
    out[0].box.hi[axis] = out[1].box.lo[axis] = cut;
    for (OpenBox& half : out) half.point = enclose(half.box);
    return out;
  }
  static bool may_halve(const OpenBox& b, std::size_t axis) {
    return b.box.hi[axis] - b.box.lo[axis] >= smallest_width[axis];
  }

  // Along the axis that brings the halves closest to being proved: tried at every third halving, foretold in
  // between.
  void divide(const OpenBox& b) {
    constexpr int trusted = 2;
    std::size_t axis = 0;
    for (std::size_t i = 1; i < ProofBox::axes; ++i) {
      if (may_halve(b, i) && (b.gain[i] > b.gain[axis] || !may_halve(b, axis))) axis = i;
    }
    if (!may_halve(b, axis)) {
      smallest_.push_back(b);
      return;
    }
    std::array<OpenBox, 2> chosen;
    // Towards grazing everything goes by the ratio of cosines.
    const bool steep = std::cos(b.box.lo[0]) > 1.5 * std::cos(b.box.hi[0]);
    if (steep && may_halve(b, 0)) {
      chosen = halves(b, 0);
      for (OpenBox& half : chosen) half.age = 0;
    } else if (b.age > 0 && b.age <= trusted) {
      chosen = halves(b, axis);
      for (OpenBox& half : chosen) half.gain[axis] *= 0.25, ++half.age;
    } else {
      const double here = upper(b.point, proved_bound());
      std::array<double, ProofBox::axes> gain{};
      double most = -infinity;
      for (std::size_t i = 0; i < ProofBox::axes; ++i) {
        if (!may_halve(b, i)) continue;
        const std::array<OpenBox, 2> tried = halves(b, i);
        const double left = std::max(upper(tried[0].point, proved_bound()), 0.) +
                            std::max(upper(tried[1].point, proved_bound()), 0.);
        // Infinite less infinite: nothing is known of either.
        gain[i] = left < infinity ? (here < infinity ? here - 0.5 * left : largest_double) : 0;
        if (gain[i] > most) most = gain[i], axis = i, chosen = tried;
      }
      for (OpenBox& half : chosen) half.gain = gain, half.gain[axis] *= 0.25, half.age = 1;
    }
    for (const OpenBox& half : chosen) boxes_.push_back(half);
  }

  // The bound that the boxes need which are left: too small to be divided, or too many.
  LeafProof settle() {
    double needed = out_.bound;
    boxes_.insert(boxes_.end(), smallest_.begin(), smallest_.end());
    for (const OpenBox& b : boxes_) {
      while (upper(b.point, needed * (1 - margin)) > 0) {
        needed *= 1.002;
        if (needed > std::max(out_.bound, out_.seen * limits_.loosest)) return out_;
      }
    }
    out_.bound = needed;
    out_.proved = true;
    return out_;
  }

  const EnclosedField& field_;
  CosineRange cosines_;
  const PackedLeaf& leaf_;
  ProofLimits limits_;
  double tolerance_ = 0;
  LeafProof out_;
  std::vector<OpenBox> boxes_, smallest_;
};

}  // namespace

LeafProof prove_leaf(const EnclosedField& field, CosineRange cosines, const PackedLeaf& leaf,
                     const ProofLimits& limits) {
  return Proof(field, cosines, leaf, limits).run();
}

}  // namespace reflectree::detail
