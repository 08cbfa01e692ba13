// SPDX-License-Identifier: Apache-2.0
#include "leaf_proof.hpp"

#include <vector>

namespace reflectree::detail {

namespace {

// What floats may add to a bound between the proof and its use: the product majorant q albedo, the leaf's
// height and its mass are rounded.
constexpr double margin = 0x1p-19;

// Of theta_o, across the leaf, and of what else is known. Floats beside narrower boxes need not lie in them.
constexpr double smallest_width[most_axes] = {1e-10, 0x1p-23, 0x1p-23, 1e-7, 1e-7, 1e-7};

struct OpenBox {
  ProofBox box;
  EnclosedPoint point;
  // What halving the box along each axis would bring, as last tried; falls with the square of the side.
  std::array<double, most_axes> gain{};
  int age = 0;  // halvings since it was tried
};

double upper(const EnclosedPoint& p, double bound) {
  if (p.unit.range.hi <= 0) return 0;  // viewers whose albedo is 0 get no sample
  const double own = upper_of_difference(p.target, bound, p.unit);
  return p.mirrored ? std::max(own, upper_of_difference(*p.mirrored, bound, p.unit)) : own;
}

class Proof {
 public:
  Proof(const EnclosedField& field, const KnownRange& known, const PackedLeaf& leaf,
        const ProofLimits& limits)
      : field_(field),
        known_(known),
        leaf_(leaf),
        cell_(field.cell_of(leaf)),
        limits_(limits),
        axes_(field.axes()),
        whole_(field.whole(known)) {
    out_.bound = double(leaf.height);
  }

