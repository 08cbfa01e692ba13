// SPDX-License-Identifier: Apache-2.0
#include "judge_by_trees.hpp"

#include <algorithm>
#include <cmath>

#include "integrals.hpp"
#include "panels.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

namespace {

// Where a row of the table is farthest from the lines between its neighbours at some distances: a lobe that
// some integrals met and others stepped over leaves teeth.
std::vector<Known> teeth(const AlbedoTable& table) {
  constexpr std::size_t most = 2;  // at each distance
  std::vector<Known> list;
  const std::size_t rows = table.parameters.empty() ? std::max<std::size_t>(table.phi_o.size(), 1) : 0;
  for (const float distance : {0.1f, 0.02f, 4e-3f, 8e-4f, 1e-4f}) {
    std::vector<std::pair<float, Known>> bends;
    for (std::size_t row = 0; row < rows; ++row) {
      const float phi_o = table.phi_o.empty() ? 0 : table.phi_o[row];
      const auto albedo = [&](float theta) {
        return albedo_at(table, max(cos(theta), min_cos_theta_o), phi_o);
      };
      for (auto c = table.cos_theta_o.rbegin(); c != table.cos_theta_o.rend(); ++c) {
        const float theta = acos(min(*c, 1.f)), here = albedo(theta);
        if (theta < distance || theta + distance > theta_max) continue;
        const float line = 0.5f * (albedo(theta - distance) + albedo(theta + distance));
        const float bend = abs(line - here) / max(max(line, here), 1e-30f);
        if (bend > 0.7f * table.relative_error) bends.push_back({-bend, {theta, phi_o}});
      }
    }
    std::sort(bends.begin(), bends.end());
    std::size_t taken = 0;
    for (const auto& [bend, known] : bends) {
      const bool apart = std::all_of(
          list.end() - std::ptrdiff_t(taken), list.end(),
          [&, known = known](const Known& k) { return k[1] != known[1] || abs(k[0] - known[0]) > distance; });
      if (apart && taken < most) list.push_back(known), ++taken;
    }
  }
  return list;
}

// Viewers who met the peaks that may weigh most, and anybody, near the normal and near the horizon as well.
std::vector<Known> witnesses_for(const std::vector<Slab>& slabs, const TreeMarks& marks,
                                 const AlbedoTable& table, std::uint64_t seed) {
  constexpr std::size_t most_peaks = 8, others = 8;
  constexpr float near[] = {0.002f, 0.03f, 1.4f, 1.55f};  // theta_o
  Pcg32 u(seed, 31);
  std::vector<Known> list = teeth(table);
  std::vector<TreeMarks::Peak> peaks = marks.peaks;
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const TreeMarks::Peak& a, const TreeMarks::Peak& b) { return a.mass > b.mass; });
  if (peaks.size() > most_peaks) peaks.resize(most_peaks);
  for (const TreeMarks::Peak& peak : peaks) list.push_back(peak.seen_by);
  for (std::size_t k = 0; k < others + 4; ++k) {
    const Slab& slab = slabs[k < others ? k * slabs.size() / others : u() % slabs.size()];
    Shares share{};
    for (int axis = 0; axis < slab.box.axes; ++axis) share[std::size_t(axis)] = to_unit_float(u());
    Known known = slab.box.at(share);
    if (k >= others) known[0] = near[k - others] + 0.01f * to_unit_float(u());
    list.push_back(known);
  }
  return list;
}

}  // namespace

std::vector<WrongAlbedo> judge_by_trees(const std::vector<Slab>& slabs, const TreeMarks& marks,
                                        const Survey& survey, std::uint64_t seed) {
  constexpr double doubted = 0.5, accepted = 0.7;  // as where the table checks itself
  constexpr float progress = 0.86f;
  const double stated = double(survey.albedo.relative_error);
  Field field = survey.field;
  field.marks = &marks;
  // What is missed by more than a share of what is stated, and by more than the cubature leaves open.
  const auto missed = [&](const std::vector<Known>& asked, double share, const IntegralOptions& options) {
    std::vector<Viewer> viewers;
    for (const Known& known : asked) viewers.push_back(viewer_at(known));
    const Integrals seen = integrate(field, viewers, options, survey.host, survey.effort);
    std::vector<WrongAlbedo> list;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const double a = double(survey.albedo_at(viewers[i])), b = seen.values[i], larger = std::max(a, b);
      if (!(larger > 0) || survey.at_jump(viewers[i].wo)) continue;
      const double open = std::max(seen.errors[i] - options.relative_error, 0.);
      const double miss = (std::abs(a - b) / larger - open) / times_allowed(viewers[i].wo.z);
      if (miss > share * stated) list.push_back({asked[i], a, b, miss});
    }
    return list;
  };
  std::vector<Known> doubtful;
  for (const WrongAlbedo& w : missed(witnesses_for(slabs, marks, survey.albedo, seed), doubted,
                                     {4 * stated, 41, 23, true, progress, progress}))
    doubtful.push_back(w.known);
  std::vector<WrongAlbedo> wrong =
      missed(doubtful, accepted, {0.1 * stated, 64, 32, true, progress, progress});
  std::stable_sort(wrong.begin(), wrong.end(),
                   [](const WrongAlbedo& a, const WrongAlbedo& b) { return a.miss > b.miss; });
  return wrong;
}

}  // namespace reflectree::detail
