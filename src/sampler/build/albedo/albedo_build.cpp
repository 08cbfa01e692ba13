// SPDX-License-Identifier: Apache-2.0
#include "albedo_build.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "azimuth.hpp"
#include "build/knots.hpp"
#include "integrals.hpp"
#include "over_elevation.hpp"
#include "panels.hpp"
#include "parameters.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "witnesses.hpp"

namespace reflectree::detail {

namespace {

// The largest miss of a family's table at viewers and members anywhere, relatively, by cubature from other
// cells than those that it was made of.
double largest_miss(const Field& field, const AlbedoTable& table, float relative_error, std::uint64_t seed,
                    const Host& host) {
  constexpr int places = 48, viewers = 3;
  constexpr float progress = 0.4f;
  Pcg32 u(seed, 29);
  const KnownBox whole = field.whole();
  double worst = 0;
  Effort uncounted;
  for (int k = 0; k < places; ++k) {
    Shares share{};
    for (int axis = 1; axis < whole.axes; ++axis) share[std::size_t(axis)] = to_unit_float(u());
    const Known known = whole.at(share);
    const Coordinates at{known[2], known[3]};
    std::vector<Viewer> witnesses;
    // Elevations up to 89.9 degrees; a third of them near the horizon.
    for (int i = 0; i < viewers; ++i) {
      const float c = i == 0 ? 1.8e-3f + 0.2f * sqr(to_unit_float(u())) : max(to_unit_float(u()), 1.8e-3f);
      witnesses.push_back({turned_to(wo_from_cosine(c), known[1]), at});
    }
    const Integrals seen = integrate(
        field, witnesses, {0.25 * double(relative_error), 11, 7, true, progress, progress}, host, uncounted);
    for (std::size_t i = 0; i < witnesses.size(); ++i) {
      const double a = double(albedo_at(table, witnesses[i].wo.z, known[1], at)), b = seen.values[i];
      if (max(a, b) > 0) worst = max(worst, std::abs(a - b) / max(a, b));
    }
  }
  return worst;
}

// The albedo of a family: of single members, then over the parameters, the first inside of the second.
AlbedoTable build_family_albedo(const Field& field, float relative_error, const Jumps& jumps,
                                std::uint64_t seed, const Host& host, Effort& effort) {
  const std::uint64_t budget = effort.limit / 3, start = effort.evaluations;
  const std::vector<float> borders = azimuth_borders(field, &jumps, 0, theta_max);
  const std::uint64_t each = budget / std::max<std::uint64_t>(8, 5 * (borders.size() - 1));
  const auto spent = [&] { return effort.evaluations - start > budget; };
  // Of one member, over theta_o and, of anisotropic ones, phi_o. What rows miss, the whole is asked.
  const auto member_at = [&](const Coordinates& at, float error, bool with_checks) {
    if (field.frame.isotropic())
      return albedo_over_elevation(field, 0, at, 0.35f * error, jumps, seed, host, effort, budget / 8,
                                   with_checks);
    const auto row_at = [&](float phi_o, bool checked) {
      return albedo_over_elevation(field, phi_o, at, 0.35f * error, jumps, seed, host, effort, each,
                                   checked && with_checks);
    };
    const auto not_asked = [](const AlbedoTable&) { return 0.; };
    return albedo_over_azimuth(field.frame.symmetry, borders, jumps.phi_o_bends, leaps_at_ends(field), error,
                               row_at, not_asked, spent);
  };
  const std::vector<KnownParameter>& parameters = field.parameters;
  const auto over_first = [&](float second, float error, bool with_checks) {
    const float inner = field.frame.isotropic() ? error : 0.5f * error;
    const auto slice_at = [&](float first, bool checked) {
      return member_at({first, second}, inner, checked && with_checks);
    };
    return albedo_over_parameter(parameters[0], error, slice_at, spent);
  };
  const auto over_second = [&](float second, bool checked) {
    return over_first(second, 0.5f * relative_error, checked);
  };
  // Four known coordinates: at 1e-4 tables of millions of nodes, and all of the effort. What is kept is stated.
  if (parameters.size() == 2 && !field.frame.isotropic()) relative_error = max(relative_error, 2e-3f);
  AlbedoTable table = parameters.size() == 1
                          ? over_first(0, relative_error, true)
                          : albedo_over_parameter(parameters[1], relative_error, over_second, spent);
  const double miss = largest_miss(field, table, relative_error, seed, host);
  if (miss > double(table.relative_error)) table.relative_error = float(min(2 * miss, 1.));
  return table;
}

}  // namespace

AlbedoTable build_albedo(const Field& field, float relative_error, const Jumps& jumps, std::uint64_t seed,
                         const Host& host, Effort& effort) {
  const std::uint64_t budget = effort.limit / 3;
  if (field.family) return build_family_albedo(field, relative_error, jumps, seed, host, effort);
  if (field.frame.isotropic()) {
    AlbedoTable table =
        albedo_over_elevation(field, 0, {}, relative_error, jumps, seed, host, effort, budget, true);
    if (field.f.traits().albedo)
      AlbedoWitnesses(field, double(relative_error), seed, host, effort.limit).miss_of(table);
    return table;
  }
  const std::uint64_t start = effort.evaluations;
  const std::vector<float> borders = azimuth_borders(field, &jumps, 0, theta_max);
  // Of few pieces rows may be many; of many each has four, and one end in common with the next.
  const std::uint64_t pieces = borders.size() - 1;
  const std::uint64_t each =
      pieces < 4 ? budget / std::max<std::uint64_t>(8, 5 * pieces) : effort.limit / 2 / (4 * pieces);
  // What the first row cannot reach, the others do not try for.
  const float asked = 0.35f * relative_error;
  float reachable = 0;
  const auto row_at = [&](float phi_o, bool checked) {
    AlbedoTable row = albedo_over_elevation(field, phi_o, {}, max(asked, reachable), jumps, seed, host,
                                            effort, each, checked);
    if (reachable == 0) reachable = row.relative_error;
    return row;
  };
  std::optional<AlbedoWitnesses> witnesses;
  const auto miss_of = [&](const AlbedoTable& table) {
    if (!witnesses) witnesses.emplace(field, double(table.relative_error), seed, host, effort.limit);
    return witnesses->miss_of(table);
  };
  // Rows that do not foretell each other are worth more than that: without them exact mode is off everywhere.
  const auto spent = [&] { return effort.evaluations - start > effort.limit / 2; };
  return albedo_over_azimuth(field.frame.symmetry, borders, jumps.phi_o_bends, leaps_at_ends(field),
                             relative_error, row_at, miss_of, spent);
}

}  // namespace reflectree::detail
