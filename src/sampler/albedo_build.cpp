// SPDX-License-Identifier: Apache-2.0
#include "albedo_build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "reflectree/sampler/albedo.hpp"

namespace reflectree {

float albedo_at(const AlbedoTable& table, float c) {
  const auto& x = table.cos_theta_o;
  if (x.empty() || !(c >= x.front()) || c > x.back()) return 0;
  // The last entry up to c, by halving without a branch: random cosines would mispredict it.
  std::size_t i = 0;
  for (std::size_t count = x.size() - 1; count > 1;) {
    const std::size_t half = count / 2;
    i += x[i + half] <= c ? half : 0;
    count -= half;
  }
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  return lerp(t, table.albedo[i], table.albedo[i + 1]);
}

namespace detail {

namespace {

// Genz and Malik 1980, degree 7 with an embedded degree 5, in two dimensions: 17 points.
constexpr std::size_t rule_size = 17;
const float l2 = std::sqrt(9.f / 70), l3 = std::sqrt(0.9f), l5 = std::sqrt(9.f / 19);
const std::array<Vec2<float>, rule_size> rule_points{{{0, 0},
                                                      {-l2, 0},
                                                      {l2, 0},
                                                      {0, -l2},
                                                      {0, l2},
                                                      {-l3, 0},
                                                      {l3, 0},
                                                      {0, -l3},
                                                      {0, l3},
                                                      {-l3, -l3},
                                                      {l3, -l3},
                                                      {-l3, l3},
                                                      {l3, l3},
                                                      {-l5, -l5},
                                                      {l5, -l5},
                                                      {-l5, l5},
                                                      {l5, l5}}};

struct Region {
  double x, y, hx, hy;  // centre and half widths in square coordinates
  double value = 0, error = 0;
  bool split_x = true;
};

void apply_rule(Region& r, const FieldValue* v, double area) {
  const auto sum4 = [v](int i) { return double(v[i].mean) + v[i + 1].mean + v[i + 2].mean + v[i + 3].mean; };
  const double f0 = v[0].mean, s2 = sum4(1), s3 = sum4(5), s4 = sum4(9), s5 = sum4(13);
  const double share = 4 * r.hx * r.hy / area;
  const double degree7 = (-3816 * f0 + 2940 * s2 + 1020 * s3 + 200 * s4 + 6859. / 4 * s5) / 19683;
  const double degree5 = (-1942 * f0 + 735 * s2 + 65 * s3 + 50 * s4) / 1458;
  r.value = share * degree7;
  r.error = share * std::abs(degree7 - degree5);
  // Fourth differences along each axis choose the split.
  const double ratio = (9. / 70) / 0.9;
  const auto difference = [&](int i, int j) {
    return std::abs(double(v[i].mean) + v[i + 1].mean - 2 * f0 -
                    ratio * (double(v[j].mean) + v[j + 1].mean - 2 * f0));
  };
  const double dx = difference(1, 5), dy = difference(3, 7);
  r.split_x = dx > dy || (dx == dy && r.hx >= r.hy);
}

// One integral, advanced in rounds: the regions that carry most of the error are halved.
struct Integral {
  float cos_theta_o = 0;
  std::vector<Region> regions;
  std::size_t fresh = 0;  // regions from here on await their values
  double value = 0, error = 0;
  bool done = false;
};

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr std::size_t max_regions = 40000;

void start(Integral& integral, const Domain& domain) {
  const int nx = 8, ny = domain.half ? 4 : 8;
  const double y0 = domain.half ? 0 : -1, hx = 1. / nx, hy = (1 - y0) / (2 * ny);
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
  for (int k = 0; k < landmark_count; ++k) {
    const Vec2<float> p = landmark(domain, integral.cos_theta_o, k);
    if (p.y != 0) close_in(p, 1. / 128, 1. / 128);
  }
  for (int i = 0; i < nx; ++i) close_in({-1 + (2 * float(i) + 1) / float(nx), 1e-6f}, 1, 1. / 2048);
  if (!domain.half) {
    for (int i = 0; i < nx; ++i) close_in({-1 + (2 * float(i) + 1) / float(nx), -1e-6f}, 1, 1. / 2048);
  }
}

void advance(Integral& integral, double relative_error) {
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

struct Integrals {
  std::vector<double> values;
  double error = 0;  // the largest, relative; more than asked for where max_regions do not reach it
};

// Integrates T over the square for every cosine; all integrals advance together, a round a batch.
Integrals integrate(const Field& field, const std::vector<float>& cosines, double relative_error,
                    const Host& host, std::uint64_t* evaluations) {
  const double area = field.domain.half ? 2 : 4;
  std::vector<Integral> integrals(cosines.size());
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    integrals[i].cos_theta_o = cosines[i];
    start(integrals[i], field.domain);
  }
  std::vector<FieldPoint> points;
  std::vector<FieldValue> values;
  std::vector<std::size_t> first(integrals.size());  // of each integral's points
  for (bool busy = true; busy;) {
    points.clear();
    for (std::size_t i = 0; i < integrals.size(); ++i) {
      const Integral& integral = integrals[i];
      first[i] = points.size();
      if (integral.done) continue;
      for (std::size_t r = integral.fresh; r < integral.regions.size(); ++r) {
        const Region& region = integral.regions[r];
        for (const Vec2<float>& q : rule_points) {
          points.push_back(
              {integral.cos_theta_o,
               {float(region.x + region.hx * double(q.x)), float(region.y + region.hy * double(q.y))}});
        }
      }
    }
    values.resize(points.size());
    eval_in_parallel(field, host, points, values);
    *evaluations += points.size();
    host.parallel_for(integrals.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Integral& integral = integrals[i];
        if (integral.done) continue;
        const FieldValue* v = values.data() + first[i];
        for (std::size_t r = integral.fresh; r < integral.regions.size(); ++r, v += rule_size) {
          apply_rule(integral.regions[r], v, area);
        }
        advance(integral, relative_error);
      }
    });
    busy = std::any_of(integrals.begin(), integrals.end(), [](const Integral& i) { return !i.done; });
  }
  Integrals result;
  for (const Integral& integral : integrals) {
    result.values.push_back(integral.value);
    if (integral.value > 0) result.error = max(result.error, integral.error / integral.value);
  }
  return result;
}

// A panel of the table: five equidistant nodes in theta_o (in which measured tables are smooth at the normal,
// where the cosine has a branch point) and the polynomial through them. Between kinks the albedo is smooth,
// so that a few integrals serve many entries of the table.
struct Panel {
  double lo, hi;
  std::array<double, 2> predicted{inf, inf};  // at the odd nodes, by the panel that was halved
};
double node_of(const Panel& p, int i) {
  return i == 0 ? p.lo : i == 4 ? p.hi : p.lo + 0.25 * i * (p.hi - p.lo);
}
float cosine_of(double theta) { return clamp(float(std::cos(theta)), min_cos_theta_o, 1.f); }

// The polynomial through the values at t = first, first + step, ... of the five nodes, at t in [0, 4].
double interpolate(const std::array<double, 5>& v, int step, double t) {
  double sum = 0;
  for (int i = 0; i < 5; i += step) {
    double basis = 1;
    for (int j = 0; j < 5; j += step) {
      if (j != i) basis *= (t - j) / (i - j);
    }
    sum += basis * v[std::size_t(i)];
  }
  return sum;
}

using Factor = std::function<double(double theta_o)>;

// Appends the entries of the panel after `lo`, halving until lines in the cosine miss the polynomial times
// the factor by at most `error`, relatively.
void tabulate(const Panel& panel, const std::array<double, 5>& v, const Factor& factor, double t0, double t1,
              double error, int depth, std::map<float, double>& table) {
  const auto theta_at = [&](double t) { return panel.lo + 0.25 * t * (panel.hi - panel.lo); };
  const auto cosine_at = [&](double t) { return std::cos(theta_at(t)); };
  const auto albedo = [&](double t) { return interpolate(v, 1, t) * factor(theta_at(t)); };
  const double a0 = albedo(t0), a1 = albedo(t1), c0 = cosine_at(t0), c1 = cosine_at(t1);
  const double mid = 0.5 * (t0 + t1);
  bool good = true;  // at the quarters too: a kink may meet the line in the middle
  for (const double t : {mid, 0.5 * (t0 + mid), 0.5 * (mid + t1)}) {
    const double line = a0 + (cosine_at(t) - c0) / (c1 - c0) * (a1 - a0), curve = albedo(t);
    good = good && std::abs(line - curve) <= error * curve;
  }
  if (depth > 0 && !good) {
    tabulate(panel, v, factor, t0, mid, error, depth - 1, table);
    tabulate(panel, v, factor, mid, t1, error, depth - 1, table);
    return;
  }
  table[cosine_of(theta_at(t1))] = max(a1, 0.);
}

}  // namespace

