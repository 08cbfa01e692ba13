// SPDX-License-Identifier: Apache-2.0
// What the members of a family have in common, and how their lobes widen.
#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"
#include "subject.hpp"

namespace reflectree::detail {

namespace {

struct Member {
  Coordinates at{};
  AnyBrdf f;
};

// All over the ranges, borders included, and a few anywhere.
std::vector<Member> members_of(const Subject& subject, std::uint64_t seed) {
  const std::vector<KnownParameter>& parameters = subject.parameters;
  const std::size_t steps = parameters.size() > 1 ? 3 : 5, anywhere = 4;
  std::size_t count = 1;
  for (std::size_t i = 0; i < parameters.size(); ++i) count *= steps;
  Pcg32 u(seed, 31);
  std::vector<Member> members;
  for (std::size_t k = 0; k < count + anywhere; ++k) {
    Coordinates at{};
    for (std::size_t i = 0, rest = k; i < parameters.size(); ++i, rest /= steps) {
      const float share = k < count ? float(rest % steps) / float(steps - 1) : to_unit_float(u());
      at[i] = linear_mix(share, lowest(parameters[i]), highest(parameters[i]));
    }
    members.push_back({at, subject.family->member(values_of(parameters, at))});
  }
  return members;
}

// The largest symmetry of one of the members that all of them have.
ViewerFrame common_frame(const std::vector<Member>& members, const std::vector<Examination>& seen,
                         std::uint64_t seed) {
  std::vector<ViewerFrame> candidates;
  for (const Examination& one : seen) {
    if (!one.frame.isotropic()) candidates.push_back(one.frame);
  }
  if (candidates.empty()) return {};
  const auto weight = [](const ViewerFrame& frame) { return std::uint8_t(frame.symmetry); };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const ViewerFrame& a, const ViewerFrame& b) { return weight(a) < weight(b); });
  const float axis = candidates.front().axis;
  for (const float turned : {axis, axis + 0.5f * pi})
    candidates.push_back({ViewerSymmetry::one_plane, turned});
  candidates.push_back({ViewerSymmetry::half_turn, axis});
  for (const ViewerFrame& frame : candidates) {
    const bool common = std::all_of(members.begin(), members.end(),
                                    [&](const Member& m) { return has_symmetry(m.f, frame, seed); });
    if (common) return frame;
  }
  return {ViewerSymmetry::none, axis};
}

// Least squares of the logarithms of widths, linear in the coordinates: three normal equations.
std::array<float, 1 + max_parameters> fit_widths(const std::vector<Member>& members,
                                                 const std::vector<float>& widths, std::size_t parameters) {
  double a[3][4] = {};
  for (std::size_t m = 0; m < members.size(); ++m) {
    const double row[3] = {1, double(members[m].at[0]), parameters > 1 ? double(members[m].at[1]) : 0};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) a[i][j] += row[i] * row[j];
      a[i][3] += row[i] * std::log(double(widths[m]));
    }
  }
  if (parameters < 2) a[2][2] = 1;
  for (int i = 0; i < 3; ++i) {  // positive definite: the members span the ranges
    for (int j = 0; j < 3; ++j) {
      if (j == i) continue;
      const double factor = a[j][i] / a[i][i];
      for (int k = i; k < 4; ++k) a[j][k] -= factor * a[i][k];
    }
  }
  std::array<float, 1 + max_parameters> law{};
  for (std::size_t i = 0; i < law.size(); ++i) law[i] = float(a[i][3] / a[i][i]);
  return law;
}

}  // namespace

Subject subject_of(const AnyFamily& family) {
  Parameters middle{};
  std::vector<KnownParameter> parameters;
  for (const ParameterRange& range : family.ranges()) {
    const KnownParameter p{range, is_logarithmic(range)};
    middle[parameters.size()] = value_of(p, linear_mix(0.5f, lowest(p), highest(p)));
    parameters.push_back(p);
  }
  return {family.member(middle), family, parameters};
}

Examination examine(const Subject& subject, const BuildOptions& options, const std::vector<Ridge>& ridges) {
  if (!subject.family) return examine(subject.f, options, ridges);
  const std::vector<Member> members = members_of(subject, options.seed);
  std::vector<Examination> seen;
  for (const Member& member : members) {
    try {
      seen.push_back(examine(member.f, options));
    } catch (const Error& error) {
      const Parameters values = values_of(subject.parameters, member.at);
      throw Error(error.what(), to_text(subject.family->ranges(), values), "narrow the ranges, or mend it");
    }
  }
  Examination all = seen.front();
  all.frame = common_frame(members, seen, options.seed);
  all.stretch = 1;
  float brightest = -1;
  for (std::size_t m = 0; m < members.size(); ++m) {
    if (seen[m].target.scale != all.target.scale) {
      throw Error("its members differ by more than floats can hold together", subject.family->traits().name,
                  "narrow the ranges");
    }
    all.mirror_symmetric = all.mirror_symmetric && seen[m].mirror_symmetric;
    all.asymmetry = max(all.asymmetry, seen[m].asymmetry);
    // Pairs of members in the frame of another symmetry would have to be folded: those at azimuth 0 are.
    if (seen[m].frame != all.frame) continue;
    const Direction wo = seen[m].brightest_wo, wi = seen[m].brightest_wi;
    const Direction o = turn(wo, cos(all.frame.axis), sin(all.frame.axis)),
                    i = turn(wi, cos(all.frame.axis), sin(all.frame.axis));
    const Spectrum value = members[m].f(shading_geometry(o, i));
    const float t = all.target(value);
    if (t > brightest) {
      brightest = t;
      all.brightest_wo = wo, all.brightest_wi = wi, all.brightest_at = members[m].at;
    }
  }
  if (!all.frame.isotropic()) all.mirror_symmetric = false, all.asymmetry = 1;
  std::vector<float> x, y;
  for (const Member& member : members) {
    x.push_back(reach_at(member.f, all.target, all.frame.axis));
    y.push_back(reach_at(member.f, all.target, all.frame.axis + 0.5f * pi));
  }
  all.widths.x = fit_widths(members, x, subject.parameters.size());
  all.widths.y = all.frame.isotropic() ? all.widths.x : fit_widths(members, y, subject.parameters.size());
  return all;
}

}  // namespace reflectree::detail
