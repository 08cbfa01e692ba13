// SPDX-License-Identifier: Apache-2.0
#include "enclosed_albedo.hpp"

#include <cmath>

namespace reflectree::detail {

namespace {

// What floats lose in a sum over rows: the weights err by less than 8 u, products and sums by less than 3 u more
// along each axis, and the weights of an axis sum up to 1.25 at most, signs left aside.
constexpr double lost_per_axis = 32 * 0x1p-24;

// The lines between the nodes of a row, as they are looked up, lie between two lines of one slope; the nodes say
// how far apart. size: of the largest value.
struct RowForm {
  AffineForm form;
  double size = 0;
};
template <class PieceAt>
RowForm row_over(const PackedAlbedo& table, const AffineForm& cosine, const PieceAt& piece_at) {
  const std::vector<float>& x = table.lookup.borders();
  const float lo = max(float(cosine.range.lo) * (1 - 0x1p-22f), min_cos_theta_o);
  const float hi = min(float(cosine.range.hi) * (1 + 0x1p-22f), 1.f);
  const std::size_t first = table.lookup(lo), last = table.lookup(hi);
  const auto value = [&](std::size_t i, double c) {
    const AlbedoPiece& piece = piece_at(i);
    return double(piece.base) + double(piece.slope) * c;
  };
  const double a = double(lo), b = double(hi);
  const double alpha = b > a ? (value(last, b) - value(first, a)) / (b - a) : double(piece_at(first).slope);
  RealInterval offset{infinity, -infinity}, range{infinity, -infinity};
  double size = 0;
  for (std::size_t i = first; i <= last; ++i) {
    for (const double c : {i == first ? a : double(x[i]), i == last ? b : double(x[i + 1])}) {
      const double v = value(i, c), product = std::abs(double(piece_at(i).slope) * c);
      size = std::max(size, product + std::abs(v));
      offset = hull(offset, RealInterval(v - alpha * c, v - alpha * c)),
      range = hull(range, RealInterval(v, v));
    }
  }
  // fl(base + fl(slope c)), and the doubles here.
  const double rounding = size * 0x1.01p-24;
  const auto wider = [rounding](RealInterval r) { return RealInterval(r.lo - rounding, r.hi + rounding); };
  return {linear_enclosure(cosine, alpha, wider(offset), wider(range)), wider(range).magnitude()};
}

// Value and slope of the weight of row i of four (cubic_weights).
struct Weight {
  double value, slope;
};
Weight weight_of(int i, double t) {
  switch (i) {
    case 0:
      return {-t * (t - 1) * (t - 2) / 6, -(3 * t * t - 6 * t + 2) / 6};
    case 1:
      return {(t + 1) * (t - 1) * (t - 2) / 2, (3 * t * t - 4 * t - 1) / 2};
    case 2:
      return {-(t + 1) * t * (t - 2) / 2, -(3 * t * t - 2 * t - 2) / 2};
    case 3:
      return {(t + 1) * t * (t - 1) / 6, (3 * t * t - 1) / 6};
    default:
      return {0, 0};
  }
}

// The weights of the rows from `first` on in the cubics between them, at places x: of each a chain of cubics, which
// lie between two lines where their Bezier points do.
struct Level {
  std::size_t first = 0, stride = 1;
  std::vector<AffineForm> weights;
};
Level level_over(const AffineForm& x, std::size_t last, std::size_t stride) {
  const double lo = std::max(x.range.lo, 0.), hi = std::max(x.range.hi, lo);
  const auto interval = [last](double at) { return std::min(std::size_t(at), last); };
  const std::size_t k0 = interval(lo), k1 = interval(hi);
  Level level{k0, stride, {}};
  for (std::size_t j = k0; j <= k1 + 3; ++j) {
    const auto at = [j](std::size_t k, double place) {
      return weight_of(int(j) - int(k), place - double(k));
    };
    const double alpha = hi > lo ? (at(k1, hi).value - at(k0, lo).value) / (hi - lo) : 0;
    RealInterval offset{infinity, -infinity}, range{infinity, -infinity};
    for (std::size_t k = k0; k <= k1; ++k) {
      const double from = k == k0 ? lo : double(k), to = k == k1 ? hi : double(k + 1),
                   third = (to - from) / 3;
      const Weight a = at(k, from), b = at(k, to);
      const double points[4][2] = {{from, a.value},
                                   {from + third, a.value + third * a.slope},
                                   {to - third, b.value - third * b.slope},
                                   {to, b.value}};
      for (const auto& p : points) {
        const double off = p[1] - alpha * p[0];
        offset = hull(offset, {off, off}), range = hull(range, {p[1], p[1]});
      }
    }
    const double own = 1e-12 * (1 + std::abs(alpha) * hi);
    const auto wider = [own](RealInterval r) { return RealInterval(r.lo - own, r.hi + own); };
    level.weights.push_back(linear_enclosure(x, alpha, wider(offset), wider(range)));
  }
  return level;
}

class Sum {
 public:
  Sum(const PackedAlbedo& table, const AffineForm& cosine, std::vector<Level> levels)
      : table_(table), cosine_(cosine), levels_(std::move(levels)) {}
  AffineForm operator()() {
    AffineForm sum = over(levels_.size(), 0);
    const double axes = double(levels_.size());
    const double lost = size_ * lost_per_axis * axes * std::pow(1.25, axes);
    return max(sum + AffineForm::anything_in({-lost, lost}), AffineForm(0));
  }

