// SPDX-License-Identifier: Apache-2.0
#include "integrals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflectree/math/genz_malik.hpp"
#include "tree_marks.hpp"

namespace reflectree::detail {

namespace {

struct Region {
  double x, y, hx, hy;  // centre and half widths in square coordinates
  double value = 0, error = 0;
  bool split_x = true;
};

void apply_rule(Region& r, const FieldValue* v, double area) {
  const GenzMalikSums sums = genz_malik([v](std::size_t i) { return v[i].mean; });
  const double share = 4 * r.hx * r.hy / area;
  r.value = share * sums.degree7;
  r.error = share * std::abs(sums.degree7 - sums.degree5);
  r.split_x =
      sums.difference_x > sums.difference_y || (sums.difference_x == sums.difference_y && r.hx >= r.hy);
}

// One integral, advanced in rounds: the regions that carry most of the error are halved.
struct Integral {
  Viewer viewer;
  std::vector<Region> regions;
  std::size_t fresh = 0;  // regions from here on await their values
  double value = 0, error = 0;
  bool done = false;
};

void start(Integral& integral, const Field& field, const IntegralOptions& options) {
  const Domain& domain = field.domain;
  const int nx = options.cells_x, ny = domain.half() ? options.cells_y : 2 * options.cells_y;
  const double y0 = double(root_cell(domain.symmetry).y0), hx = 1. / nx, hy = (1 - y0) / (2 * ny);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      integral.regions.push_back({-1 + (2 * i + 1) * hx, y0 + (2 * j + 1) * hy, hx, hy});
    }
  }
  // Close in on the landmarks and on the pole, so that no needle there falls between the points.
  const auto close_in = [&](Vec2<float> p, double narrow_x, double narrow_y) {
    for (std::size_t i = 0; i < integral.regions.size(); ++i) {
      Region& r = integral.regions[i];
      const bool inside = std::abs(double(p.x) - r.x) <= r.hx && std::abs(double(p.y) - r.y) <= r.hy;
      if (!inside || (r.hx <= narrow_x && r.hy <= narrow_y)) continue;
      r.split_x = r.hx / narrow_x >= r.hy / narrow_y;
      (r.split_x ? r.hx : r.hy) /= 2;
      Region upper = r;
      (r.split_x ? r.x : r.y) -= r.split_x ? r.hx : r.hy;
      (r.split_x ? upper.x : upper.y) += r.split_x ? r.hx : r.hy;
      integral.regions.push_back(upper);
      --i;  // look at the lower half again
    }
  };
  // Every region that touches the line y = `at`, halved towards it.
  const auto close_in_on_line = [&](double at, double narrow) {
    for (std::size_t i = 0; i < integral.regions.size(); ++i) {
      Region& r = integral.regions[i];
      const double side = at - r.y;
      if (std::abs(std::abs(side) - r.hy) > 1e-12 || r.hy <= narrow) continue;
      r.hy /= 2;
      Region other = r;
      r.y += side > 0 ? r.hy : -r.hy;
      other.y -= side > 0 ? r.hy : -r.hy;
      integral.regions.push_back(other);
      --i;  // look at the half that still touches again
    }
  };
  double pole = 1. / 2048;
  for (const Landmark& at : field.landmarks(integral.viewer)) {
    if (at.p.y != 0) close_in(at.p, double(at.size.x), double(at.size.y));
    if (abs(at.p.y) < at.size.y) pole = std::min(pole, double(at.size.y));
  }
  if (field.marks) {
    for (const Landmark& at : field.marks->at(integral.viewer))
      close_in(at.p, double(at.size.x), double(at.size.y));
  }
  if (!options.rim) {
    for (const float side : {1e-6f, -1e-6f}) {
      if (side < 0 && domain.half()) continue;
      for (int i = 0; i < nx; ++i) close_in({-1 + (2 * float(i) + 1) / float(nx), side}, 1, pole);
    }
  } else {
    close_in_on_line(0, pole);
    const double narrow = max(0.25 * double(integral.viewer.wo.z), 1e-5);
    close_in_on_line(1, narrow);
    if (!domain.half()) close_in_on_line(-1, narrow);
  }
}

