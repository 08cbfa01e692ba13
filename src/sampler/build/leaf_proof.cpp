// SPDX-License-Identifier: Apache-2.0
#include "leaf_proof.hpp"

#include <algorithm>
#include <vector>

namespace reflectree::detail {

namespace {

// What floats may add to a bound between the proof and its use: the product majorant q albedo, the leaf's
// height and its mass are rounded.
constexpr double margin = 0x1p-19;

// Of theta_o, across the leaf, of what else is known, and of the star's angle. Floats beside narrower boxes need not
// lie in them.
constexpr double smallest_width[most_axes] = {1e-10, 0x1p-23, 0x1p-23, 1e-7, 1e-7, 1e-7, 1e-3, 1};

struct OpenBox {
  ProofBox box;
  EnclosedPoint point;
  // What halving the box along each axis would bring, as last tried; falls with the square of the side.
  std::array<double, most_axes> gain{};
  int age = 0;        // halvings since it was tried
  double needed = 0;  // the least bound under which it holds, where the worst comes first
};
bool needs_less(const OpenBox& a, const OpenBox& b) { return a.needed < b.needed; }

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
    recent_.reserve(most_recent);
    for (std::size_t i = 0; i < axes_; ++i) divided_.push_back(i);
    if (field.divides_angle()) divided_.push_back(star_axis);
    out_.bound = std::max(double(leaf.height), 1e-9);  // needed() multiplies it
  }

  LeafProof run() {
    open(whole_);
    look_around(boxes_.back());
    climb();
    while (!boxes_.empty()) {
      if (out_.boxes >= limits_.boxes || out_.bound == infinity) return settle();
      ease();
      const OpenBox next = take();
      if (holds(next.point)) continue;
      look_into(next);
      if (!holds(next.point)) divide(next);
    }
    return settle();
  }

 private:
  // A leaf that is hard gets more room: twice the tolerance after a sixteenth of the boxes, four times after an
  // eighth, and so on, up to a tenth.
  void ease() {
    constexpr double most = 0.1;
    double wanted = limits_.tolerance;
    for (std::uint64_t part = limits_.boxes / 16; part > 0 && out_.boxes > part; part *= 2) wanted *= 2;
    tolerance_ = std::max(limits_.tolerance, std::min({wanted, most, limits_.loosest - 1}));
  }
  double proved_bound() const { return out_.bound * (1 - margin); }
  bool holds(const EnclosedPoint& p) const { return upper(p, proved_bound()) <= 0; }
  // The least bound under which a box holds, to 2 per mille, or the one that there is.
  double needed(const EnclosedPoint& p) const {
    constexpr double sharp = 1.002, most = 1e30;
    double below = out_.bound, bound = below;
    const auto too_low = [&p](double m) { return upper(p, m * (1 - margin)) > 0; };
    for (double step = sharp; too_low(bound); step *= step) {
      if (bound > most) return infinity;
      below = bound, bound *= step;
    }
    while (bound > sharp * below) {
      const double middle = std::sqrt(below * bound);
      (too_low(middle) ? below : bound) = middle;
    }
    return bound;
  }

  // Depth first is all that most leaves need. Of a hard one the box that needs the largest bound comes first: so
  // this bound is proved at any time, and falls.
  OpenBox take() {
    constexpr std::uint64_t easy = 2000;
    if (!worst_first_ && out_.boxes >= easy) {
      worst_first_ = true;
      for (OpenBox& b : boxes_) b.needed = needed(b.point);
      std::make_heap(boxes_.begin(), boxes_.end(), needs_less);
    }
    if (worst_first_) std::pop_heap(boxes_.begin(), boxes_.end(), needs_less);
    const OpenBox next = boxes_.back();
    boxes_.pop_back();
    return next;
  }
  void leave(const OpenBox& b) {
    boxes_.push_back(b);
    if (!worst_first_) return;
    boxes_.back().needed = needed(b.point);
    std::push_heap(boxes_.begin(), boxes_.end(), needs_less);
  }

