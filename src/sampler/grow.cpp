// SPDX-License-Identifier: Apache-2.0
#include "grow.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/sampler/albedo.hpp"

namespace reflectree::detail {

namespace {

struct Task {
  std::uint32_t slab, node;
};

struct SlabState {
  bool active = true;
  std::size_t leaves = 1;
  std::size_t next_check = 16;
};

void add_points(std::vector<FieldPoint>& points, const Slab& slab, const DyadicCell& cell,
                const Domain& domain) {
  const Box box = box_of(cell, domain);
  for (int k = 0; k < theta_nodes; ++k) {
    for (int j = 0; j < grid_size; ++j) {
      for (int i = 0; i < grid_size; ++i) {
        points.push_back({slab.cos_theta_o[std::size_t(k)],
                          {box.x0 + box.width * 0.5f * (1 + lobatto_nodes[i]),
                           box.y0 + box.height * 0.5f * (1 + lobatto_nodes[j])}});
      }
    }
  }
}

// A point inside a leaf beside its grid.
struct Visit {
  std::size_t task;
  Slab::Landmark at;
};

// A lobe about the pole may be narrower than the grid of a leaf that touches it: look at every octave of the
// radius below the leaf.
void add_octaves(std::vector<Visit>& visits, std::size_t task, const Slab& slab, const Box& box) {
  constexpr int octaves = 9;
  const bool above = box.y0 == 0, below = box.y0 + box.height == 0;
  if (!above && !below) return;
  for (std::size_t k = 0; k < theta_nodes; ++k) {
    for (int octave = 1; octave <= octaves; ++octave) {
      for (const float node : lobatto_nodes) {
        const float y = std::ldexp(box.height, -octave);
        const Vec2<float> p{box.x0 + 0.5f * box.width * (1 + node), above ? y : -y};
        const float theta = lerp(0.5f * float(k), slab.theta_lo, slab.theta_hi);
        visits.push_back({task, {{slab.cos_theta_o[k], p}, slab.albedo[k], theta, 0}});
      }
    }
  }
}

// Evaluates the tasks in one batch and analyses each leaf.
void evaluate(std::vector<Slab>& slabs, const std::vector<Task>& tasks, const Field& field,
              const GrowthRules& rules, const Host& host, std::uint64_t* evaluations) {
  std::vector<FieldPoint> points;
  points.reserve(tasks.size() * grid_points);
  for (const Task& task : tasks) {
    const Slab& slab = slabs[task.slab];
    add_points(points, slab, slab.nodes[task.node].leaf.cell, field.domain);
  }
  std::vector<Visit> visits;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const Slab& slab = slabs[tasks[t].slab];
    const Box box = box_of(slab.nodes[tasks[t].node].leaf.cell, field.domain);
    for (const Slab::Landmark& landmark : slab.landmarks) {
      if (!contains(box, landmark.point.p)) continue;
      visits.push_back({t, landmark});
    }
    add_octaves(visits, t, slab, box);
  }
  for (const Visit& visit : visits) points.push_back(visit.at.point);
  std::vector<FieldValue> values(points.size());
  eval_in_parallel(field, host, points, values);
  *evaluations += points.size();
  const auto normalised = [&](const Slab& slab, std::size_t theta, std::size_t i) {
    const float a = slab.albedo[theta];
    return a > 0 ? FieldValue{values[i].mean / a, values[i].upper / a} : FieldValue{0, 0};
  };
  const auto note = [&](Leaf& leaf, float theta, std::size_t i, float value) {
    if (value > leaf.seen) leaf.seen = value, leaf.seen_theta = theta, leaf.seen_at = points[i].p;
  };
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const Slab::Landmark& landmark = visits[v].at;
    const Task& task = tasks[visits[v].task];
    const std::size_t i = tasks.size() * grid_points + v;
    Leaf& leaf = slabs[task.slab].nodes[task.node].leaf;
    const Box box = box_of(leaf.cell, field.domain);
    leaf.crossed = leaf.crossed || landmark.travel > max(box.width, box.height);
    if (landmark.albedo > 0) note(leaf, landmark.theta, i, values[i].upper / landmark.albedo);
  }
  host.parallel_for(tasks.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Slab& slab = slabs[tasks[t].slab];
      Leaf& leaf = slab.nodes[tasks[t].node].leaf;
      Grid grid;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const std::size_t theta = i / (grid_size * grid_size);
        grid[i] = normalised(slab, theta, t * grid_points + i);
        note(leaf, lerp(0.5f * float(theta), slab.theta_lo, slab.theta_hi), t * grid_points + i,
             grid[i].upper);
      }
      rules.analyse(leaf, grid);
      if (rules.bounds) {
        const Box box = box_of(leaf.cell, field.domain);
        const float share = max(leaf.share, leaf.seen / shape(leaf, box, leaf.seen_at));
        if (leaf.crossed) leaf.theta_cost += area_share(leaf.cell) * (share - leaf.share);
        leaf.share = share;
        leaf.cost = area_share(leaf.cell) * share;
      }
    }
  });
}

