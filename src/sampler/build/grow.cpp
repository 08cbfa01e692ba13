// SPDX-License-Identifier: Apache-2.0
#include "grow.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reflectree::detail {

namespace {

struct Task {
  std::uint32_t slab, node;
};

struct SlabState {
  bool active = true;
  float dear = 1;  // how many times the leaves of others it may have where the budget ends
  std::size_t leaves = 1;
  std::size_t next_check = 16;
  std::size_t most = 0;
};

// The grid of a cell, for all views.
void put_points(std::span<FieldPoint> points, const Slab& slab, const DyadicCell& cell,
                const Domain& domain) {
  const Box box = box_of(cell, domain);
  std::size_t at = 0;
  for (const View& view : slab.views) {
    for (int j = 0; j < grid_size; ++j) {
      for (int i = 0; i < grid_size; ++i) {
        points[at++] = field_point(view.viewer, {box.x0 + box.width * 0.5f * (1 + lobatto_nodes[i]),
                                                 box.y0 + box.height * 0.5f * (1 + lobatto_nodes[j])});
      }
    }
  }
}

// A point inside a leaf beside its grid.
struct Visit {
  std::size_t task;
  Slab::Mark at;
};

// A lobe about the pole may be narrower than the grid of a leaf that touches it: look at every octave of the
// radius below the leaf.
void add_octaves(std::vector<Visit>& visits, std::size_t task, const Slab& slab, const Box& box) {
  constexpr int octaves = 9;
  const bool above = box.y0 == 0, below = box.y0 + box.height == 0;
  if (!above && !below) return;
  for (const View& view : slab.views) {
    for (int octave = 1; octave <= octaves; ++octave) {
      for (const float node : lobatto_nodes) {
        const float y = std::ldexp(box.height, -octave);
        const Vec2<float> p{box.x0 + 0.5f * box.width * (1 + node), above ? y : -y};
        visits.push_back({task, {field_point(view.viewer, p), view.albedo, view.known, {}}});
      }
    }
  }
}

// Evaluates the tasks in one batch and analyses each leaf.
void evaluate(std::vector<Slab>& slabs, const std::vector<Task>& tasks, const Survey& survey,
              const GrowthRules& rules) {
  const Field& field = survey.field;
  if (!field.patches.empty()) {
    survey.host.parallel_for(tasks.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        Slab& slab = slabs[tasks[t].slab];
        analyse_patches(slab.nodes[tasks[t].node].leaf, slab, field, rules.bounds);
      }
    });
    return;
  }
  std::vector<std::size_t> first;  // of each task's grid
  std::size_t first_visit = 0;
  for (const Task& task : tasks)
    first.push_back(first_visit), first_visit += slabs[task.slab].views.size() * grid_points;
  std::vector<Visit> visits;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const Slab& slab = slabs[tasks[t].slab];
    const Box box = box_of(slab.nodes[tasks[t].node].leaf.cell, field.domain);
    for (const Slab::Mark& landmark : slab.marks) {
      if (!contains(box, landmark.point.p)) continue;
      visits.push_back({t, landmark});
    }
    add_octaves(visits, t, slab, box);
  }
  std::vector<FieldPoint> points(first_visit + visits.size());
  survey.host.parallel_for(tasks.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Slab& slab = slabs[tasks[t].slab];
      put_points(std::span(points).subspan(first[t], slab.views.size() * grid_points), slab,
                 slab.nodes[tasks[t].node].leaf.cell, field.domain);
    }
  });
  for (std::size_t v = 0; v < visits.size(); ++v) points[first_visit + v] = visits[v].at.point;
  std::vector<FieldValue> values(points.size());
  survey.eval(points, values);
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const Slab::Mark& landmark = visits[v].at;
    const Task& task = tasks[visits[v].task];
    const std::size_t i = first_visit + v;
    Leaf& leaf = slabs[task.slab].nodes[task.node].leaf;
    const Box box = box_of(leaf.cell, field.domain);
    for (std::size_t a = 0; a < landmark.travel.size(); ++a)
      leaf.crossed[a] = leaf.crossed[a] || landmark.travel[a] > max(box.width, box.height);
    if (landmark.albedo > 0) leaf.note(values[i].upper / landmark.albedo, landmark.known, points[i].p);
  }
  survey.host.parallel_for(tasks.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<FieldValue> grid;
    for (std::size_t t = begin; t < end; ++t) {
      Slab& slab = slabs[tasks[t].slab];
      Leaf& leaf = slab.nodes[tasks[t].node].leaf;
      grid.assign(slab.views.size() * grid_points, {0, 0});
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const View& view = slab.views[i / grid_points];
        const FieldValue& v = values[first[t] + i];
        if (view.albedo > 0) grid[i] = {v.mean / view.albedo, v.upper / view.albedo};
        leaf.note(grid[i].upper, view.known, points[first[t] + i].p);
      }
      rules.analyse(leaf, grid, slab.views);
      if (rules.bounds) {
        const Box box = box_of(leaf.cell, field.domain);
        const float before = leaf.height;
        leaf.raise(leaf.seen / shape(leaf, box, leaf.seen_at));
        leaf.blame_crossing(area_share(leaf.cell) * (leaf.height - before));
      }
    }
  });
}