  void enclose(OpenBox& b) {
    ++out_.boxes;
    b.point = field_.over(viewers_of(b.box), b.box, leaf_);
    b.box.lo[star_axis] = b.point.angle.lo, b.box.hi[star_axis] = b.point.angle.hi;
  }
  // Boxes that lie beside each other in the leaf have the same viewers.
  const ViewerForms& viewers_of(const ProofBox& box) {
    const auto is_same = [this, &box](const Viewers& v) {
      for (std::size_t i = 0; i < axes_; ++i) {
        if (i != 1 && i != 2 && (v.of.lo[i] != box.lo[i] || v.of.hi[i] != box.hi[i])) return false;
      }
      return true;
    };
    const auto kept = std::find_if(recent_.begin(), recent_.end(), is_same);
    if (kept != recent_.end()) return kept->forms;
    if (recent_.size() < most_recent) recent_.emplace_back();
    Viewers& next = recent_[oldest_];
    oldest_ = (oldest_ + 1) % most_recent;
    next = {box, field_.viewers_of(box, known_)};
    return next.forms;
  }
  void open(const ProofBox& box) {
    boxes_.push_back({box, {}});
    enclose(boxes_.back());
  }

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
  // The program's angle may round to another.
  void see(const OpenBox& b, const ProofPoint& point) {
    constexpr double off = 0.1;
    const PointValue value = look_at(point);
    const double angle = field_.star_angle(point, cell_);
    const bool inside = b.box.lo[star_axis] < angle - off && b.box.hi[star_axis] > angle + off;
    if (!field_.divides_angle() || inside) check_value(b.point, value);
  }

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

  static std::array<OpenBox, 2> cut(const OpenBox& b, std::size_t axis) {
    std::array<OpenBox, 2> out{b, b};
    out[0].box.hi[axis] = out[1].box.lo[axis] = 0.5 * (b.box.lo[axis] + b.box.hi[axis]);
    return out;
  }
  // What the whole box says holds for its halves, of which forms may say less.
  static void inherit(EnclosedPoint& half, const EnclosedPoint& whole) {
    const auto narrow = [](AffineForm& x, const AffineForm& by) {
      const RealInterval both = intersection(x.range, by.range);
      if (both.lo <= both.hi) x.range = both;
    };
    if (!(half.unit.range.hi > 0)) return;  // there is nothing in it
    narrow(half.target, whole.target);
    if (half.mirrored && whole.mirrored) narrow(*half.mirrored, *whole.mirrored);
  }
  static bool may_halve(const OpenBox& b, std::size_t axis) {
    return b.box.hi[axis] - b.box.lo[axis] >= smallest_width[axis];
  }

  // No less than the logarithm of a value.
  static double log_top(const AffineForm& x) {
    double by_log = x.log_middle + x.log_error;
    for (const double s : x.log_slope) by_log += std::abs(s);
    const double by_range = std::log(std::max(x.range.hi, 0.));
    return x.log_error < infinity ? std::min(by_log, by_range) : by_range;
  }
  // The logarithm of how far the ranges are from being proved.
  double excess(const EnclosedPoint& p) const {
    constexpr double most = 400;
    const double top = p.mirrored ? std::max(log_top(p.target), log_top(*p.mirrored)) : log_top(p.target);
    const double excess = top - std::log(proved_bound() * p.unit.range.lo);
    if (!(excess > 0) || holds(p)) return 0;
    return std::min(excess, most);
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
    // The angle does not matter until it is narrower than what the form of the other unknowns tells of it. In hard
    // leaves it is tried where that says so little that the angle may be what is missing.
    constexpr double may_matter = 2, may_be_missing = 0.15;
    const double angle = b.box.hi[star_axis] - b.box.lo[star_axis];
    const AffineForm& t = b.point.target;
    if (angle > may_matter || t.slope[star_axis] != 0 || t.log_slope[star_axis] != 0) {
      side[star_axis] = angle;
    } else if (worst_first_ && !(t.log_error < may_be_missing * angle)) {
      side[star_axis] = 0.25 * angle;
    }
    return side;
  }
  std::size_t longest_axis(const OpenBox& b, const Sides& side) const {
    std::size_t axis = 0;
    for (const std::size_t i : divided_) {
      if (may_halve(b, i) && (side[i] > side[axis] || !may_halve(b, axis))) axis = i;
    }
    return axis;
  }

  // Both halves along an axis, and what is left to prove of them: the worse half comes first, and the other is
  // spared where that is no less than `enough` already.
  struct Tried {
    std::array<OpenBox, 2> halves;
    double left = 0;
  };
  template <class Left>
  Tried try_halves(const OpenBox& b, std::size_t axis, bool upper_first, const Left& left_of, double enough) {
    Tried out{cut(b, axis)};
    for (const std::size_t i : {std::size_t(upper_first), std::size_t(!upper_first)}) {
      enclose(out.halves[i]);
      inherit(out.halves[i].point, b.point);
      out.left += left_of(out.halves[i].point);
      if (i == std::size_t(upper_first) && out.left >= enough && enough < infinity) {
        out.left *= 2;
        break;
      }
    }
    return out;
  }