AlbedoTable build_albedo(const Field& field, float relative_error, const Host& host,
                         std::uint64_t* evaluations) {
  double error = double(relative_error);
  const auto cubature_error = [&error] { return 0.25 * error; };
  const auto interpolation_error = [&error] { return 0.15 * error; };
  // Panels of at most 7.5 degrees, and octaves towards the horizon. Where a mirror lobe passes the kinks of a
  // table over the difference angle, a panel begins at every second kink: the one between is met by the
  // middle node, and the parabola shows what it weighs.
  constexpr std::size_t steps = 12;
  const std::vector<float> kinks = field.f.traits().theta_d_knots;
  const bool dense = kinks.size() >= 2 * steps;  // then their panels are narrower than the steps
  std::vector<double> borders;
  for (std::size_t i = 0; i < (dense ? 1 : steps); ++i)
    borders.push_back(double(i) * 7.5 * pi_v<double> / 180);
  for (std::size_t i = 0; i < kinks.size(); i += 2) borders.push_back(double(kinks[i]));
  for (const double near : {0.5, 1.5, 3.75})
    borders.push_back(near * pi_v<double> / 180);  // kinks of tables crowd
  for (const int octave : {4, 5, 7, 10, 13, 17}) borders.push_back(std::acos(std::ldexp(1., -octave)));
  for (const float theta : field.f.traits().theta_o_knots) {
    if (theta > 1e-3f && cos(theta) > 1.5f * min_cos_theta_o) borders.push_back(double(theta));
  }
  std::sort(borders.begin(), borders.end());
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());

  // The nodes hold the albedo without the factor that the function knows of.
  const Factor known = field.f.traits().theta_o_factor;
  const Factor factor = [&known](double theta_o) { return known ? known(theta_o) : 1.; };
  std::vector<Panel> open, closed;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) open.push_back({borders[i], borders[i + 1]});
  std::map<double, double> nodes;
  double worst = 0;  // of the integrals, as they estimate it
  const auto integrate_nodes = [&](const std::vector<double>& thetas) {
    std::vector<float> cosines;
    for (const double theta : thetas) cosines.push_back(cosine_of(theta));
    const Integrals a = integrate(field, cosines, cubature_error(), host, evaluations);
    for (std::size_t i = 0; i < thetas.size(); ++i) nodes[thetas[i]] = a.values[i] / factor(thetas[i]);
    worst = max(worst, a.error);
  };
  const auto values_of = [&](const Panel& panel) {
    std::array<double, 5> v;
    for (int i = 0; i < 5; ++i) v[std::size_t(i)] = nodes[node_of(panel, i)];
    return v;
  };
  for (int level = 0; !open.empty(); ++level) {
    std::vector<double> pilots, fresh;
    for (const Panel& panel : open) {
      for (int i = 0; i < 5; ++i) {
        if (!nodes.emplace(node_of(panel, i), 0.).second) continue;
        const bool pilot = level == 0 && (pilots.size() + fresh.size()) % 8 == 0;
        (pilot ? pilots : fresh).push_back(node_of(panel, i));
      }
    }
    // A function with steps has no albedo to four digits for any decent number of evaluations: where the
    // first few integrals do not get there, all are content with what is easily had, and the table says so.
    integrate_nodes(pilots);
    if (worst > cubature_error()) error = min(8 * worst, 1.);
    integrate_nodes(fresh);
    std::vector<Panel> next;
    for (const Panel& panel : open) {
      // What the parabola misses at the odd nodes; the polynomial of degree 4 misses far less. What the
      // parent's polynomial of degree 4 missed there is known, too, and this half misses less.
      const std::array<double, 5> v = values_of(panel);
      double miss = 0, parent_miss = 0, scale = 0;
      for (const int i : {1, 3}) {
        const auto k = std::size_t(i);
        miss = max(miss, std::abs(interpolate(v, 2, i) - v[k]));
        parent_miss = max(parent_miss, std::abs(panel.predicted[k / 2] - v[k]));
        scale = max(scale, v[k]);
      }
      const double allowed = interpolation_error() * scale;
      if (miss > 4 * allowed && parent_miss > 3 * allowed && level < 10) {
        const double mid = node_of(panel, 2);
        next.push_back({panel.lo, mid, {interpolate(v, 1, 0.5), interpolate(v, 1, 1.5)}});
        next.push_back({mid, panel.hi, {interpolate(v, 1, 2.5), interpolate(v, 1, 3.5)}});
      } else {
        closed.push_back(panel);
      }
    }
    open = std::move(next);
  }
  std::map<float, double> entries{{1.f, nodes[borders.front()] * factor(borders.front())}};
  for (const Panel& panel : closed) {
    tabulate(panel, values_of(panel), factor, 0, 4, interpolation_error(), 8, entries);
  }
  AlbedoTable table;
  for (const auto& [c, a] : entries) table.cos_theta_o.push_back(c), table.albedo.push_back(float(a));
  table.relative_error = worst > 1.001 * cubature_error() ? float(min(4 * worst, 1.)) : float(error);
  return table;
}

}  // namespace detail
}  // namespace reflectree
