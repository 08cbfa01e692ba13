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

// A landmark inside a leaf, at one of its slab's cosines.
struct Visit {
  std::size_t task;
  int theta;
};

// Evaluates the tasks in one batch and analyses each leaf.
void evaluate(std::vector<Slab>& slabs, const std::vector<Task>& tasks, const Field& field, const GrowthRules& rules,
              const Host& host, std::uint64_t* evaluations) {
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
    for (std::size_t k = 0; k < theta_nodes; ++k) {
      for (const Vec2<float>& p : slab.landmarks[k]) {
        if (!contains(box, p)) continue;
        visits.push_back({t, int(k)});
        points.push_back({slab.cos_theta_o[k], p});
      }
    }
  }
  std::vector<FieldValue> values(points.size());
  eval_in_parallel(field, host, points, values);
  *evaluations += points.size();
  const auto normalised = [&](const Slab& slab, std::size_t theta, std::size_t i) {
    const float a = slab.albedo[theta];
    return a > 0 ? FieldValue{values[i].mean / a, values[i].upper / a} : FieldValue{0, 0};
  };
  const auto note = [&](const Slab& slab, Leaf& leaf, std::size_t theta, std::size_t i, float value) {
    if (!(value > leaf.seen)) return;
    leaf.seen = value;
    leaf.seen_theta = lerp(0.5f * float(theta), slab.theta_lo, slab.theta_hi);
    leaf.seen_at = points[i].p;
  };
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const std::size_t i = tasks.size() * grid_points + v, theta = std::size_t(visits[v].theta);
    Slab& slab = slabs[tasks[visits[v].task].slab];
    note(slab, slab.nodes[tasks[visits[v].task].node].leaf, theta, i, normalised(slab, theta, i).upper);
  }
  host.parallel_for(tasks.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Slab& slab = slabs[tasks[t].slab];
      Leaf& leaf = slab.nodes[tasks[t].node].leaf;
      Grid grid;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const std::size_t theta = i / (grid_size * grid_size);
        grid[i] = normalised(slab, theta, t * grid_points + i);
        note(slab, leaf, theta, t * grid_points + i, grid[i].upper);
      }
      rules.analyse(leaf, grid);
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

// Where one point towers over the grid, the longer side closes in on it.
bool towers(const Leaf& leaf, float over) { return leaf.seen > 2 * over; }

bool may_split(Leaf& leaf) {
  if ((leaf.split_x ? leaf.cell.level_x : leaf.cell.level_y) < max_level) return true;
  leaf.split_x = !leaf.split_x;
  return (leaf.split_x ? leaf.cell.level_x : leaf.cell.level_y) < max_level;
}

}  // namespace