float total(const Slab& slab, float Leaf::*member) {
  double sum = 0;
  for (const Node& node : slab.nodes) {
    if (node.split == Split::leaf) sum += double(node.leaf.*member);
  }
  return float(sum);
}

// The mass that the tree should see: 1, less the part of the slab that has no albedo.
float expected_mass(const Slab& slab) {
  float mass = 0;
  for (std::size_t k = 0; k < theta_nodes; ++k) mass += slab.albedo[k] > 0 ? theta_weights[k] : 0.f;
  return mass;
}

constexpr int coarse_levels = 12;  // of both axes together, down to which a missed lobe is looked for

// The leaves of the fewest levels, to be halved along their longer sides; none below coarse_levels.
std::vector<std::uint32_t> coarsest_leaves(Slab& slab) {
  std::vector<std::uint32_t> leaves;
  int fewest = coarse_levels;
  const auto levels = [](const Node& node) { return node.leaf.cell.level_x + node.leaf.cell.level_y; };
  for (const Node& node : slab.nodes) {
    if (node.split == Split::leaf) fewest = std::min(fewest, levels(node));
  }
  if (fewest == coarse_levels) return leaves;
  for (std::uint32_t i = 0; i < slab.nodes.size(); ++i) {
    Node& node = slab.nodes[i];
    if (node.split != Split::leaf || levels(node) > fewest) continue;
    node.leaf.split_x = node.leaf.cell.level_x <= node.leaf.cell.level_y;
    leaves.push_back(i);
  }
  return leaves;
}

void split_node(Slab& slab, std::uint32_t index, const Domain& domain) {
  const auto child = std::uint32_t(slab.nodes.size());
  Leaf leaf = slab.nodes[index].leaf;
  slab.nodes[index].split = leaf.split_x ? Split::x : Split::y;
  slab.nodes[index].child = child;
  DyadicCell& cell = leaf.cell;
  ++(leaf.split_x ? cell.level_x : cell.level_y);
  std::uint32_t& position = leaf.split_x ? cell.ix : cell.iy;
  position *= 2;
  for (int half = 0; half < 2; ++half, ++position) {
    Leaf inherited;
    inherited.cell = cell;
    if (contains(box_of(cell, domain), leaf.seen_at)) {
      inherited.seen = leaf.seen, inherited.seen_theta = leaf.seen_theta, inherited.seen_at = leaf.seen_at;
    }
    slab.nodes.push_back({Split::leaf, 0, inherited});
  }
}

// Where one point towers over the grid, the cut closes in on it.
bool towers(const Leaf& leaf, float over) { return leaf.seen > 2 * over; }
bool may_split(Leaf& leaf) {
  if ((leaf.split_x ? leaf.cell.level_x : leaf.cell.level_y) < max_level) return true;
  leaf.split_x = !leaf.split_x;
  return (leaf.split_x ? leaf.cell.level_x : leaf.cell.level_y) < max_level;
}

}  // namespace

bool close_in_along_x(const Leaf& leaf) {
  if (abs(leaf.seen_at.y) < 0.3f / float(1U << leaf.cell.level_y)) return false;
  return leaf.cell.level_x <= leaf.cell.level_y;
}

