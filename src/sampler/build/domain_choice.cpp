// SPDX-License-Identifier: Apache-2.0
// The domain with the fewest leaves, by trial.
#include <algorithm>
#include <array>
#include <cmath>

#include "grow.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "subject.hpp"

namespace reflectree::detail {

namespace {

constexpr float half_square_up_to = 0.2f;  // asymmetry that still is cheaper on half a square

// What half a square costs beside a whole one, however many leaves it has: the mass of the larger of both
// mirror images over that of their mean, less 1, at the worst of the slabs. Points are drawn
// by the trees' own bounds.
float folding_cost(const std::vector<Slab>& slabs, const Field& field, std::uint64_t seed) {
  constexpr std::size_t points_a_slab = 4096;
  Pcg32 u(seed, 13);
  float worst = 0;
  for (const Slab& slab : slabs) {
    std::vector<FieldPoint> points;
    std::vector<double> weight;
    const double step = double(total(slab, &Leaf::cost)) / double(points_a_slab);
    double cost = 0, next = 0.5 * step;
    for (const std::uint32_t i : leaves_in_order(slab)) {
      const Leaf& leaf = slab.nodes[i].leaf;
      const Box box = box_of(leaf.cell, field.domain);
      for (cost += double(leaf.cost); next < cost; next += step) {
        const float x = to_unit_float(u()), y = to_unit_float(u());
        points.push_back(field_point(slab.views[slab.views.size() / 2].viewer,
                                     {box.x0 + box.width * x, box.y0 + box.height * y}));
        weight.push_back(1 / double(leaf.height));
      }
    }
    std::vector<FieldValue> values(points.size());
    field.eval(points, values);
    double mean = 0, upper = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
      mean += weight[k] * double(values[k].mean), upper += weight[k] * double(values[k].upper);
    if (mean > 0) worst = max(worst, float(upper / mean - 1));
  }
  return worst;
}

}  // namespace

namespace {

// Thin boxes of known coordinates from the normal to grazing.
std::vector<KnownBox> trial_boxes(const ViewerFrame& frame) {
  constexpr float degree = pi / 180;
  constexpr struct {
    float theta, width;
  } trials[] = {{2, 3}, {20, 3}, {40, 3}, {60, 3}, {75, 2}, {84, 1}, {88.5f, 0.5f}};
  std::vector<KnownBox> boxes;
  for (const auto& t : trials) {
    const float lo = t.theta * degree, hi = (t.theta + t.width) * degree;
    if (frame.isotropic()) {
      boxes.push_back({{lo, 0}, {hi, 0}, 1});
      continue;
    }
    // About the normal a slab may have all azimuths, where the domain does not turn with wo.
    const float span = azimuth_span(frame.symmetry);
    const float across = t.theta < 10 ? span / 3 : min(10 * degree, 0.1f * span);
    for (const float share :
         t.theta < 10 ? std::array{0.f, 1 / 3.f, 2 / 3.f} : std::array{0.08f, 0.5f, 0.85f}) {
      boxes.push_back({{lo, share * span}, {hi, share * span + across}, 2});
    }
  }
  return boxes;
}

std::vector<Domain> domains_for(const Examination& seen) {
  if (seen.frame.isotropic()) {
    const Symmetry symmetry = seen.asymmetry <= half_square_up_to ? Symmetry::mirror : Symmetry::none;
    return {{DomainKind::half_vector, symmetry, 0},    {DomainKind::equal_area, symmetry, 0},
            {DomainKind::projected_disk, symmetry, 0}, {DomainKind::back_vector, symmetry, 0},
            {DomainKind::stretched, symmetry, 1.5f},   {DomainKind::mirror_vector, symmetry, 0},
            {DomainKind::normal_vector, symmetry, 0}};
  }
  std::vector<Domain> list;
  // The measured stretch, and milder ones: what lies beside the lobe may ask for less.
  for (const float part : {1.f, 0.7f, 0.4f, 0.f}) {
    const float stretch = std::pow(seen.stretch, part);
    if (list.empty() || stretch < 0.9f * list.back().stretch)
      list.push_back({DomainKind::slope_star, Symmetry::none, 0, stretch});
  }
  for (const DomainKind kind :
       {DomainKind::half_vector, DomainKind::equal_area, DomainKind::projected_disk, DomainKind::back_vector,
        DomainKind::mirror_vector, DomainKind::normal_vector}) {
    list.push_back({kind, Symmetry::none, 0});
  }
  list.push_back({DomainKind::stretched, Symmetry::none, 1.5f});
  return list;
}

// Boxes for families: wider, so that what the parameters cost shows, and fewer where more is known.
std::vector<KnownBox> family_boxes(const Field& field) {
  constexpr float degree = pi / 180;
  const KnownBox whole = field.whole();
  const bool few = whole.axes > 2;
  std::vector<KnownBox> boxes;
  constexpr struct {
    float theta, width;
  } trials[] = {{2, 3}, {20, 3}, {40, 3}, {60, 3}, {75, 2}, {84, 1}, {88.5f, 0.5f}};
  for (std::size_t i = 0; i < std::size(trials); i += few ? 2 : 1) {
    KnownBox box = whole;
    box.lo[0] = trials[i].theta * degree, box.hi[0] = (trials[i].theta + trials[i].width) * degree;
    boxes.push_back(box);
  }
  for (int axis = 1; axis < whole.axes; ++axis) {
    std::vector<KnownBox> next;
    const auto k = std::size_t(whole.slot[std::size_t(axis)]);
    const float across = k == 1 ? min(10 * degree, 0.1f * whole.width(axis)) : 0.08f * whole.width(axis);
    const std::vector<float> shares =
        few ? std::vector<float>{0.08f, 0.7f} : std::vector<float>{0, 0.3f, 0.6f, 0.92f};
    for (const KnownBox& box : boxes) {
      for (const float share : shares) {
        next.push_back(box);
        next.back().lo[k] = linear_mix(share, whole.lo[k], whole.hi[k]);
        next.back().hi[k] = min(next.back().lo[k] + across, whole.hi[k]);
      }
    }
    boxes = std::move(next);
  }
  return boxes;
}

std::vector<DomainChoice> candidates(const Subject& subject, const Examination& seen) {
  std::vector<DomainChoice> list;
  if (subject.family) {
    // Widths that follow the lobes' by a power: less than 1, since what grazes does not widen with them.
    const Symmetry symmetry =
        seen.frame.isotropic() && seen.asymmetry <= half_square_up_to ? Symmetry::mirror : Symmetry::none;
    for (const float power : {0.7f, 0.55f, 0.85f, 0.4f, 1.f, 0.f}) {
      DomainChoice choice{{DomainKind::scaled_star, symmetry}, seen.widths};
      for (auto* law : {&choice.law.x, &choice.law.y}) {
        for (float& factor : *law) factor *= power;
      }
      list.push_back(choice);
    }
  }
  for (const Domain& domain : domains_for(seen)) {
    if (!subject.family || domain.kind != DomainKind::slope_star) list.push_back({domain});
  }
  return list;
}

// An albedo of 1 for every viewer.
AlbedoTable flat_albedo(const Field& field) {
  AlbedoTable flat{{min_cos_theta_o, 1}, {}, 0};
  std::size_t rows = 1;
  if (!field.frame.isotropic()) {
    const float span = azimuth_span(field.frame.symmetry);
    flat.phi_o = {0, 0.5f * span, span}, rows = 3;
    flat.even = is_mirrored(field.frame.symmetry);
  }
  for (const KnownParameter& p : field.parameters)
    flat.parameters.push_back({lowest(p), highest(p), 4}), rows *= 4;
  flat.albedo.assign(2 * rows, 1);
  return flat;
}

}  // namespace

Field field_of(const Subject& subject, const Examination& seen, const DomainChoice& choice,
               const std::vector<Ridge>& ridges) {
  const bool both_sides = choice.domain.half() && !seen.mirror_symmetric;
  Field field{subject.f,  seen.target,    choice.domain,      both_sides, ridges,
              seen.frame, subject.family, subject.parameters, choice.law};
  field.patches = patch_cells(field);
  return field;
}

DomainChoice choose_domain(const Subject& subject, const BuildOptions& options, const Examination& seen,
                           const std::vector<Ridge>& ridges, const Host& host) {
  const DomainChoice disk{{DomainKind::projected_disk, Symmetry::none}};
  if (!field_of(subject, seen, disk, ridges).patches.empty()) return disk;
  const Field any = field_of(subject, seen, {}, ridges);
  const AlbedoTable flat = flat_albedo(any);
  // A coarser goal, and no slab is halved: what the known coordinates cost is counted in.
  const float goal = 1 + 2 * (options.expected_trials - 1);
  GrowthRules rules{goal, 1, 2000, false, true, analyse_exact, 1e30f};
  const std::vector<KnownBox> boxes = subject.family ? family_boxes(any) : trial_boxes(seen.frame);
  DomainChoice best;
  std::vector<Slab> best_slabs;
  float least = 1e30f;
  double best_mass = 0;
  for (const DomainChoice& choice : candidates(subject, seen)) {
    const Field field = field_of(subject, seen, choice, ridges);
    std::vector<Slab> slabs;
    for (const KnownBox& box : boxes) slabs.push_back(make_slab(box, flat, field));
    Effort effort{0, options.max_evaluations / 20};
    grow(slabs, {field, flat, host, effort}, rules);
    float price = 0;
    double mass = 0;  // what the domain's grids saw: one that oversaw a lobe is cheap for that reason
    for (const Slab& slab : slabs) {
      double cost = 0, ideal = 0;
      std::array<double, known_slots> known_cost{};
      float leaves = 0;
      for (const Node& node : slab.nodes) {
        if (node.split != TreeSplit::leaf) continue;
        cost += double(node.leaf.cost), ideal += double(node.leaf.ideal);
        for (std::size_t a = 0; a < known_cost.size(); ++a) known_cost[a] += double(node.leaf.known_cost[a]);
        ++leaves;
      }
      if (!(ideal > 0)) continue;
      mass += ideal;
      const float budget = goal - 1;
      const float missed = max(1.f, float((cost - ideal) / ideal) / budget);
      float narrower = 1;
      for (const double saved : known_cost) narrower *= max(1.f, float(saved / ideal) / (0.4f * budget));
      price += leaves * missed * missed * narrower;
    }
    const bool blind = mass == 0 && best_mass > 0, sees_more = mass > 0 && best_mass == 0;
    if (sees_more || (price < least && !blind))
      least = price, best = choice, best_mass = mass, best_slabs = std::move(slabs);
    // A domain that needs in one slab twice as many leaves as the best in all cannot win.
    rules.max_leaves = std::size_t(clamp(2 * least, 32.f, 2000.f));
    if (boxes.front().axes > 1)  // of many boxes: one that needs so many more than they do on average
      rules.max_leaves = std::size_t(clamp(6 * least / float(boxes.size()), 32.f, 2000.f));
  }
  // Leaves grow as 1 / (what is left of the trials allowed): past half of them a whole square is cheaper.
  if (best.domain.half() && !seen.mirror_symmetric) {
    const float cost = folding_cost(best_slabs, field_of(subject, seen, best, ridges), options.seed);
    if (!(cost < 0.5f * (options.expected_trials - 1))) best.domain.symmetry = Symmetry::none;
  }
  return best;
}

}  // namespace reflectree::detail
