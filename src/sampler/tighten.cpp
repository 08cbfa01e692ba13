// SPDX-License-Identifier: Apache-2.0
#include "tighten.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/albedo.hpp"

namespace reflectree::detail {

namespace {

// What the climb may miss at a smooth summit: its last step spans 1/64 of the leaf.
constexpr float margin = 1e-3f;

struct Climber {
  Slab* slab;
  Leaf* leaf;
  Box box;
  float at[3];  // theta_o, x, y as shares of slab and leaf, in [0, 1]
  float step[3];
  float value;
};

FieldPoint point_of(const Climber& c, const float at[3]) {
  const float theta = lerp(at[0], c.slab->theta_lo, c.slab->theta_hi);
  return {clamp(cos(theta), min_cos_theta_o, 1.f),
          {c.box.x0 + c.box.width * at[1], c.box.y0 + c.box.height * at[2]}};
}

// T / (albedo q): what the leaf's bound must reach at p.
float ratio_of(const AlbedoTable& albedo, const Leaf& leaf, const Box& box, const FieldPoint& p,
               FieldValue v) {
  const float a = albedo_at(albedo, p.cos_theta_o);
  return a > 0 ? v.upper / (a * shape(leaf, box, p.p)) : 0.f;
}

// Coordinate steps up and down each axis, all climbers in one batch; steps shrink where none helps.
void climb(std::vector<Climber>& climbers, int rounds, const Field& field, const AlbedoTable& albedo,
           const Host& host, std::uint64_t* evaluations) {
  std::vector<FieldPoint> points(climbers.size() * 6);
  std::vector<FieldValue> values(points.size());
  const auto moved = [](const Climber& c, int k, float out[3]) {
    std::copy_n(c.at, 3, out);
    out[k / 2] = clamp(c.at[k / 2] + (k % 2 ? c.step[k / 2] : -c.step[k / 2]), 1e-5f, 1 - 1e-5f);
  };
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < climbers.size(); ++i) {
      for (int k = 0; k < 6; ++k) {
        float at[3];
        moved(climbers[i], k, at);
        points[i * 6 + std::size_t(k)] = point_of(climbers[i], at);
      }
    }
    eval_in_parallel(field, host, points, values);
    *evaluations += points.size();
    host.parallel_for(climbers.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Climber& c = climbers[i];
        float r[6];
        for (int k = 0; k < 6; ++k) {
          const std::size_t j = i * 6 + std::size_t(k);
          r[k] = ratio_of(albedo, *c.leaf, c.box, points[j], values[j]);
        }
        // Along each axis move to the better side, if it is better than here; else come closer.
        const Climber before = c;
        float best = before.value;
        for (int axis = 0; axis < 3; ++axis) {
          const int k = 2 * axis + (r[2 * axis + 1] > r[2 * axis]);
          if (r[k] > best) {
            best = r[k];
            std::copy_n(before.at, 3, c.at);
            float at[3];
            moved(before, k, at);
            std::copy_n(at, 3, c.at);
          }
          if (!(max(r[2 * axis], r[2 * axis + 1]) > before.value)) c.step[axis] *= 0.4f;
        }
        c.value = best;
      }
    });
  }
}

Climber start_at(Slab& slab, Leaf& leaf, const GridPlace& at, float value, float step, const Domain& domain) {
  return {&slab, &leaf, box_of(leaf.cell, domain), {at.theta, at.x, at.y}, {step, step, step}, value};
}
GridPlace place_in(const Slab& slab, const Box& box, float theta, Vec2<float> p) {
  return {(theta - slab.theta_lo) / (slab.theta_hi - slab.theta_lo), (p.x - box.x0) / box.width,
          (p.y - box.y0) / box.height};
}

void raise(const Climber& c, float share) {
  Leaf& leaf = *c.leaf;
  const Vec2<float> p{c.box.x0 + c.box.width * c.at[1], c.box.y0 + c.box.height * c.at[2]};
  const float seen = c.value * shape(leaf, c.box, p);
  if (seen > leaf.seen) {
    leaf.seen = seen, leaf.seen_at = p;
    leaf.seen_theta = lerp(c.at[0], c.slab->theta_lo, c.slab->theta_hi);
  }
  leaf.share = max(leaf.share, max(share, floor_share));
  leaf.cost = area_share(leaf.cell) * leaf.share;
}

}  // namespace

