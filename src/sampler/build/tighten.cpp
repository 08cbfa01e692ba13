// SPDX-License-Identifier: Apache-2.0
#include "tighten.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "canonical.hpp"
#include "grow.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

namespace {

// What the climb may miss at a smooth summit: its last step spans 1/64 of the leaf.
constexpr float margin = 1e-3f;

// Where a climber stands: shares of its slab, along each known coordinate, then of its leaf; in [0, 1].
using Place = std::array<float, known_slots + 2>;

struct Climber {
  Slab* slab;
  Leaf* leaf;
  Box box;
  Place at, step;
  float value;
  int axes() const { return slab->box.axes + 2; }
};

Known known_at(const Climber& c, const Place& at) {
  Shares share{};
  std::copy_n(at.begin(), c.slab->box.axes, share.begin());
  return c.slab->box.at(share);
}
Vec2<float> point_at(const Climber& c, const Place& at) {
  const auto x = std::size_t(c.slab->box.axes);
  return {c.box.x0 + c.box.width * at[x], c.box.y0 + c.box.height * at[x + 1]};
}
FieldPoint point_of(const Climber& c, const Place& at) {
  return field_point(viewer_at(known_at(c, at)), point_at(c, at));
}

// What T is divided by for a viewer; 0 where it is not to be judged.
float normaliser(const Survey& survey, const Viewer& viewer) {
  return survey.at_jump(viewer.wo) ? 0.f : survey.albedo_at(viewer);
}
// T / (albedo q): what the leaf's bound must reach at p.
float ratio_of(float albedo, const Leaf& leaf, const Box& box, Vec2<float> p, float v) {
  return albedo > 0 ? v / (albedo * shape(leaf, box, p)) : 0.f;
}

// Coordinate steps up and down each axis, all climbers in one batch; steps shrink where none helps.
void climb(std::vector<Climber>& climbers, int rounds, const Survey& survey) {
  if (climbers.empty()) return;
  const int axes = climbers.front().axes();
  const auto neighbours = std::size_t(2 * axes);
  std::vector<FieldPoint> points(climbers.size() * neighbours);
  std::vector<FieldValue> values(points.size());
  const auto moved = [](const Climber& c, std::size_t k) {
    Place out = c.at;
    out[k / 2] = clamp(c.at[k / 2] + (k % 2 ? c.step[k / 2] : -c.step[k / 2]), 1e-5f, 1 - 1e-5f);
    return out;
  };
  // Steps over the leaf alone; the last neighbour is one.
  const auto keeps_viewer = [](const Climber& c, std::size_t k) { return int(k / 2) >= c.slab->box.axes; };
  for (int round = 0; round < rounds; ++round) {
    survey.host.parallel_for(climbers.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Climber& c = climbers[i];
        const Viewer here = viewer_at(known_at(c, c.at));
        for (std::size_t k = 0; k < neighbours; ++k) {
          const Place to = moved(c, k);
          const Viewer viewer = keeps_viewer(c, k) ? here : viewer_at(known_at(c, to));
          points[i * neighbours + k] = field_point(viewer, point_at(c, to));
        }
      }
    });
    survey.eval(points, values);
    survey.host.parallel_for(climbers.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Climber& c = climbers[i];
        std::array<float, 2 * (known_slots + 2)> r{};
        const float here = normaliser(survey, points[(i + 1) * neighbours - 1].viewer());
        for (std::size_t k = 0; k < neighbours; ++k) {
          const std::size_t j = i * neighbours + k;
          const float albedo = keeps_viewer(c, k) ? here : normaliser(survey, points[j].viewer());
          r[k] = ratio_of(albedo, *c.leaf, c.box, points[j].p, values[j].upper);
        }
        // Along each axis move to the better side, if it is better than here; else come closer.
        const Climber before = c;
        float best = before.value;
        for (std::size_t axis = 0; axis < std::size_t(axes); ++axis) {
          const std::size_t k = 2 * axis + (r[2 * axis + 1] > r[2 * axis]);
          if (r[k] > best) best = r[k], c.at = moved(before, k);
          if (!(max(r[2 * axis], r[2 * axis + 1]) > before.value)) c.step[axis] *= 0.4f;
        }
        c.value = best;
      }
    });
  }
}