Slab make_slab(float theta_lo, float theta_hi, const AlbedoTable& table, const Domain& domain) {
  Slab slab{theta_lo, theta_hi, {}, {}, {}, {Node{}}};
  for (std::size_t k = 0; k < theta_nodes; ++k) {
    // Just inside the borders, where a neighbour's kink does not reach.
    const float t = k == 0 ? 1e-4f : k == 1 ? 0.5f : 1 - 1e-4f;
    slab.cos_theta_o[k] = max(cos(lerp(t, theta_lo, theta_hi)), min_cos_theta_o);
    slab.albedo[k] = albedo_at(table, slab.cos_theta_o[k]);
    for (int i = 0; i < landmark_count; ++i) slab.landmarks[k][std::size_t(i)] = landmark(domain, slab.cos_theta_o[k], i);
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
    evaluate(slabs, tasks, field, rules, host, evaluations);
    tasks.clear();
    std::vector<std::uint32_t> halved;
    bool busy = false;
    for (std::uint32_t s = 0; s < slabs.size(); ++s) {
      SlabState& state = states[s];
      if (!state.active) continue;
      Slab& slab = slabs[s];
      const float ideal = total(slab, &Leaf::ideal), cost = total(slab, &Leaf::cost);
      const bool met = cost <= rules.goal * ideal;
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
        split_node(slab, i, field.domain);
        const std::uint32_t child = slab.nodes[i].child;
        tasks.push_back({s, child});
        tasks.push_back({s, child + 1});
        ++state.leaves;
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

void analyse_exact(Leaf& leaf, const Grid& grid) {
  // Maxima of the whole leaf, of each theta, and of the halves along each axis.
  float by_theta[theta_nodes] = {}, half_x[2] = {}, half_y[2] = {};
  float mean = 0;
  for (int k = 0; k < theta_nodes; ++k) {
    for (int j = 0; j < grid_size; ++j) {
      for (int i = 0; i < grid_size; ++i) {
        const FieldValue v = grid[std::size_t((k * grid_size + j) * grid_size + i)];
        by_theta[k] = max(by_theta[k], v.upper);
        half_x[i >= grid_size / 2] = max(half_x[i >= grid_size / 2], v.upper);
        half_y[j >= grid_size / 2] = max(half_y[j >= grid_size / 2], v.upper);
        mean += theta_weights[k] * lobatto_weights[j] * lobatto_weights[i] * v.mean;
      }
    }
  }
  const float area = area_share(leaf.cell);
  float maximum = 0, mean_maximum = 0;
  for (int k = 0; k < theta_nodes; ++k) {
    maximum = max(maximum, by_theta[k]);
    mean_maximum += theta_weights[k] * by_theta[k];
  }
  leaf.ideal = area * mean;
  leaf.theta_cost = area * (maximum - mean_maximum);
  leaf.share = max(maximum, leaf.seen);
  leaf.cost = area * leaf.share;
  const float gain_x = abs(half_x[0] - half_x[1]), gain_y = abs(half_y[0] - half_y[1]);
  leaf.split_x = gain_x > gain_y || (gain_x == gain_y && leaf.cell.level_x <= leaf.cell.level_y);
  if (towers(leaf, maximum)) leaf.split_x = leaf.cell.level_x <= leaf.cell.level_y;
}

void analyse_one_shot(Leaf& leaf, const Grid& grid) {
  float m[grid_size][grid_size], s[grid_size][grid_size];  // mean and mean square over theta_o
  float mean = 0, mx = 0, my = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      m[j][i] = s[j][i] = 0;
      for (int k = 0; k < theta_nodes; ++k) {
        const FieldValue v = grid[std::size_t((k * grid_size + j) * grid_size + i)];
        m[j][i] += theta_weights[k] * v.mean;
        s[j][i] += theta_weights[k] * (sqr(v.mean) + sqr(v.upper - v.mean));
      }
      const float w = lobatto_weights[j] * lobatto_weights[i];
      mean += w * m[j][i];
      mx += w * m[j][i] * lobatto_nodes[i];
      my += w * m[j][i] * lobatto_nodes[j];
    }
  }
  // The best line through m has slope 3 E[m s] / E[m]; stored in 8 bits.
  const auto quantised = [mean](float moment) {
    const float slope = mean > 0 ? clamp(3 * moment / mean, -0.96875f, 0.96875f) : 0.f;
    return std::round(slope * 128) / 128;
  };
  leaf.slope_x = quantised(mx);
  leaf.slope_y = quantised(my);
  float square = 0, steady = 0, miss_x = 0, miss_y = 0;
  for (int j = 0; j < grid_size; ++j) {
    for (int i = 0; i < grid_size; ++i) {
      const float q = (1 + leaf.slope_x * lobatto_nodes[i]) * (1 + leaf.slope_y * lobatto_nodes[j]);
      const float w = lobatto_weights[j] * lobatto_weights[i];
      square += w * s[j][i] / q;
      steady += w * sqr(m[j][i]) / q;
    }
  }
  // What a line along x misses in each row, and along y in each column: the axis to split.
  for (int a = 0; a < grid_size; ++a) {
    float row = 0, row1 = 0, column = 0, column1 = 0;
    for (int b = 0; b < grid_size; ++b) {
      row += lobatto_weights[b] * m[a][b], row1 += 3 * lobatto_weights[b] * m[a][b] * lobatto_nodes[b];
      column += lobatto_weights[b] * m[b][a], column1 += 3 * lobatto_weights[b] * m[b][a] * lobatto_nodes[b];
    }
    for (int b = 0; b < grid_size; ++b) {
      const float w = lobatto_weights[a] * lobatto_weights[b];
      miss_x += w * sqr(m[a][b] - row - row1 * lobatto_nodes[b]);
      miss_y += w * sqr(m[b][a] - column - column1 * lobatto_nodes[b]);
    }
  }
  const float area = area_share(leaf.cell);
  leaf.share = sqrt(square);
  leaf.ideal = area * mean;
  leaf.cost = max(area * leaf.share, leaf.ideal);
  leaf.theta_cost = area * (sqrt(square) - sqrt(steady));
  leaf.split_x = miss_x > miss_y || (miss_x == miss_y && leaf.cell.level_x <= leaf.cell.level_y);
  // A needle between the points of the grid: pretend that it fills 1/16 of the leaf, until the grid sees it.
  float maximum = 0;
  for (const FieldValue& v : grid) maximum = max(maximum, v.upper);
  if (towers(leaf, maximum)) {
    leaf.cost = area * sqrt(square + sqr(leaf.seen) / 16);
    leaf.split_x = leaf.cell.level_x <= leaf.cell.level_y;
  }
}

}  // namespace reflectree::detail