void maximise(std::vector<Slab>& slabs, const std::vector<std::size_t>& first_new, const Field& field,
              const AlbedoTable& albedo, const Host& host, std::uint64_t* evaluations) {
  std::vector<Climber> climbers;
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    for (std::size_t i = first_new[s]; i < slabs[s].nodes.size(); ++i) {
      Node& node = slabs[s].nodes[i];
      if (node.split != Split::leaf) continue;
      // From the largest ratio of the grid, and from the largest T seen by anyone.
      Leaf& leaf = node.leaf;
      const Box box = box_of(leaf.cell, field.domain);
      climbers.push_back(start_at(slabs[s], leaf, grid_place(leaf.peak), 0, 0.2f, field.domain));
      climbers.push_back(start_at(slabs[s], leaf, place_in(slabs[s], box, leaf.seen_theta, leaf.seen_at),
                                  leaf.seen / shape(leaf, box, leaf.seen_at), 0.1f, field.domain));
    }
  }
  climb(climbers, 7, field, albedo, host, evaluations);
  for (const Climber& c : climbers) raise(c, c.value * (1 + margin));
}

float probe(std::vector<Slab>& slabs, float per_leaf, std::uint64_t seed, const Field& field,
            const AlbedoTable& albedo, const Host& host, std::uint64_t* evaluations) {
  struct Target {
    std::uint32_t slab, node;
    std::size_t first, count;
  };
  constexpr std::size_t batch = std::size_t(1) << 20U;
  std::vector<double> overshoot(slabs.size(), 0);
  std::vector<FieldPoint> points;
  std::vector<FieldValue> values;
  std::vector<Target> targets;
  std::vector<Climber> climbers;
  const auto flush = [&] {
    values.resize(points.size());
    eval_in_parallel(field, host, points, values);
    *evaluations += points.size();
    for (const Target& t : targets) {
      Slab& slab = slabs[t.slab];
      Leaf& leaf = slab.nodes[t.node].leaf;
      const Box box = box_of(leaf.cell, field.domain);
      double excess = 0;
      float worst = leaf.share;
      std::size_t where = 0;
      for (std::size_t i = t.first; i < t.first + t.count; ++i) {
        const float r = ratio_of(albedo, leaf, box, points[i], values[i]);
        if (r > leaf.share) excess += double(r - leaf.share);
        if (r > worst) worst = r, where = i;
      }
      if (excess > 0) {
        overshoot[t.slab] += double(area_share(leaf.cell)) * excess / double(t.count);
        const GridPlace at = place_in(slab, box, acos(points[where].cos_theta_o), points[where].p);
        climbers.push_back(start_at(slab, leaf, at, worst, 0.05f, field.domain));
      }
    }
    points.clear(), targets.clear();
  };
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    Slab& slab = slabs[s];
    const std::vector<std::uint32_t> leaves = leaves_in_order(slab);
    double total = 0;
    for (const std::uint32_t i : leaves) total += double(slab.nodes[i].leaf.cost);
    for (const std::uint32_t i : leaves) {
      const Leaf& leaf = slab.nodes[i].leaf;
      const double fair = double(leaf.cost) / total * double(leaves.size());
      const auto count = std::size_t(double(per_leaf) * (0.25 + 0.75 * fair)) + 1;
      Pcg32 u(seed + s, i);
      const Climber c = start_at(slab, slab.nodes[i].leaf, {}, 0, 0, field.domain);
      targets.push_back({s, i, points.size(), count});
      for (std::size_t k = 0; k < count; ++k) {
        const float at[3] = {to_unit_float(u()), to_unit_float(u()), to_unit_float(u())};
        points.push_back(point_of(c, at));
      }
      if (points.size() >= batch) flush();
    }
  }
  flush();
  climb(climbers, 6, field, albedo, host, evaluations);
  for (const Climber& c : climbers) raise(c, 2 * c.value - c.leaf->share + margin * c.value);
  return float(*std::max_element(overshoot.begin(), overshoot.end()));
}

}  // namespace reflectree::detail