  LeafProof run() {
    open(whole_);
    look_around(boxes_.back());
    climb();
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
  // A leaf that is hard gets more room: twice the tolerance after a sixteenth of the boxes, four times after an
  // eighth, and so on.
  void ease() {
    double wanted = limits_.tolerance;
    for (std::uint64_t part = limits_.boxes / 16; part > 0 && out_.boxes > part; part *= 2) wanted *= 2;
    tolerance_ = std::min(wanted, limits_.loosest - 1);
  }
  double proved_bound() const { return out_.bound * (1 - margin); }
  bool holds(const EnclosedPoint& p) const { return upper(p, proved_bound()) <= 0; }

  EnclosedPoint enclose(const ProofBox& box) {
    ++out_.boxes;
    return field_.over(box, known_, leaf_);
  }
  void open(const ProofBox& box) { boxes_.push_back({box, enclose(box)}); }

  // Values at corners and between, so that something was seen however quick the proof is.
  void look_around(const OpenBox& b) {
    int places = 1;
    for (std::size_t k = 0; k < axes_; ++k) places *= 3;
    for (int i = 0; i < places; ++i) {
      ProofPoint point{};
      for (std::size_t k = 0, rest = std::size_t(i); k < axes_; ++k, rest /= 3)
        point[k] = b.box.lo[k] + 0.5 * double(rest % 3) * (b.box.hi[k] - b.box.lo[k]);
      see(b, point);
    }
  }
  PointValue look_at(const ProofPoint& point) {
    const PointValue v = field_.at(point, known_, leaf_);
    if (v.unit > 0 && double(v.target) > out_.seen * double(v.unit)) {
      out_.seen = double(v.target) / double(v.unit), best_ = point;
    }
    return v;
  }
  void see(const OpenBox& b, const ProofPoint& point) { check_value(b.point, look_at(point)); }

  // Values at the middle, and at the corner to which the difference rises.
  void look_into(const OpenBox& b) {
    const AffineForm::Slopes rise = slopes_of_difference(b.point.target, proved_bound(), b.point.unit);
    ProofPoint middle{}, corner{};
    for (std::size_t i = 0; i < axes_; ++i) {
      middle[i] = 0.5 * (b.box.lo[i] + b.box.hi[i]);
      corner[i] = rise[i] > 0 ? b.box.hi[i] : b.box.lo[i];
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

  // The logarithm of how far the ranges are from being proved.
  double excess(const EnclosedPoint& p) const {
    constexpr double most = 400;
    const double top = p.mirrored ? std::max(p.target.range.hi, p.mirrored->range.hi) : p.target.range.hi;
    const double ratio = top / (proved_bound() * p.unit.range.lo);
    if (top <= 0 || ratio <= 1 || holds(p)) return 0;
    return ratio < infinity ? std::min(std::log(ratio), most) : most;
  }
  // So wide that the difference tells nothing yet.
  bool is_far(const OpenBox& b) const { return excess(b.point) > 0.7; }
  // Sides as the maps see them: towards grazing everything goes by the ratio of cosines, and near the rim and
  // where the azimuth is a right angle there are layers as thin as the cosine of wo; the pole is a point.
  using Sides = std::array<double, most_axes>;
  Sides sides(const OpenBox& b) const {
    const double c0 = std::cos(b.box.lo[0]), c1 = std::max(std::cos(b.box.hi[0]), 1e-6);
    const auto place = [&](std::size_t axis, double share) {
      return axis == 1 ? double(cell_.x) + double(cell_.width) * share
                       : std::abs(double(cell_.y) + double(cell_.length) * share);
    };
    const auto layer = [c1](double near, double far) { return std::log((far + c1) / (near + c1)); };
    const double x0 = place(1, b.box.lo[1]), x1 = place(1, b.box.hi[1]);
    const double y0 = place(2, b.box.lo[2]), y1 = place(2, b.box.hi[2]);
    // Of directions about the normal the layer is at x = -1, where wi is about to cancel wo.
    const bool of_directions = field_.is_of_directions();
    const double near_x = of_directions ? 1 + x0 : x0 * x1 <= 0 ? 0 : std::min(std::abs(x0), std::abs(x1));
    const double far_x = of_directions ? 1 + x1 : std::max(std::abs(x0), std::abs(x1));
    const double inner = std::min(y0, y1), outer = std::max(y0, y1);
    Sides side{std::log(c0 / c1) + b.box.hi[0] - b.box.lo[0],
               std::max(1.5 * (x1 - x0), 0.5 * layer(near_x, far_x)),
               std::max(0.5 * layer(1 - outer, 1 - inner), std::log(outer / std::max(inner, outer / 8)))};
    for (std::size_t i = 3; i < axes_; ++i) side[i] = b.box.hi[i] - b.box.lo[i];
    return side;
  }
  std::size_t longest_axis(const OpenBox& b, const Sides& side) const {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < axes_; ++i) {
      if (may_halve(b, i) && (side[i] > side[axis] || !may_halve(b, axis))) axis = i;
    }
    return axis;
  }

  // Along the axis that brings the halves closest to being proved: tried at every third halving,
  // foretold in between.
  void divide(const OpenBox& b) {
    constexpr int trusted = 2;
    std::size_t axis = 0;
    for (std::size_t i = 1; i < axes_; ++i) {
      if (may_halve(b, i) && (b.gain[i] > b.gain[axis] || !may_halve(b, axis))) axis = i;
    }
    if (!may_halve(b, axis)) {
      smallest_.push_back(b);
      return;
    }
    std::array<OpenBox, 2> chosen;
    if (is_far(b)) {
      // Slices that are ever thinner may gain a little each time, and never what the other axes would.
      constexpr double thinnest = 0.125;
      const Sides side = sides(b);
      axis = longest_axis(b, side);
      chosen = halves(b, axis);
      const auto left = [this](const std::array<OpenBox, 2>& two) {
        return excess(two[0].point) + excess(two[1].point);
      };
      double least = left(chosen);
      for (std::size_t i = 0, longest = axis; i < axes_; ++i) {
        if (i == longest || !may_halve(b, i) || side[i] < thinnest * side[longest]) continue;
        const std::array<OpenBox, 2> tried = halves(b, i);
        if (left(tried) < 0.95 * least) least = left(tried), axis = i, chosen = tried;
      }
      for (OpenBox& half : chosen) half.age = 0;
    } else if (b.age > 0 && b.age <= trusted) {
      chosen = halves(b, axis);
      for (OpenBox& half : chosen) half.gain[axis] *= 0.25, ++half.age;
    } else {
      const double here = upper(b.point, proved_bound());
      std::array<double, most_axes> gain{};
      double most = -infinity;
      for (std::size_t i = 0; i < axes_; ++i) {
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

  // From the best place that was seen, by steps along the axes: what the ratio is held against.
  void climb() {
    const ProofPoint &lo = whole_.lo, &hi = whole_.hi;
    for (double step = 0.125; step > 0.002; step *= 0.5) {
      for (std::size_t k = 0; k < 4 * axes_; ++k) {
        const std::size_t axis = k / 2 % axes_;
        ProofPoint next = best_;
        next[axis] =
            std::clamp(next[axis] + (k % 2 ? step : -step) * (hi[axis] - lo[axis]), lo[axis], hi[axis]);
        look_at(next);
      }
    }
    out_.bound = std::max(out_.bound, out_.seen);
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
  KnownRange known_;
  const PackedLeaf& leaf_;
  LeafCell<float> cell_;
  ProofLimits limits_;
  std::size_t axes_;
  ProofBox whole_;
  double tolerance_ = 0;
  LeafProof out_;
  ProofPoint best_{};
  std::vector<OpenBox> boxes_, smallest_;
};

}  // namespace

LeafProof prove_leaf(const EnclosedField& field, const KnownRange& known, const PackedLeaf& leaf,
                     const ProofLimits& limits) {
  return Proof(field, known, leaf, limits).run();
}

}  // namespace reflectree::detail
