// SPDX-License-Identifier: Apache-2.0
#include "cross_examine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bound_draws.hpp"
#include "build/albedo/integrals.hpp"
#include "build/albedo/panels.hpp"
#include "canonical.hpp"
#include "viewer_windows.hpp"

namespace reflectree::detail {

namespace {

constexpr float surprising = 2;  // times the bound
constexpr std::size_t most_surprises = 64;

// The share of all viewers, uniform in the known coordinates, that are in the slab.
double share_of_viewers(const Slab& slab, const Field& field) {
  const KnownBox whole = field.whole();
  double share = 1;
  for (int axis = 0; axis < whole.axes; ++axis)
    share *= double(slab.box.width(axis)) / double(whole.width(axis));
  return share;
}

struct Mean {
  double sum = 0, square = 0;
  std::size_t count = 0;
  void add(double x) { sum += x, square += x * x, ++count; }
  double mean() const { return count ? sum / double(count) : 0; }
  double error() const {
    const auto n = double(count);
    return count > 1 ? std::sqrt(std::max(square / n - mean() * mean(), 0.) / (n - 1)) : 0;
  }
};

// Two of three probes uniform over the hemisphere, the third over the square.
std::vector<FieldPoint> probes(const Field& field, std::size_t count, Pcg32& u) {
  const Domain& domain = field.domain;
  const KnownBox whole = field.whole();
  std::vector<FieldPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const float theta = theta_max * to_unit_float(u());
    const float a = to_unit_float(u()), b = to_unit_float(u());
    Shares share{};
    for (int axis = 1; axis < whole.axes; ++axis) share[std::size_t(axis)] = to_unit_float(u());
    Known known = whole.at(share);
    known[0] = theta;
    const Viewer viewer = viewer_at(known);
    if (i % 3 == 0) {
      points.push_back(field_point(viewer, square_point(domain.symmetry, a, b)));
      continue;
    }
    const float z = max(b, 1e-4f), r = sqrt(1 - z * z), phi = (domain.half() ? pi : 2 * pi) * a;
    points.push_back(field_point(viewer, field.place_of(viewer, {r * cos(phi), r * sin(phi), z})));
  }
  return points;
}

// Points drawn from the bounds of a slab, each for a theta_o of its own, and the bound there.
void draw_from_bounds(const Slab& slab, std::size_t count, const Domain& domain, Pcg32& u,
                      std::vector<FieldPoint>& points, std::vector<Known>& known,
                      std::vector<float>& bounds) {
  const Urn urn = urn_of(slab);
  for (std::size_t k = 0; k < count; ++k) {
    const BoundDraw drawn = draw(urn, domain, u);
    Shares share{};
    for (int axis = 0; axis < slab.box.axes; ++axis) share[std::size_t(axis)] = to_unit_float(u());
    known.push_back(slab.box.at(share));
    points.push_back(field_point(viewer_at(known.back()), drawn.p));
    bounds.push_back(drawn.bound);
  }
}

// The albedo of viewers in boxes under suspicion, by a finer cubature than those that made the table.
std::vector<WrongAlbedo> look_at_albedo(const std::vector<KnownBox>& boxes, const Survey& survey, Pcg32& u) {
  constexpr int each = 9;
  std::vector<Known> known;
  std::vector<Viewer> viewers;
  for (const KnownBox& box : boxes) {
    for (int i = 0; i < each; ++i) {
      const float across = (float(i) + to_unit_float(u())) / each;
      Shares share{box.axes > 1 ? to_unit_float(u()) : across, across};
      for (int axis = 2; axis < box.axes; ++axis) share[std::size_t(axis)] = to_unit_float(u());
      known.push_back(box.at(share));
      viewers.push_back(viewer_at(known.back()));
    }
  }
  const Integrals seen =
      integrate(survey.field, viewers, {1e-3, 24, 12, true, 0.87f, 0.87f}, survey.host, survey.effort);
  std::vector<WrongAlbedo> wrong;
  for (std::size_t i = 0; i < viewers.size(); ++i) {
    if (survey.at_jump(viewers[i].wo)) continue;
    const double a = double(survey.albedo_at(viewers[i])), b = seen.values[i], larger = std::max(a, b);
    const double miss =
        larger > 0 ? (std::abs(a - b) / larger - seen.error) / times_allowed(viewers[i].wo.z) : 0;
    if (miss > double(survey.albedo.relative_error)) wrong.push_back({known[i], a, b, miss});
  }
  std::stable_sort(wrong.begin(), wrong.end(),
                   [](const WrongAlbedo& a, const WrongAlbedo& b) { return a.miss > b.miss; });
  return wrong;
}

}  // namespace