 private:
  // Weights sum up to 1: what is summed are differences from a row in the middle.
  AffineForm over(std::size_t depth, std::size_t index) {
    if (depth == 0) return row(index);
    const Level& level = levels_[depth - 1];
    const std::size_t middle = level.weights.size() / 2;
    const auto below = [&](std::size_t j) {
      return over(depth - 1, index + (level.first + j) * level.stride);
    };
    const AffineForm base = below(middle);
    AffineForm sum = base;
    for (std::size_t j = 0; j < level.weights.size(); ++j) {
      if (j != middle) sum = sum + level.weights[j] * (below(j) - base);
    }
    return sum;
  }
  AffineForm row(std::size_t index) {
    const RowForm r = row_over(table_, cosine_, [&](std::size_t column) -> const AlbedoPiece& {
      return table_.pieces[column * table_.row + index];
    });
    size_ = std::max(size_, r.size);
    return r.form;
  }

  const PackedAlbedo& table_;
  const AffineForm& cosine_;
  std::vector<Level> levels_;
  double size_ = 0;
};

}  // namespace

AffineForm albedo_over(const PackedAlbedo& table, const AffineForm& cosine) {
  return row_over(table, cosine, [&](std::size_t i) -> const AlbedoPiece& { return table.pieces[i]; }).form;
}

AffineForm albedo_over(const PackedAlbedo& table, const AffineForm& cosine, const AffineForm& phi_o,
                       const std::array<AffineForm, max_parameters>& at) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < table.parameters.size(); ++i) {
    const PackedAlbedo::Axis& axis = table.parameters[i];
    const AffineForm x = (at[i] - AffineForm(axis.lo)) * AffineForm(axis.rows_per_unit);
    const double most = double(axis.rows - 1);
    levels.push_back(level_over(max(min(x, AffineForm(most)), AffineForm(0)), axis.rows - 2, axis.stride));
  }
  if (table.segments.empty()) return Sum(table, cosine, std::move(levels))();
  // Beyond the end of a segment the albedo may leap.
  AffineForm out;
  bool any = false;
  for (std::size_t s = 0; s < table.segments.size(); ++s) {
    const PackedAlbedo::Segment& segment = table.segments[s];
    const bool is_last = s + 1 == table.segments.size();
    AffineForm inside = phi_o;
    if (s > 0) inside.range.lo = std::max(inside.range.lo, double(segment.phi_o));
    if (!is_last) inside.range.hi = std::min(inside.range.hi, double(table.segments[s + 1].phi_o));
    if (inside.range.lo > inside.range.hi) continue;
    const AffineForm x = (inside - AffineForm(segment.phi_o)) * AffineForm(segment.rows_per_radian);
    std::vector<Level> all{level_over(max(x, AffineForm(0)), segment.last, 1)};
    all.front().first += segment.first;
    all.insert(all.end(), levels.begin(), levels.end());
    const AffineForm here = Sum(table, cosine, std::move(all))();
    out = any ? either(out, here) : here;
    any = true;
  }
  return out;
}

}  // namespace reflectree::detail