Slab make_slab(float theta_lo, float theta_hi, const AlbedoTable& table, const Domain& domain) {
  constexpr int landmark_steps = 12;
  Slab slab{theta_lo, theta_hi, {}, {}, {}, {Node{}}};
  // Just inside the borders, where a neighbour's kink does not reach.
  const auto cosine_at = [&](float t) {
    return clamp(cos(lerp(clamp(t, 1e-4f, 1 - 1e-4f), theta_lo, theta_hi)), min_cos_theta_o, 1.f);
  };
  for (std::size_t k = 0; k < theta_nodes; ++k) {
    slab.cos_theta_o[k] = cosine_at(0.5f * float(k));
    slab.albedo[k] = albedo_at(table, slab.cos_theta_o[k]);
  }
  float travel[landmark_count];
  for (int i = 0; i < landmark_count; ++i) {
    const Vec2<float> a = landmark(domain, cosine_at(0), i), b = landmark(domain, cosine_at(1), i);
    travel[i] = max(abs(a.x - b.x), abs(a.y - b.y));
  }
  for (int step = 0; step <= landmark_steps; ++step) {
    const float t = float(step) / landmark_steps, c = cosine_at(t);
    for (int i = 0; i < landmark_count; ++i) {
      slab.landmarks.push_back(
          {{c, landmark(domain, c, i)}, albedo_at(table, c), lerp(t, theta_lo, theta_hi), travel[i]});
    }
  }
  return slab;
}

std::vector<std::uint32_t> leaves_in_order(const Slab& slab) {
  std::vector<std::uint32_t> order, stack{0};
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    const Node& node = slab.nodes[i];
    if (node.split == Split::leaf) {
      order.push_back(i);
    } else {
      stack.push_back(node.child + 1);
      stack.push_back(node.child);
    }
  }
  return order;
}

void grow(std::vector<Slab>& slabs, const Field& field, const AlbedoTable& albedo, const GrowthRules& rules,
          const Host& host, std::uint64_t* evaluations) {
  constexpr float narrowest_slab = 1e-5f;  // radians
  const float budget = rules.goal - 1;
  std::vector<SlabState> states(slabs.size());
  std::vector<Task> tasks;
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    if (slabs[s].nodes.size() == 1) tasks.push_back({s, 0});
    states[s].leaves = leaves_in_order(slabs[s]).size();
  }
  while (true) {
    host.progress(rules.progress);
    evaluate(slabs, tasks, field, rules, host, evaluations);
    tasks.clear();
    std::vector<std::uint32_t> halved;
    bool busy = false;
    for (std::uint32_t s = 0; s < slabs.size(); ++s) {
      SlabState& state = states[s];
      if (!state.active) continue;
      Slab& slab = slabs[s];
      const float ideal = total(slab, &Leaf::ideal), cost = total(slab, &Leaf::cost);
      std::vector<std::uint32_t> blind;
      const bool fits = cost <= rules.goal * ideal;
      const float allowed = max(rules.mass_error, 0.1f * budget) + 2 * albedo.relative_error;
      if (fits && abs(ideal - expected_mass(slab)) > allowed) blind = coarsest_leaves(slab);
      const bool met = fits && blind.empty();
      if (rules.split_slabs && (met || state.leaves >= state.next_check) &&
          slab.theta_hi - slab.theta_lo > narrowest_slab) {
        state.next_check = state.leaves * 3 / 2;
        if (total(slab, &Leaf::theta_cost) > rules.theta_share * max(budget * ideal, cost - ideal)) {
          halved.push_back(s);
          busy = true;
          continue;
        }
      }
      if (met || state.leaves >= rules.max_leaves) {
        state.active = false;
        continue;
      }
      const auto split = [&](std::uint32_t i) {
        split_node(slab, i, field.domain);
        const std::uint32_t child = slab.nodes[i].child;
        tasks.push_back({s, child});
        tasks.push_back({s, child + 1});
        ++state.leaves;
      };
      if (!blind.empty()) {
        for (const std::uint32_t i : blind) split(i);
        busy = true;
        continue;
      }
      // Split the leaves of largest excess until the gain that they promise covers the surplus.
      std::vector<std::uint32_t> order;
      float worst = 0;
      for (std::uint32_t i = 0; i < slab.nodes.size(); ++i) {
        const Node& node = slab.nodes[i];
        if (node.split != Split::leaf) continue;
        order.push_back(i);
        worst = max(worst, node.leaf.cost - node.leaf.ideal);
      }
      const auto excess = [&](std::uint32_t i) { return slab.nodes[i].leaf.cost - slab.nodes[i].leaf.ideal; };
      std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return excess(a) != excess(b) ? excess(a) > excess(b) : a < b;
      });
      const float fair = 1.5f * budget * ideal / float(state.leaves);  // equal shares are the optimum
      float surplus = cost - rules.goal * ideal;
      bool any = false;
      for (const std::uint32_t i : order) {
        const float e = excess(i);
        if (surplus <= 0 || (any && e < min(fair, 0.5f * worst)) || state.leaves >= rules.max_leaves) break;
        if (!may_split(slab.nodes[i].leaf)) continue;
        split(i);
        surplus -= 0.5f * e;
        any = true;
      }
      if (!any) state.active = false;
      busy = busy || any;
    }
    if (!halved.empty()) {
      // Replace each halved slab by two fresh ones; the tasks already gathered move with their slabs.
      std::vector<Slab> next;
      std::vector<SlabState> next_states;
      std::vector<std::uint32_t> moved(slabs.size());
      std::vector<Task> fresh;
      std::size_t h = 0;
      for (std::uint32_t s = 0; s < slabs.size(); ++s) {
        moved[s] = std::uint32_t(next.size());
        if (h < halved.size() && halved[h] == s) {
          ++h;
          const float mid = 0.5f * (slabs[s].theta_lo + slabs[s].theta_hi);
          for (const auto& [lo, hi] :
               {std::pair{slabs[s].theta_lo, mid}, std::pair{mid, slabs[s].theta_hi}}) {
            fresh.push_back({std::uint32_t(next.size()), 0});
            next.push_back(make_slab(lo, hi, albedo, field.domain));
            next_states.push_back({});
          }
        } else {
          next.push_back(std::move(slabs[s]));
          next_states.push_back(states[s]);
        }
      }
      for (Task& task : tasks) task.slab = moved[task.slab];
      tasks.insert(tasks.end(), fresh.begin(), fresh.end());
      slabs = std::move(next);
      states = std::move(next_states);
    }
    if (!busy) return;
  }
}

