// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/bin_masses.hpp"

#include <algorithm>
#include <cmath>

#include "neighbours.hpp"
#include "parallel.hpp"
#include "reflectree/math/sum.hpp"

namespace reflectree {
namespace {

using Regions = std::vector<CubatureRegion>;

double lo(const CubatureBox& r, bool x) { return x ? r.x0 : r.y0; }
double hi(const CubatureBox& r, bool x) { return x ? r.x1 : r.y1; }

// The share of a region below `at`, its mass taken as uniform: good enough to place borders.
double share_below(const CubatureBox& r, bool x, double at) {
  return std::clamp((at - lo(r, x)) / (hi(r, x) - lo(r, x)), 0., 1.);
}

double mass_below(const Regions& regions, bool x, double at) {
  double mass = 0;
  for (const auto& r : regions) mass += r.value * share_below(r.box, x, at);
  return mass;
}

double spread(const Regions& regions, bool x) {
  double mass = 0, first = 0, second = 0;
  for (const auto& r : regions) {
    const double c = 0.5 * (lo(r.box, x) + hi(r.box, x));
    mass += r.value;
    first += r.value * c;
    second += r.value * (c * c + sqr(hi(r.box, x) - lo(r.box, x)) / 12);
  }
  return mass > 0 ? second / mass - sqr(first / mass) : 0;
}

double quantile(const Regions& regions, bool x, double mass, double a, double b) {
  for (int i = 0; i < 45; ++i) {
    const double middle = 0.5 * (a + b);
    (mass_below(regions, x, middle) < mass ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

Regions part(const Regions& regions, bool x, double at, bool upper) {
  Regions result;
  for (CubatureRegion r : regions) {
    const double below = share_below(r.box, x, at);
    r.value *= upper ? 1 - below : below;
    if (!(r.value > 0)) continue;
    if (below > 0 && below < 1) (x ? (upper ? r.box.x0 : r.box.x1) : (upper ? r.box.y0 : r.box.y1)) = at;
    result.push_back(r);
  }
  return result;
}

// What bins are made of: a patch of f, or the whole chart.
struct Part {
  CubatureBox box;
  Regions regions;
  double mass = 0;
};

// Returns the node's number, or -1 - bin.
int divide(Bins& bins, const Regions& regions, const CubatureBox& box, int count) {
  if (count <= 1) {
    bins.boxes.push_back(box);
    return -int(bins.boxes.size());
  }
  const bool x = spread(regions, true) >= spread(regions, false);
  double mass = 0;
  for (const auto& r : regions) mass += r.value;
  const int lower_count = count / 2;
  const double at = quantile(regions, x, mass * lower_count / count, lo(box, x), hi(box, x));
  CubatureBox below = box, above = box;
  (x ? below.x1 : below.y1) = at;
  (x ? above.x0 : above.y0) = at;
  const auto node = bins.nodes.size();
  bins.nodes.push_back({x, at, 0, 0});
  const int lower = divide(bins, part(regions, x, at, false), below, lower_count);
  const int upper = divide(bins, part(regions, x, at, true), above, count - lower_count);
  bins.nodes[node].lower = lower;
  bins.nodes[node].upper = upper;
  return int(node);
}

// The same for parts in rows: a line between two rows, or two parts of a row, cuts none. Each has a bin at least.
int divide(Bins& bins, std::span<const Part> parts, double mass_of_a_bin) {
  if (parts.size() == 1) {
    const Part& part = parts.front();
    return divide(bins, part.regions, part.box, std::max(1, int(std::lround(part.mass / mass_of_a_bin))));
  }
  const auto row = [&](std::size_t i) { return parts[i].box.y0; };
  const bool x = row(0) == row(parts.size() - 1);
  std::size_t half = parts.size() / 2;
  while (!x && half > 0 && row(half - 1) == row(half)) --half;
  if (half == 0)
    half = std::size_t(
        std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.box.y0 > row(0); }) -
        parts.begin());
  const auto node = bins.nodes.size();
  bins.nodes.push_back({x, lo(parts[half].box, x), 0, 0});
  const int lower = divide(bins, parts.first(half), mass_of_a_bin);
  const int upper = divide(bins, parts.subspan(half), mass_of_a_bin);
  bins.nodes[node].lower = lower;
  bins.nodes[node].upper = upper;
  return int(node);
}

// The cells from which every cubature here starts, over the whole chart. A bin in a dim place is large: from
// two cells by two it may miss what fills a corner of it, with a small error estimate.
constexpr int grid_x = 96, grid_y = 48;

int cells_across(double width, double of, int grid) { return std::max(2, int(std::ceil(width / of * grid))); }

struct Rule : CubatureOptions {
  // A sampler's density may reach over the border of a patch by a sliver of one of its leaves.
  bool slivers = false;
};

// Where an interval of the chart is cut: where its grading turns, so that no region straddles a kink, and closer
// and closer to its ends.
std::vector<double> cuts_of(double begin, double end, bool slivers) {
  std::vector<double> cuts{begin};
  for (double next = std::floor(begin) + 1; next < end; next += 1) cuts.push_back(next);
  cuts.push_back(end);
  for (int k = 4; slivers && k <= 256; k *= 4)
    cuts.push_back(begin + (end - begin) / k), cuts.push_back(end - (end - begin) / k);
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

CubatureResult integrate(const Integrand& f, const CubatureBox& box, Rule rule) {
  CubatureResult total;
  total.converged = true;
  const std::vector<double> x = cuts_of(box.x0, box.x1, rule.slivers),
                            y = cuts_of(box.y0, box.y1, rule.slivers);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    for (std::size_t j = 0; j + 1 < y.size(); ++j) {
      rule.cells_x = cells_across(x[i + 1] - x[i], 4, grid_x);
      rule.cells_y = cells_across(y[j + 1] - y[j], 2, grid_y);
      const CubatureResult r = cubature(f, {x[i], x[i + 1], y[j], y[j + 1]}, rule);
      total.value += r.value;
      total.error += r.error;
      total.evaluations += r.evaluations;
      total.converged = total.converged && r.converged;
    }
  }
  return total;
}

// Every box. A function that is called from one thread may be a program on a pipe or one of Python, to which
// each call is dear: the cubatures of many boxes go on together, and what they ask next is asked at once. A
// cubature is begun anew each time, with the answers that it has had, and ends where it asks for more.
struct Unanswered {};

struct Replay {
  std::vector<std::vector<double>> answers;  // to its calls, in order
  std::vector<Vec2<double>> asked;           // by the call after them; empty: it is done
  CubatureResult result;

  void go_on(const CubatureBox& box, const Rule& rule) {
    std::size_t next = 0;
    asked.clear();
    const Integrand remembered = [&](std::span<const Vec2<double>> p, std::span<double> out) {
      if (next < answers.size()) {
        std::copy(answers[next].begin(), answers[next].end(), out.begin());
        ++next;
        return;
      }
      asked.assign(p.begin(), p.end());
      throw Unanswered{};
    };
    try {
      result = integrate(remembered, box, rule);
      answers.clear();
    } catch (const Unanswered&) {
    }
  }
};

void integrate_together(const Integrand& f, std::span<const CubatureBox> boxes, const Rule& rule,
                        std::span<CubatureResult> results, const Host& host) {
  std::vector<Replay> replays(boxes.size());
  std::vector<Vec2<double>> all;
  std::vector<double> values;
  do {
    if (host.cancelled()) throw Cancelled();
    std::size_t from = 0;
    all.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      Replay& r = replays[i];
      if (!values.empty() && r.asked.empty()) continue;
      if (!r.asked.empty()) {
        const auto begin = values.begin() + std::ptrdiff_t(from);
        from += r.asked.size();
        r.answers.emplace_back(begin, values.begin() + std::ptrdiff_t(from));
      }
      r.go_on(boxes[i], rule);
      all.insert(all.end(), r.asked.begin(), r.asked.end());
    }
    values.resize(all.size());
    if (!all.empty()) f(all, values);
  } while (!all.empty());
  for (std::size_t i = 0; i < boxes.size(); ++i) results[i] = replays[i].result;
}

std::vector<CubatureResult> integrate_all(const Integrand& f, bool concurrent,
                                          const std::vector<CubatureBox>& boxes, const Rule& rule,
                                          const Host& host) {
  std::vector<CubatureResult> results(boxes.size());
  if (concurrent) {
    detail::for_each_index(host, true, boxes.size(),
                           [&](std::size_t i) { results[i] = integrate(f, boxes[i], rule); });
    return results;
  }
  constexpr std::size_t together = 256;  // what they remember is a few hundred MB at most
  for (std::size_t first = 0; first < boxes.size(); first += together) {
    const std::size_t n = std::min(together, boxes.size() - first);
    integrate_together(f, std::span(boxes).subspan(first, n), rule, std::span(results).subspan(first, n),
                       host);
  }
  return results;
}

// Relative, of the total and of a cubature from cells that share no border with the first: where kinks or
// the rim deceive both rules of a cell, the two disagree.
double difference_to_another_road(const Integrand& f, std::span<const Part> parts, double total) {
  CubatureOptions options;
  options.relative_tolerance = 1e-5;
  options.max_evaluations = 200'000;
  options.cells_x = parts.size() > 1 ? 3 : 37;
  options.cells_y = parts.size() > 1 ? 3 : 23;
  double sum = 0;
  for (const Part& part : parts) sum += cubature(f, part.box, options).value;
  return std::abs(sum / total - 1);
}

}  // namespace

std::size_t Bins::find(Direction wi) const {
  const auto bin_of = [this](Vec3<double> w) {
    const Vec2<double> p = chart.coordinates(w);
    int i = nodes.empty() ? -1 : 0;
    while (i >= 0) {
      const Node& n = nodes[std::size_t(i)];
      i = (n.split_x ? p.x : p.y) < n.at ? n.lower : n.upper;
    }
    return std::size_t(-1 - i);
  };
  const std::size_t bin = bin_of({wi.x, wi.y, wi.z});
  if (!patches || mass.empty() || mass[bin] > 0) return bin;
  for (const Vec3<double>& w : detail::neighbours(wi)) {
    if (mass[bin_of(w)] > 0) return bin_of(w);
  }
  return bin;
}

Bins equal_mass_bins(const TargetFunction& f, Direction wo, const BinOptions& options, const Host& host) {
  const Vec3<double> w = normalize(Vec3<double>{wo.x, wo.y, wo.z});
  Bins bins{wo, HemisphereChart({0, 0, 1}), {}, {}, {}, 0, 0, !f.patches.empty()};
  const bool told = options.centre && !bins.patches;
  if (w.z > 0) bins.chart = told ? HemisphereChart(*options.centre) : choose_chart(f, w);
  if (!(w.z > 0)) return bins;
  const Integrand integrand = chart_integrand(f, w, bins.chart);

  CubatureOptions coarse;
  coarse.relative_tolerance = f.concurrent ? 1e-3 : 1e-2;  // where a call is dear, few of a few points
  coarse.max_evaluations = 400'000;
  coarse.cells_x = bins.patches ? 2 : grid_x;  // ten regions per bin: a region's mass is taken as uniform
  coarse.cells_y = bins.patches ? 2 : grid_y;
  std::vector<Part> parts;
  double whole = 0;
  for (const CubatureBox& box : chart_parts(f)) {
    Part& part = parts.emplace_back(Part{box, {}, 0});
    part.mass = cubature(integrand, box, coarse, part.regions).value;
    for (auto& r : part.regions)
      r.value = std::max(r.value, 0.);  // a rule with a negative weight may undershoot
    whole += part.mass;
  }
  if (!(whole > 0)) return bins;
  divide(bins, parts, whole / options.count);

  Rule fine;
  fine.relative_tolerance = options.tolerance;
  fine.absolute_tolerance = 0.1 * options.tolerance * whole / options.count;
  fine.max_evaluations = 200'000;
  const auto results = integrate_all(integrand, f.concurrent, bins.boxes, fine, host);
  CompensatedSum total;
  for (const CubatureResult& r : results) {
    bins.mass.push_back(r.value);
    total += r.value;
    if (r.value > 0) bins.worst_error = std::max(bins.worst_error, r.error / r.value);
  }
  bins.total = total.value();
  bins.worst_error = std::max(bins.worst_error, difference_to_another_road(integrand, parts, bins.total));
  return bins;
}

namespace {

BinMasses masses(const Integrand& integrand, bool concurrent, const Bins& bins, double tolerance,
                 double absolute_tolerance, bool slivers, const Host& host) {
  Rule rule;
  rule.relative_tolerance = tolerance;
  rule.absolute_tolerance = absolute_tolerance;
  rule.max_evaluations = 60'000;
  rule.slivers = slivers;
  BinMasses result;
  CompensatedSum error;
  for (const CubatureResult& r : integrate_all(integrand, concurrent, bins.boxes, rule, host)) {
    result.mass.push_back(r.value);
    error += r.error;
  }
  result.error = error.value();
  return result;
}

double share_of_a_bin(const Bins& bins) { return 1 / double(std::max<std::size_t>(bins.boxes.size(), 1)); }

}  // namespace

std::vector<double> density_masses(const ErasedSampler& sampler, const Bins& bins, double tolerance,
                                   const Host& host) {
  return masses(chart_integrand(sampler, bins.wo, bins.chart), sampler.concurrent, bins, tolerance,
                0.1 * tolerance * share_of_a_bin(bins), bins.patches, host)
      .mass;
}

BinMasses function_masses(const TargetFunction& f, const Bins& bins, double tolerance, const Host& host) {
  const Vec3<double> w = normalize(Vec3<double>{bins.wo.x, bins.wo.y, bins.wo.z});
  return masses(chart_integrand(f, w, bins.chart), f.concurrent, bins, tolerance,
                0.1 * tolerance * share_of_a_bin(bins) * bins.total, false, host);
}

}  // namespace reflectree