void advance(Integral& integral, double relative_error, std::size_t max_regions) {
  integral.value = integral.error = 0;
  double square = 0;
  for (const Region& r : integral.regions) {
    integral.value += r.value, integral.error += r.error, square += r.error * r.error;
  }
  // The rule overestimates its errors, and those of kinks have random signs: six times the root of the
  // sum of squares bounds them, where the plain sum would ask for every kink of a table to be resolved.
  integral.error = min(integral.error, 6 * std::sqrt(square));
  const double allowed = relative_error * integral.value;
  if (integral.error <= allowed || integral.regions.size() >= max_regions) {
    integral.done = true;
    return;
  }
  // Halve the worst regions that together hold the surplus of error, by a histogram of the errors down to a
  // fiftieth of the largest.
  constexpr std::size_t bins = 256;
  double sum = 0, largest = 0;
  for (const Region& r : integral.regions) sum += r.error, largest = max(largest, r.error);
  const double surplus = sum * (1 - 0.9 * allowed / integral.error);
  const auto bin_of = [&](const Region& r) {
    return std::min(std::size_t(r.error / largest * bins), bins - 1);
  };
  std::array<double, bins> held{};
  for (const Region& r : integral.regions) held[bin_of(r)] += r.error;
  std::size_t lowest = bins - 1;
  for (double above = held[lowest]; above < surplus && lowest > bins / 50; above += held[lowest]) --lowest;
  std::vector<Region> next;
  std::vector<Region> children;
  for (std::size_t i = 0; i < integral.regions.size(); ++i) {
    Region r = integral.regions[i];
    if (bin_of(r) < lowest) {
      next.push_back(r);
      continue;
    }
    (r.split_x ? r.hx : r.hy) /= 2;
    for (const double sign : {-1., 1.}) {
      Region child = r;
      (r.split_x ? child.x : child.y) += sign * (r.split_x ? r.hx : r.hy);
      children.push_back(child);
    }
  }
  integral.fresh = next.size();
  next.insert(next.end(), children.begin(), children.end());
  integral.regions = std::move(next);
}

}  // namespace

Integrals integrate(const Field& field, const std::vector<Viewer>& viewers, const IntegralOptions& options,
                    const Host& host, Effort& effort) {
  if (viewers.empty()) return {};
  const double area = double(root_area(field.domain.symmetry));
  std::vector<Integral> integrals(viewers.size());
  for (std::size_t i = 0; i < viewers.size(); ++i) {
    integrals[i].viewer = viewers[i];
    start(integrals[i], field, options);
  }
  std::vector<FieldPoint> points;
  std::vector<FieldValue> values;
  std::vector<std::size_t> first(integrals.size());  // of each integral's points
  for (bool busy = true; busy;) {
    std::size_t total = 0;
    for (std::size_t i = 0; i < integrals.size(); ++i) {
      const Integral& integral = integrals[i];
      first[i] = total;
      if (!integral.done) total += (integral.regions.size() - integral.fresh) * genz_malik_points;
    }
    points.resize(total), values.resize(total);
    host.parallel_for(integrals.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Integral& integral = integrals[i];
        if (integral.done) continue;
        FieldPoint* point = points.data() + first[i];
        for (std::size_t r = integral.fresh; r < integral.regions.size(); ++r) {
          const Region& region = integral.regions[r];
          for (const Vec2<float>& q : genz_malik_nodes<float>()) {
            *point++ = field_point(integral.viewer, {float(region.x + region.hx * double(q.x)),
                                                     float(region.y + region.hy * double(q.y))});
          }
        }
      }
    });
    const auto done =
        std::count_if(integrals.begin(), integrals.end(), [](const Integral& i) { return i.done; });
    host.progress(linear_mix(float(done) / float(integrals.size()), options.progress, options.progress_end));
    eval_in_parallel(field, host, effort, points, values);
    host.parallel_for(integrals.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Integral& integral = integrals[i];
        if (integral.done) continue;
        const FieldValue* v = values.data() + first[i];
        for (std::size_t r = integral.fresh; r < integral.regions.size(); ++r, v += genz_malik_points) {
          apply_rule(integral.regions[r], v, area);
        }
        advance(integral, options.relative_error, options.max_regions);
      }
    });
    busy = std::any_of(integrals.begin(), integrals.end(), [](const Integral& i) { return !i.done; });
  }
  Integrals result;
  for (const Integral& integral : integrals) {
    result.values.push_back(integral.value);
    result.errors.push_back(integral.value > 0 ? integral.error / integral.value : 0);
    result.error = max(result.error, result.errors.back());
  }
  return result;
}

}  // namespace reflectree::detail