namespace {

using Values = float[grid_size][grid_size];  // [y][x]

// Mean and slopes of the best line along each axis: 3 E[v s] / E[v], in 1/128 as stored.
struct Fit {
  float mean, slope_x, slope_y;
};
Fit fit(const Values& v) {
  float mean = 0, mx = 0, my = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      const float w = lobatto_weights[j] * lobatto_weights[i] * v[j][i];
      mean += w;
      mx += w * lobatto_nodes[i];
      my += w * lobatto_nodes[j];
    }
  }
  const auto stored = [mean](float moment) {
    return mean > 0 ? std::round(clamp(3 * moment / mean, -0.96875f, 0.96875f) * 128) / 128 : 0.f;
  };
  return {mean, stored(mx), stored(my)};
}

// Whether lines along x miss the rows by more than lines along y miss the columns: the axis to split.
bool rows_are_rougher(const Values& v, const DyadicCell& cell) {
  float miss_x = 0, miss_y = 0;
  for (int a = 0; a < grid_size; ++a) {
    float row = 0, row1 = 0, column = 0, column1 = 0;
    for (int b = 0; b < grid_size; ++b) {
      const float w = lobatto_weights[b];
      row += w * v[a][b], row1 += 3 * w * v[a][b] * lobatto_nodes[b];
      column += w * v[b][a], column1 += 3 * w * v[b][a] * lobatto_nodes[b];
    }
    for (int b = 0; b < grid_size; ++b) {
      const float w = lobatto_weights[a] * lobatto_weights[b];
      miss_x += w * sqr(v[a][b] - row - row1 * lobatto_nodes[b]);
      miss_y += w * sqr(v[b][a] - column - column1 * lobatto_nodes[b]);
    }
  }
  return miss_x > miss_y || (miss_x == miss_y && cell.level_x <= cell.level_y);
}

float grid_shape(float slope_x, float slope_y, int j, int i) {
  return (1 + slope_x * lobatto_nodes[i]) * (1 + slope_y * lobatto_nodes[j]);
}

}  // namespace