Climber start_at(Slab& slab, Leaf& leaf, const GridPlace& at, float value, float step, const Domain& domain) {
  Climber c{&slab, &leaf, box_of(leaf.cell, domain), {}, {step, step, step, step, step, step}, value};
  std::copy_n(at.known.begin(), slab.box.axes, c.at.begin());
  c.at[std::size_t(slab.box.axes)] = at.x, c.at[std::size_t(slab.box.axes) + 1] = at.y;
  return c;
}
GridPlace place_in(const Slab& slab, const Box& box, const Known& known, Vec2<float> p) {
  return {slab.box.share_of(known), (p.x - box.x0) / box.width, (p.y - box.y0) / box.height};
}
void raise(const Climber& c, float bound) {
  const Vec2<float> p = point_at(c, c.at);
  c.leaf->note(c.value * shape(*c.leaf, c.box, p), known_at(c, c.at), p);
  c.leaf->raise(bound);
}

}  // namespace

void maximise(std::vector<Slab>& slabs, const Survey& survey) {
  const Field& field = survey.field;
  if (!field.patches.empty()) return;  // bounds stand on all that leaves hold
  std::vector<Climber> climbers;
  for (Slab& slab : slabs) {
    for (std::size_t i = slab.attacked; i < slab.nodes.size(); ++i) {
      Node& node = slab.nodes[i];
      if (node.split != TreeSplit::leaf) continue;
      // From the largest ratios of the grid, and from the largest T seen by anyone.
      Leaf& leaf = node.leaf;
      const Box box = box_of(leaf.cell, field.domain);
      climbers.push_back(start_at(slab, leaf, grid_place(slab.views, leaf.peak), 0, 0.2f, field.domain));
      if (leaf.far_peak != leaf.peak)
        climbers.push_back(
            start_at(slab, leaf, grid_place(slab.views, leaf.far_peak), 0, 0.2f, field.domain));
      if (!(leaf.seen > 0)) continue;  // nobody saw anything: there is no place to start from
      climbers.push_back(start_at(slab, leaf, place_in(slab, box, leaf.seen_by, leaf.seen_at),
                                  leaf.seen / shape(leaf, box, leaf.seen_at), 0.1f, field.domain));
    }
    slab.attacked = slab.nodes.size();
  }
  climb(climbers, 7, survey);
  for (const Climber& c : climbers) raise(c, c.value * (1 + margin));
}

namespace {

// Random points of one leaf in a batch: its first and how many.
struct ProbedLeaf {
  std::uint32_t slab, node;
  std::size_t first, count;
};

// Draws count(slab, leaf) points uniformly in every leaf (counts of 0 leave it out), evaluates them in
// batches and hands each leaf its ratios T / (albedo q), of the upper or the mean of mirror images:
// visit(probed, points, ratios).
template <class Count, class Visit>
void probe_leaves(std::vector<Slab>& slabs, std::uint64_t seed, float FieldValue::*image,
                  const Survey& survey, Count&& count_of, Visit&& visit) {
  const Field& field = survey.field;
  constexpr std::size_t batch = std::size_t(1) << 20U;
  std::vector<FieldPoint> points;
  std::vector<FieldValue> values;
  std::vector<float> ratios;
  std::vector<ProbedLeaf> probed;
  std::size_t total = 0;
  const auto flush = [&] {
    points.resize(total), values.resize(total), ratios.resize(total);
    survey.host.parallel_for(probed.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const ProbedLeaf& p = probed[k];
        Pcg32 u(seed + p.slab, p.node);
        const Climber c = start_at(slabs[p.slab], slabs[p.slab].nodes[p.node].leaf, {}, 0, 0, field.domain);
        for (std::size_t i = p.first; i < p.first + p.count; ++i) {
          Place at{};
          for (int axis = 0; axis < c.axes(); ++axis) at[std::size_t(axis)] = to_unit_float(u());
          points[i] = point_of(c, at);
        }
      }
    });
    survey.eval(points, values);
    survey.host.parallel_for(probed.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Leaf& leaf = slabs[probed[k].slab].nodes[probed[k].node].leaf;
        const Box box = box_of(leaf.cell, field.domain);
        for (std::size_t i = probed[k].first; i < probed[k].first + probed[k].count; ++i) {
          const bool at_border = on_patch_border(field.patches, points[i].p);
          const float albedo = at_border ? 0 : normaliser(survey, points[i].viewer());
          ratios[i] = ratio_of(albedo, leaf, box, points[i].p, values[i].*image);
        }
      }
    });
    for (const ProbedLeaf& p : probed) visit(p, points, ratios);
    total = 0;
    probed.clear();
  };
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    for (const std::uint32_t i : leaves_in_order(slabs[s])) {
      const std::size_t count = count_of(slabs[s], i);
      if (count == 0) continue;
      probed.push_back({s, i, total, count});
      total += count;
      if (total >= batch) flush();
    }
  }
  flush();
}

}  // namespace