  // Along the axis that brings the halves closest to being proved: tried at every third halving,
  // foretold in between.
  void divide(const OpenBox& b) {
    constexpr int trusted = 2;
    std::size_t axis = 0;
    for (const std::size_t i : divided_) {
      if (may_halve(b, i) && (b.gain[i] > b.gain[axis] || !may_halve(b, axis))) axis = i;
    }
    if (!may_halve(b, axis)) {
      out_.bound = needed(b.point);
      return;
    }
    const AffineForm::Slopes rise = slopes_of_difference(b.point.target, proved_bound(), b.point.unit);
    Tried chosen;
    if (is_far(b)) {
      // Slices that are ever thinner may gain a little each time, and never what the other axes would.
      constexpr double thinnest = 0.125;
      const Sides side = sides(b);
      axis = longest_axis(b, side);
      const auto left = [this](const EnclosedPoint& p) { return excess(p); };
      chosen = try_halves(b, axis, rise[axis] > 0, left, infinity);
      const std::size_t longest = axis;
      for (const std::size_t i : divided_) {
        if (i == longest || !may_halve(b, i) || side[i] < thinnest * side[longest]) continue;
        const double enough = 0.95 * chosen.left;
        const Tried tried = try_halves(b, i, rise[i] > 0, left, enough);
        if (tried.left < enough) axis = i, chosen = tried;
      }
      for (OpenBox& half : chosen.halves) half.age = 0;
    } else {
      const auto left = [this](const EnclosedPoint& p) { return std::max(upper(p, proved_bound()), 0.); };
      const double here = upper(b.point, proved_bound());
      // What an axis must gain, of what is left to prove. Where none does, the longest side is halved: slices that
      // are ever thinner along one axis may never gain what the others would.
      constexpr double worth = 0.02;
      if (b.age > 0 && b.age <= trusted && (here == infinity || b.gain[axis] > worth * here)) {
        chosen = try_halves(b, axis, rise[axis] > 0, left, infinity);
        for (OpenBox& half : chosen.halves) half.gain[axis] *= 0.25, ++half.age;
      } else {
        constexpr double thinnest = 1. / 32;
        const Sides side = sides(b);
        const std::size_t longest = longest_axis(b, side);
        std::array<double, most_axes> gain{};
        chosen.left = infinity;
        bool any = false;
        std::vector<std::size_t> order = divided_;  // what is foretold comes first
        std::stable_partition(order.begin(), order.end(), [axis](std::size_t i) { return i == axis; });
        for (const std::size_t i : order) {
          if (!may_halve(b, i) || side[i] < thinnest * side[longest]) continue;
          const Tried tried = try_halves(b, i, rise[i] > 0, left, any ? chosen.left : infinity);
          // Infinite less infinite: nothing is known of either.
          gain[i] = tried.left < infinity ? (here < infinity ? here - 0.5 * tried.left : largest_double) : 0;
          if (!any || tried.left < chosen.left) axis = i, chosen = tried, any = true;
        }
        if (here < infinity && !(gain[axis] > worth * here) && axis != longest && may_halve(b, longest)) {
          axis = longest;
          chosen = try_halves(b, axis, rise[axis] > 0, left, infinity);
        }
        for (OpenBox& half : chosen.halves) half.gain = gain, half.gain[axis] *= 0.25, half.age = 1;
      }
    }
    for (const OpenBox& half : chosen.halves) leave(half);
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

  // With the bound that the boxes need which are left.
  LeafProof settle() {
    double bound = out_.bound;
    for (const OpenBox& b : boxes_) bound = std::max(bound, needed(b.point));
    if (!(bound <= std::max(double(leaf_.height), out_.seen * limits_.loosest))) return out_;
    out_.bound = bound;
    out_.proved = true;
    return out_;
  }

  const EnclosedField& field_;
  KnownRange known_;
  const PackedLeaf& leaf_;
  LeafCell<float> cell_;
  ProofLimits limits_;
  std::size_t axes_;
  std::vector<std::size_t> divided_;
  ProofBox whole_;
  double tolerance_ = 0;
  LeafProof out_;
  ProofPoint best_{};
  std::vector<OpenBox> boxes_;  // a heap, where the worst comes first
  bool worst_first_ = false;
  static constexpr std::size_t most_recent = 16;
  struct Viewers {
    ProofBox of;
    ViewerForms forms;
  };
  std::vector<Viewers> recent_;
  std::size_t oldest_ = 0;
};

}  // namespace

LeafProof prove_leaf(const EnclosedField& field, const KnownRange& known, const PackedLeaf& leaf,
                     const ProofLimits& limits) {
  return Proof(field, known, leaf, limits).run();
}

}  // namespace reflectree::detail
