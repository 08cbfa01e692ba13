// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/cubature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reflectree/math/genz_malik.hpp"
#include "reflectree/math/sum.hpp"

namespace reflectree {
namespace {

struct Region {
  CubatureBox box;
  double value = 0, error = 0;
  bool split_x = true;
};

bool smaller_error(const Region& a, const Region& b) { return a.error < b.error; }

void append_points(const CubatureBox& r, std::vector<Vec2<double>>& points) {
  const double cx = 0.5 * (r.x0 + r.x1), cy = 0.5 * (r.y0 + r.y1);
  const double hx = 0.5 * (r.x1 - r.x0), hy = 0.5 * (r.y1 - r.y0);
  for (const auto& n : genz_malik_nodes<double>()) points.push_back({cx + hx * n.x, cy + hy * n.y});
}

void apply_rule(const double* f, const CubatureBox& domain, Region& region) {
  const GenzMalikSums sums = genz_malik([f](std::size_t i) { return f[i]; });
  const CubatureBox& r = region.box;
  const double width = r.x1 - r.x0, height = r.y1 - r.y0;
  region.value = width * height * sums.degree7;
  region.error = width * height * std::abs(sums.degree7 - sums.degree5);
  // Of nearly equal differences the longer side is halved.
  const double dx = sums.difference_x, dy = sums.difference_y;
  const bool longer_x = width * (domain.y1 - domain.y0) >= height * (domain.x1 - domain.x0);
  region.split_x = std::abs(dx - dy) <= 0.1 * std::max(dx, dy) ? longer_x : dx > dy;
}

class Cubature {
 public:
  Cubature(const Integrand& f, const CubatureBox& domain, const CubatureOptions& options)
      : f_(f), domain_(domain), options_(options) {}

  CubatureResult run() {
    start();
    while (!finished()) refine();
    CubatureResult result{value_.value(), error_bound(), evaluations_, false};
    result.converged = result.error <= tolerance();
    return result;
  }
  const std::vector<Region>& regions() const { return heap_; }
  const std::vector<Region>& exhausted() const { return exhausted_; }

 private:
  void evaluate(std::span<Region> regions) {
    points_.clear();
    for (const Region& r : regions) append_points(r.box, points_);
    values_.resize(points_.size());
    f_(points_, values_);
    evaluations_ += points_.size();
    for (std::size_t i = 0; i < regions.size(); ++i) {
      apply_rule(values_.data() + i * genz_malik_points, domain_, regions[i]);
      finite_ = finite_ && std::isfinite(regions[i].value) && std::isfinite(regions[i].error);
    }
  }

  void start() {
    const int nx = std::max(options_.cells_x, 1), ny = std::max(options_.cells_y, 1);
    const auto at = [](double lo, double hi, int i, int n) { return i == n ? hi : lo + (hi - lo) * i / n; };
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        heap_.push_back({{at(domain_.x0, domain_.x1, i, nx), at(domain_.x0, domain_.x1, i + 1, nx),
                          at(domain_.y0, domain_.y1, j, ny), at(domain_.y0, domain_.y1, j + 1, ny)}});
      }
    }
    for (std::size_t first = 0; first < heap_.size(); first += max_batch) {
      evaluate(std::span(heap_).subspan(first, std::min(max_batch, heap_.size() - first)));
    }
    for (const Region& r : heap_) value_ += r.value, error_ += r.error;
    std::make_heap(heap_.begin(), heap_.end(), smaller_error);
  }

  // Halves the worst regions, so many at once as do not waste work: an eighth of all, and only until
  // the rest is good enough.
  void refine() {
    parents_.clear();
    children_.clear();
    const std::size_t most = std::min({max_batch / 2, std::max<std::size_t>(8, heap_.size() / 8),
                                       (options_.max_evaluations - evaluations_) / (2 * genz_malik_points)});
    double rest = error_.value();
    while (parents_.size() < most && !heap_.empty() && (parents_.empty() || rest > tolerance())) {
      std::pop_heap(heap_.begin(), heap_.end(), smaller_error);
      const Region parent = heap_.back();
      heap_.pop_back();
      rest -= parent.error;
      if (!halve(parent)) exhausted_.push_back(parent);
    }
    if (parents_.empty()) return;
    evaluate(children_);
    for (std::size_t i = 0; i < parents_.size(); ++i) {
      replace(parents_[i], children_[2 * i], children_[2 * i + 1]);
    }
  }