void probe(std::vector<Slab>& slabs, float per_leaf, std::uint64_t seed, float accepted,
           const Survey& survey) {
  const Field& field = survey.field;
  std::vector<double> found(slabs.size(), 0), mean_cost;
  for (const Slab& slab : slabs) {
    double total = 0;
    const std::vector<std::uint32_t> leaves = leaves_in_order(slab);
    for (const std::uint32_t i : leaves) total += double(slab.nodes[i].leaf.cost);
    mean_cost.push_back(total / double(leaves.size()));
  }
  std::vector<Climber> climbers;
  const auto count = [&](const Slab& slab, std::uint32_t i) {
    const auto s = std::size_t(&slab - slabs.data());
    if (slab.overshoot <= accepted) return std::size_t(0);
    const double fair = double(slab.nodes[i].leaf.cost) / mean_cost[s];
    return std::size_t(double(per_leaf) * (0.25 + 0.75 * fair)) + 1;
  };
  const auto visit = [&](const ProbedLeaf& t, const std::vector<FieldPoint>& points,
                         const std::vector<float>& ratios) {
    Slab& slab = slabs[t.slab];
    Leaf& leaf = slab.nodes[t.node].leaf;
    double excess = 0;
    float worst = leaf.height;
    std::size_t where = 0;
    for (std::size_t i = t.first; i < t.first + t.count; ++i) {
      if (ratios[i] > leaf.height) excess += double(ratios[i] - leaf.height);
      if (ratios[i] > worst) worst = ratios[i], where = i;
    }
    if (!(excess > 0)) return;
    if (survey.towers && worst > 8 * leaf.height) survey.towers->push_back(points[where]);
    found[t.slab] += double(area_share(leaf.cell)) * excess / double(t.count);
    const Box box = box_of(leaf.cell, field.domain);
    const GridPlace at = place_in(slab, box, known_of(points[where].viewer(), slab.box), points[where].p);
    climbers.push_back(start_at(slab, leaf, at, worst, 0.05f, field.domain));
  };
  probe_leaves(slabs, seed, &FieldValue::upper, survey, count, visit);
  climb(climbers, 6, survey);
  for (const Climber& c : climbers) raise(c, 2 * c.value - c.leaf->height + margin * c.value);
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    if (slabs[s].overshoot > accepted) slabs[s].overshoot = float(found[s]);
  }
}