// The mass that the tree should see: 1, less the part of the slab that has no albedo.
float expected_mass(const Slab& slab) {
  float mass = 0;
  for (const View& view : slab.views) mass += view.albedo > 0 ? view.weight : 0.f;
  return mass;
}

constexpr int coarse_levels = 12;  // of both axes together, down to which a missed lobe is looked for

// The leaves of the fewest levels, to be halved along their longer sides; none below coarse_levels.
std::vector<std::uint32_t> coarsest_leaves(Slab& slab) {
  std::vector<std::uint32_t> leaves;
  int fewest = coarse_levels;
  const auto levels = [](const Node& node) { return node.leaf.cell.level_x + node.leaf.cell.level_y; };
  for (const Node& node : slab.nodes) {
    if (node.split == TreeSplit::leaf) fewest = std::min(fewest, levels(node));
  }
  if (fewest == coarse_levels) return leaves;
  for (std::uint32_t i = 0; i < slab.nodes.size(); ++i) {
    Node& node = slab.nodes[i];
    if (node.split != TreeSplit::leaf || levels(node) > fewest) continue;
    node.leaf.split_x = node.leaf.cell.level_x <= node.leaf.cell.level_y;
    leaves.push_back(i);
  }
  return leaves;
}

// Cuts along the other axis would not help a leaf that is as small as can be along the one that matters.
bool may_split(const Leaf& leaf) {
  return (leaf.split_x ? leaf.cell.level_x : leaf.cell.level_y) < max_level;
}

// The leaves of largest excess, until the gain that they promise covers the surplus of cost.
std::vector<std::uint32_t> dearest_leaves(Slab& slab, const GrowthRules& rules, float surplus, float fair) {
  std::vector<std::uint32_t> order, chosen;
  const auto excess = [&](std::uint32_t i) { return slab.nodes[i].leaf.cost - slab.nodes[i].leaf.ideal; };
  float worst = 0;
  std::size_t leaves = 0;
  for (std::uint32_t i = 0; i < slab.nodes.size(); ++i) {
    if (slab.nodes[i].split != TreeSplit::leaf) continue;
    ++leaves;
    if (!may_split(slab.nodes[i].leaf)) continue;
    order.push_back(i);
    worst = max(worst, excess(i));
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return excess(a) != excess(b) ? excess(a) > excess(b) : a < b;
  });
  for (const std::uint32_t i : order) {
    const float e = excess(i);
    const bool enough = surplus <= 0 || (!chosen.empty() && e < min(fair, 0.5f * worst));
    if (enough || leaves + chosen.size() >= rules.max_leaves) break;
    chosen.push_back(i);
    surplus -= 0.5f * e;
  }
  return chosen;
}