  // False where the halves would be too narrow for their nodes to differ in double precision.
  bool halve(const Region& parent) {
    constexpr double narrowest = 0x1p-44;
    Region lower{parent.box}, upper{parent.box};
    const CubatureBox& r = parent.box;
    if (parent.split_x) {
      if (r.x1 - r.x0 < narrowest * (domain_.x1 - domain_.x0)) return false;
      lower.box.x1 = upper.box.x0 = 0.5 * (r.x0 + r.x1);
    } else {
      if (r.y1 - r.y0 < narrowest * (domain_.y1 - domain_.y0)) return false;
      lower.box.y1 = upper.box.y0 = 0.5 * (r.y0 + r.y1);
    }
    parents_.push_back(parent);
    children_.push_back(lower);
    children_.push_back(upper);
    return true;
  }

  // A feature can hide from the nodes of one region, seldom from its history. So a half's error is at
  // least a quarter of the change that halving made, and a 128th of the parent's (what halving leaves of
  // a smooth function's); and where the change shows that the parent's estimate was too small, its
  // halves' are distrusted by the same factor. Costs a tenth more evaluations where f is smooth.
  void replace(const Region& parent, Region lower, Region upper) {
    const double change = std::abs(lower.value + upper.value - parent.value);
    for (Region* child : {&lower, &upper}) {
      const double floor = std::max(0.25 * change, parent.error / 128);
      const double distrusted = change > parent.error && parent.error > 0
                                    ? std::min(change, child->error * (change / parent.error))
                                    : 0;
      child->error = std::max({child->error, floor, distrusted});
    }
    value_ -= parent.value;
    error_ -= parent.error;
    for (const Region& child : {lower, upper}) {
      value_ += child.value;
      error_ += child.error;
      heap_.push_back(child);
      std::push_heap(heap_.begin(), heap_.end(), smaller_error);
    }
  }

  // The rules' differences plus the rounding of their sums, which they cannot see.
  double error_bound() const {
    if (!finite_) return std::numeric_limits<double>::infinity();
    return std::max(error_.value(), 0.) +
           16 * std::numeric_limits<double>::epsilon() * std::abs(value_.value());
  }
  double tolerance() const {
    return std::max(options_.absolute_tolerance, options_.relative_tolerance * std::abs(value_.value()));
  }
  bool finished() const {
    return !finite_ || heap_.empty() || error_bound() <= tolerance() ||
           evaluations_ + 2 * genz_malik_points > options_.max_evaluations;
  }

  static constexpr std::size_t max_batch = 2048;  // regions in one call of the integrand

  const Integrand& f_;
  CubatureBox domain_;
  CubatureOptions options_;
  std::vector<Region> heap_, exhausted_, parents_, children_;
  std::vector<Vec2<double>> points_;
  std::vector<double> values_;
  CompensatedSum value_, error_;
  std::size_t evaluations_ = 0;
  bool finite_ = true;
};

}  // namespace

CubatureResult cubature(const Integrand& f, const CubatureBox& domain, const CubatureOptions& options) {
  return Cubature(f, domain, options).run();
}

CubatureResult cubature(const Integrand& f, const CubatureBox& domain, const CubatureOptions& options,
                        std::vector<CubatureRegion>& regions) {
  Cubature work(f, domain, options);
  const CubatureResult result = work.run();
  regions.clear();
  for (const auto* list : {&work.regions(), &work.exhausted()}) {
    for (const Region& r : *list) regions.push_back({r.box, r.value, r.error});
  }
  return result;
}

}  // namespace reflectree