void analyse_exact(Leaf& leaf, const Grid& grid) {
  const auto upper = [&](int k, int j, int i) {
    return grid[std::size_t((k * grid_size + j) * grid_size + i)].upper;
  };
  Values envelope;
  float mean = 0, highest = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      envelope[j][i] = 0;
      for (int k = 0; k < theta_nodes; ++k) {
        envelope[j][i] = max(envelope[j][i], upper(k, j, i));
        mean += theta_weights[k] * lobatto_weights[j] * lobatto_weights[i] *
                grid[std::size_t((k * grid_size + j) * grid_size + i)].mean;
      }
      highest = max(highest, envelope[j][i]);
    }
  }
  // Of a few shapes, the one that the envelope needs to be raised least: the best lines, milder ones, flat.
  const Fit line = fit(envelope);
  leaf.share = 1e30f;
  for (const float part_x : {0.f, 0.75f, 1.f}) {
    for (const float part_y : {0.f, 0.75f, 1.f}) {
      const float gx = std::round(part_x * line.slope_x * 128) / 128,
                  gy = std::round(part_y * line.slope_y * 128) / 128;
      float bound = 0;
      for (int j = 0; j < grid_size; ++j) {
        for (int i = 0; i < grid_size; ++i) bound = max(bound, envelope[j][i] / grid_shape(gx, gy, j, i));
      }
      if (bound < leaf.share) leaf.share = bound, leaf.slope_x = gx, leaf.slope_y = gy;
    }
  }
  float steady = 0, peak = -1;
  for (int k = 0; k < theta_nodes; ++k) {
    float bound = 0;
    for (int j = 0; j < grid_size; ++j) {
      for (int i = 0; i < grid_size; ++i) {
        const float ratio = upper(k, j, i) / grid_shape(leaf.slope_x, leaf.slope_y, j, i);
        bound = max(bound, ratio);
        if (ratio > peak) peak = ratio, leaf.peak = std::uint8_t((k * grid_size + j) * grid_size + i);
      }
    }
    steady += theta_weights[k] * bound;
  }
  const float area = area_share(leaf.cell);
  leaf.ideal = area * mean;
  leaf.theta_cost = area * (leaf.share - steady);
  leaf.split_x = rows_are_rougher(envelope, leaf.cell);
  if (towers(leaf, highest)) leaf.split_x = close_in_along_x(leaf);
  leaf.share = max(leaf.share, floor_share);
  leaf.cost = area * leaf.share;
}

void analyse_one_shot(Leaf& leaf, const Grid& grid) {
  Values m, s, d;  // over theta_o: mean, mean square, and that of the difference to the mirror image
  float highest = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      m[j][i] = s[j][i] = d[j][i] = 0;
      for (int k = 0; k < theta_nodes; ++k) {
        const FieldValue v = grid[std::size_t((k * grid_size + j) * grid_size + i)];
        m[j][i] += theta_weights[k] * v.mean;
        s[j][i] += theta_weights[k] * sqr(v.mean);
        d[j][i] += theta_weights[k] * sqr(v.upper - v.mean);
        highest = max(highest, v.upper);
      }
    }
  }
  const Fit line = fit(m);
  leaf.slope_x = line.slope_x, leaf.slope_y = line.slope_y;
  float square = 0, steady = 0, difference = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      const float w = lobatto_weights[j] * lobatto_weights[i] / grid_shape(leaf.slope_x, leaf.slope_y, j, i);
      square += w * s[j][i];
      steady += w * sqr(m[j][i]);
      difference += w * d[j][i];
    }
  }
  const float area = area_share(leaf.cell);
  // What mirror images differ by belongs to the best density, but no splitting saves it: it is no cost.
  leaf.share = max(sqrt(square + difference), floor_share);
  leaf.ideal = area * line.mean;
  leaf.cost = max(area * sqrt(square), leaf.ideal);
  leaf.theta_cost = area * (sqrt(square) - sqrt(steady));
  leaf.split_x = rows_are_rougher(m, leaf.cell);
  // A needle between the points of the grid: pretend that it fills 1/16 of the leaf, until the grid sees it.
  if (towers(leaf, highest)) {
    const float cost = area * sqrt(square + sqr(leaf.seen) / 16);
    if (leaf.crossed) leaf.theta_cost += cost - leaf.cost;
    leaf.cost = cost;
    leaf.split_x = close_in_along_x(leaf);
  }
}

GridPlace grid_place(std::size_t index) {
  const std::size_t i = index % grid_size, j = index / grid_size % grid_size,
                    k = index / (grid_size * grid_size);
  return {0.5f * float(k), 0.5f * (1 + lobatto_nodes[i]), 0.5f * (1 + lobatto_nodes[j])};
}

float shape(const Leaf& leaf, const Box& box, Vec2<float> p) {
  const float s = clamp(2 * (p.x - box.x0) / box.width - 1, -1.f, 1.f);
  const float t = clamp(2 * (p.y - box.y0) / box.height - 1, -1.f, 1.f);
  return (1 + leaf.slope_x * s) * (1 + leaf.slope_y * t);
}

}  // namespace reflectree::detail