// What a slab needs next: to be halved along a known coordinate, or leaves to be split; nothing when done.
struct Step {
  int halve = -1;
  std::vector<std::uint32_t> split;
};
Step next_step(Slab& slab, SlabState& state, const GrowthRules& rules, bool may_halve, float albedo_error) {
  constexpr float narrowest[known_slots] = {1e-5f, 1e-3f, 1e-3f, 1e-3f};  // slabs; radians for the viewer
  // With n known and two unknown coordinates equal shares are the optimum: n / (n + 2) of the trials left.
  constexpr float dearer[known_slots] = {1, 1.5f, 1.8f, 2};
  if (!state.active) return {};
  const float goal = rules.goal_of(slab), budget = goal - 1;
  const float ideal = total(slab, &Leaf::ideal), cost = total(slab, &Leaf::cost);
  const bool nothing = cost <= 1.001f * floor_share;  // f is 0 in the slab
  const float allowed_cost =
      rules.of_all_mass ? ideal + budget * max(ideal, expected_mass(slab)) : goal * ideal;
  const bool fits = nothing || cost <= allowed_cost;
  // A stated error is far above the true one: a large one must not hide a lobe that no grid has seen.
  const float allowed = max(rules.mass_error, 0.1f * budget) + 2 * min(albedo_error, 0.01f);
  std::vector<std::uint32_t> blind;
  if (fits && abs(ideal - expected_mass(slab)) > allowed) blind = coarsest_leaves(slab);
  const bool met = fits && blind.empty();
  const bool uneven = met && !nothing && rules.worst_view > 0 && !is_grazing(slab) &&
                      worst_view(slab) > double(rules.worst_view);
  if (may_halve && (met || state.leaves >= state.next_check)) {
    // What all known coordinates cost together, and the one that costs most.
    int dearest = -1;
    float most = 0, all = 0;
    for (int axis = 0; axis < slab.box.axes; ++axis) {
      const float saved = total_known_cost(slab, axis);
      if (!(slab.box.width(axis) > narrowest[slab.box.slot[std::size_t(axis)]])) continue;
      all += saved;
      if (dearest < 0 || saved > most) dearest = axis, most = saved;
    }
    if (dearest >= 0) state.next_check = state.leaves * 3 / 2;
    if (dearest >= 0 &&
        (uneven || all > dearer[slab.box.axes - 1] * rules.known_share * max(budget * ideal, cost - ideal)))
      return {dearest, {}};
  }
  if (met || state.leaves >= state.most) return {};
  if (!blind.empty()) return {-1, blind};
  const float fair = 1.5f * budget * ideal / float(state.leaves);  // equal shares are the optimum
  return {-1, dearest_leaves(slab, rules, cost - allowed_cost, fair)};
}

// Replaces each halved slab by two fresh ones; the tasks already gathered move with their slabs.
struct Halved {
  std::uint32_t slab;
  int axis;
};
void halve(std::vector<Slab>& slabs, std::vector<SlabState>& states, std::vector<Task>& tasks,
           const std::vector<Halved>& halved, const Survey& survey, const GrowthRules& rules) {
  std::vector<Slab> next;
  std::vector<SlabState> next_states;
  std::vector<std::uint32_t> moved(slabs.size());
  std::vector<Task> fresh;
  std::size_t h = 0;
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    moved[s] = std::uint32_t(next.size());
    if (h == halved.size() || halved[h].slab != s) {
      next.push_back(std::move(slabs[s]));
      next_states.push_back(states[s]);
      continue;
    }
    const auto axis = std::size_t(slabs[s].box.slot[std::size_t(halved[h++].axis)]);
    KnownBox lower = slabs[s].box, upper = lower;
    lower.hi[axis] = upper.lo[axis] = 0.5f * (lower.lo[axis] + lower.hi[axis]);
    for (const KnownBox& box : {lower, upper}) {
      fresh.push_back({std::uint32_t(next.size()), 0});
      next.push_back(make_slab(box, survey.albedo, survey.field));
      next_states.push_back({});
      next_states.back().most = rules.max_leaves;
    }
  }
  for (Task& task : tasks) task.slab = moved[task.slab];
  tasks.insert(tasks.end(), fresh.begin(), fresh.end());
  slabs = std::move(next);
  states = std::move(next_states);
}