void raise_at(std::vector<Slab>& slabs, std::span<const FieldPoint> points, const Survey& survey) {
  const Domain& domain = survey.field.domain;
  const KnownBox whole = survey.field.whole();
  const Partition partition = partition_of(slabs, survey.field.parameters);
  std::vector<FieldValue> values(points.size());
  survey.eval(points, values);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float albedo = survey.albedo_at(points[i].viewer());
    if (!(albedo > 0)) continue;
    Slab& slab = slabs[slab_index(partition, points[i].viewer(), whole)];
    Leaf& leaf = slab.nodes[leaf_at(slab, points[i].p, domain)].leaf;
    const float ratio = values[i].upper / albedo;
    leaf.note(ratio, known_of(points[i].viewer(), slab.box), points[i].p);
    leaf.raise((1 + margin) * ratio / shape(leaf, box_of(leaf.cell, domain), points[i].p));
  }
}

namespace {

// What uniform probes say of the weights of a slab's density h q. The three sums err alike, so that what they say
// together errs little.
struct Weighed {
  double density = 0, target = 0, square = 0;  // integrals of h q, of T / albedo, and of its square over h q
  double variance() const { return target > 0 ? density * square / sqr(target) - 1 : 0; }
};

}  // namespace

void probe_density(std::vector<Slab>& slabs, std::uint64_t seed, const Survey& survey) {
  const Field& field = survey.field;
  if (!field.patches.empty()) return;
  constexpr double doubtful = 1.5;  // more than the scatter of honest leaves
  // Twice as many where slabs spread over two angles of wo.
  const bool two_angles = !field.frame.isotropic();
  const std::size_t times = two_angles ? 2 : 1;
  // And no slab twice that has not grown.
  const auto is_known = [&](const Slab& slab) { return two_angles && slab.attacked == slab.nodes.size(); };
  const auto count = [&](const Slab& slab, std::uint32_t i) {
    if (is_known(slab)) return std::size_t(0);
    return times * std::size_t(64 + 8192 * area_share(slab.nodes[i].leaf.cell));
  };
  std::vector<Weighed> weighed(slabs.size());
  const auto visit = [&](const ProbedLeaf& t, const std::vector<FieldPoint>& points,
                         const std::vector<float>& ratios) {
    Leaf& leaf = slabs[t.slab].nodes[t.node].leaf;
    const Box box = box_of(leaf.cell, field.domain);
    double sum = 0, sum2 = 0;  // of T^2 / (albedo^2 q), whose mean is the square of the best share
    double shapes = 0, targets = 0;
    for (std::size_t i = t.first; i < t.first + t.count; ++i) {
      const float q = shape(leaf, box, points[i].p), v = ratios[i] * q;
      shapes += double(q), targets += double(v);
      const double square = double(ratios[i]) * double(v);
      sum += square, sum2 += square * square;
      if (v > leaf.seen) leaf.note(v, known_of(points[i].viewer(), slabs[t.slab].box), points[i].p);
    }
    const double n = double(t.count), square = sum / n;
    const double error = std::sqrt(max(sum2 / n - square * square, 0.) / n);
    const float area = area_share(leaf.cell);
    const double share = double(area) / n;
    weighed[t.slab].density += share * double(leaf.height) * shapes;
    weighed[t.slab].target += share * targets;
    weighed[t.slab].square += share * sum / double(leaf.height);
    const double believed = sqr(double(leaf.cost / area));
    if (square <= doubtful * believed || square - error <= believed) return;
    leaf.cost = area * float(std::sqrt(square));
    leaf.height = max(leaf.height, float(std::sqrt(square)));
    leaf.split_x = close_in_along_x(leaf);
  };
  std::vector<double> believed;
  for (const Slab& slab : slabs) believed.push_back(total_of(slab).variance());
  probe_leaves(slabs, seed, &FieldValue::mean, survey, count, visit);
  if (!two_angles || field.family) return;
  constexpr float most = 4;  // more is a lobe between the points, which the leaves know by now
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    if (is_known(slabs[s])) continue;
    slabs[s].attacked = slabs[s].nodes.size();
    if (is_grazing(slabs[s]) || !(believed[s] > 0)) continue;  // nothing is promised there
    slabs[s].shown = clamp(float(weighed[s].variance() / believed[s]), 1.f, most);
  }
}

}  // namespace reflectree::detail