CrossExamination cross_examine(const std::vector<Slab>& slabs, const Survey& survey,
                               const FieldPoint& brightest, std::uint64_t seed) {
  constexpr std::size_t probe_count = 3U << 16U;
  const Domain& domain = survey.field.domain;
  const std::size_t draw_count = std::size_t(survey.field.whole().axes > 1 ? 4 : 1) << 16U;
  Pcg32 u(seed, 23);
  CrossExamination result;

  const KnownBox whole = survey.field.whole();
  const Partition partition = partition_of(slabs, survey.field.parameters);
  std::vector<FieldPoint> points = probes(survey.field, probe_count, u);
  points.push_back(brightest);
  std::vector<FieldValue> values(points.size());
  survey.eval(points, values);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (survey.at_jump(points[i])) continue;
    const float a = survey.albedo_at(points[i].viewer());
    if (!(values[i].upper > 0)) continue;
    const Slab& slab = slabs[slab_index(partition, points[i].viewer(), whole)];
    const Leaf& leaf = slab.nodes[leaf_at(slab, points[i].p, domain)].leaf;
    const float bound = leaf.height * shape(leaf, box_of(leaf.cell, domain), points[i].p);
    const float ratio = a > 0 ? values[i].upper / (a * bound) : std::numeric_limits<float>::infinity();
    if (!(ratio > surprising)) continue;
    result.surprises.push_back(
        {points[i].viewer(), survey.field.direction_at(points[i]), ratio, points[i].p});
  }
  std::stable_sort(result.surprises.begin(), result.surprises.end(),
                   [](const Surprise& a, const Surprise& b) { return a.ratio > b.ratio; });
  if (result.surprises.size() > most_surprises) result.surprises.resize(most_surprises);

  // A slab is drawn from as often as a viewer is in it; its mean is weighted by what it was drawn for.
  points.clear();
  std::vector<float> bounds;
  std::vector<Known> known;
  std::vector<std::size_t> first;
  for (const Slab& slab : slabs) {
    first.push_back(points.size());
    const double share = share_of_viewers(slab, survey.field);
    draw_from_bounds(slab, 16 + std::size_t(share * double(draw_count)), domain, u, points, known, bounds);
  }
  first.push_back(points.size());
  values.resize(points.size());
  survey.eval(points, values);
  std::vector<ViewerDraw> draws;
  double weights = 0, error2 = 0;
  result.by_bounds = result.accepted = 0;
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    const auto volume = double(total(slabs[s], &Leaf::cost));
    Mean once, accepted;
    for (std::size_t i = first[s]; i < first[s + 1]; ++i) {
      const float a = survey.albedo_at(points[i].viewer());
      if (!(a > 0) || survey.at_jump(points[i])) continue;
      // Of mirror images on half a square one is drawn: their mean is what is accepted.
      const double ratio = double(values[i].mean) / (double(a) * double(bounds[i]));
      once.add(volume * ratio), accepted.add(volume * std::min(ratio, 1.));
      draws.push_back({known[i], float(volume * ratio)});
    }
    if (once.count == 0) continue;
    const double w = share_of_viewers(slabs[s], survey.field);
    weights += w;
    result.by_bounds += w * once.mean(), result.accepted += w * accepted.mean();
    error2 += w * w * once.error() * once.error();
  }
  if (weights > 0) {
    result.by_bounds /= weights, result.accepted /= weights;
    result.by_bounds_error = std::sqrt(error2) / weights;
  } else {
    result.by_bounds = result.accepted = 1;
  }
  result.wrong = look_at_albedo(odd_windows(draws, whole), survey, u);
  return result;
}

}  // namespace reflectree::detail