// How many leaves every slab that asks for more can have, of so many to come; dear ones several times as many.
float level_of(const std::vector<SlabState>& states, double leaves) {
  // The level at which a slab stands, and what one level more costs there.
  std::vector<std::pair<double, double>> has;
  for (const SlabState& state : states) {
    if (state.active) has.emplace_back(double(state.leaves) / double(state.dear), double(state.dear));
  }
  std::sort(has.begin(), has.end());
  double level = 0, slabs = 0;  // of those below the level
  for (const auto& [own, dear] : has) {
    if (slabs > 0 && leaves < slabs * (own - level)) break;
    leaves -= slabs * (own - level);
    level = own, slabs += dear;
  }
  return float(slabs > 0 ? level + std::max(leaves, 0.) / slabs : 0);
}

// By how much what a slab costs beyond its ideal exceeds what it may.
float dearness(const Slab& slab, const GrowthRules& rules) {
  constexpr float most = 4;
  const SlabTotal sum = total_of(slab);
  const double excess = sum.ideal > 0 ? sum.cost / sum.ideal - 1 : 0;
  return clamp(float(excess) / (rules.goal_of(slab) - 1), 1.f, most);
}

}  // namespace

void grow(std::vector<Slab>& slabs, const Survey& survey, const GrowthRules& rules) {
  std::vector<SlabState> states(slabs.size());
  std::vector<Task> tasks;
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    // A root that was looked at before may have been raised since: it keeps its bound.
    if (slabs[s].nodes.size() == 1 && slabs[s].nodes[0].leaf.cost == 0) tasks.push_back({s, 0});
    states[s].leaves = leaves_in_order(slabs[s]).size();
    states[s].active = !(rules.enough > 0 && total(slabs[s], &Leaf::cost) <= rules.enough);
    states[s].most =
        rules.enough > 0 ? std::min(rules.max_leaves, 4 * states[s].leaves + 64) : rules.max_leaves;
  }
  const std::uint64_t start = survey.effort.evaluations, limit = survey.effort.limit;
  const double left = double(limit) - double(std::min(start, limit));
  int round = 0;
  for (bool busy = true; busy;) {
    // How many rounds there will be, nobody knows: each brings the bar closer to the end of its stage.
    survey.host.progress(
        linear_mix(1 - 1 / (1 + 0.05f * float(round++)), rules.progress, rules.progress_end));
    evaluate(slabs, tasks, survey, rules);
    tasks.clear();
    busy = false;
    const auto used = double(survey.effort.evaluations - start);
    if (survey.effort.spent() || used >= double(rules.effort_share) * left) return;
    std::vector<Halved> halved;
    // Halved slabs begin again: what is left in the end belongs to their leaves.
    bool may_halve = rules.split_slabs;
    float level = 1e30f;
    if (rules.leaves_kept == 0) {
      may_halve = may_halve && double(survey.effort.evaluations) < 0.7 * double(survey.effort.limit);
    } else {
      const auto leaf = double(2 * slabs.front().views.size() * grid_points);
      for (std::size_t s = 0; s < slabs.size(); ++s) {
        if (states[s].active) states[s].dear = dearness(slabs[s], rules);
      }
      level = level_of(states, (double(rules.effort_share) * left - used) / leaf);
      may_halve = may_halve && level > float(rules.leaves_kept);
    }
    for (std::uint32_t s = 0; s < slabs.size(); ++s) {
      Step step = next_step(slabs[s], states[s], rules, may_halve, survey.albedo.relative_error);
      if (step.halve >= 0) halved.push_back({s, step.halve});
      states[s].active = step.halve >= 0 || !step.split.empty();
      // What is left belongs to others.
      if (float(states[s].leaves) >= level * states[s].dear) step.split.clear();
      for (const std::uint32_t i : step.split) {
        split_leaf(slabs[s], i, survey.field.domain);
        const std::uint32_t child = slabs[s].nodes[i].child;
        tasks.push_back({s, child}), tasks.push_back({s, child + 1});
      }
      states[s].leaves += step.split.size();
      busy = busy || step.halve >= 0 || !step.split.empty();
    }
    if (!halved.empty()) halve(slabs, states, tasks, halved, survey, rules);
  }
}

}  // namespace reflectree::detail
