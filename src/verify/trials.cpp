// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/trials.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "elevations.hpp"
#include "parallel.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {

TrialLog watch_trials(const Suspect& suspect, const WayIn& way, std::uint64_t directions, std::uint64_t seed,
                      const Host& host) {
  constexpr std::uint64_t chunk = 1 << 14, a_viewer = 2 * batch_lanes;
  const std::uint64_t chunks = (directions + chunk - 1) / chunk;
  std::vector<TrialLog> parts(chunks);
  detail::for_each_index(host, suspect.concurrent(), chunks, [&](std::size_t c) {
    Pcg32 u = detail::part_generator(seed, c);
    const std::uint64_t here = std::min(chunk, directions - c * chunk);
    for (std::uint64_t i = 0; i < here; i += a_viewer) {
      way.watch(detail::random_viewer(u), u, std::size_t(std::min(a_viewer, here - i)), parts[c]);
    }
  });
  TrialLog sum;
  for (const TrialLog& part : parts) sum.add(part);
  return sum;
}

CheckResult check_acceptance(const std::string& way, const TrialLog& log, const ChiSquareOptions& options) {
  const int lanes = int(
      std::count_if(log.lane.begin(), log.lane.end(), [](const TrialLog::Lane& l) { return l.trials > 0; }));
  CheckResult result;
  result.name = "acceptance";
  result.way = way;
  result.threshold =
      normal_two_sided_quantile(sidak(options.family_significance, options.tests * 2 * std::max(lanes, 1)));
  std::size_t worst = 0;
  bool dependent = false;
  for (std::size_t l = 0; l < log.lane.size(); ++l) {
    const TrialLog::Lane& lane = log.lane[l];
    // Ratios are rounded to float: some 1e-7 of the trials, and single ones.
    const double difference =
        std::abs(double(lane.accepted) - lane.expected) - 3 - 1e-6 * double(lane.trials);
    const double z = difference > 0 ? difference / std::sqrt(lane.variance + 1) : 0;
    const double together = std::abs(lane.together) / std::sqrt(lane.together_variance + 25);
    if (std::max(z, together) > result.statistic) {
      result.statistic = std::max(z, together), worst = l, dependent = together > z;
    }
  }
  result.passed = result.statistic <= result.threshold && lanes > 0;
  char buffer[240];
  const TrialLog::Lane& lane = log.lane[worst];
  std::snprintf(
      buffer, sizeof buffer,
      "%s, standard deviations; worst of %d lanes: %zu, %llu of %llu accepted where %.1f are expected%s",
      way.c_str(), lanes, worst, static_cast<unsigned long long>(lane.accepted),
      static_cast<unsigned long long>(lane.trials), lane.expected,
      dependent ? "; it depends on the lane before" : "");
  result.detail = buffer;
  return result;
}

CheckResult check_giving_up(const WayIn& way, std::uint64_t promised) {
  CheckResult result;
  result.name = "giving_up";
  result.way = way.name;
  std::uint64_t fewest = 0;
  for (int i = 0; i < 64; ++i) {
    const float theta = (float(i) + 0.5f) / 64 * 0.5f * pi;
    const std::uint64_t trials = way.give_up(direction_from_angles(theta, 0.4f * float(i)));
    if (trials > 0 && (fewest == 0 || trials < fewest)) fewest = trials;
  }
  result.decided = fewest > 0;
  result.passed = fewest == 0 || fewest >= promised;
  result.statistic = fewest > 0 ? double(promised) - double(fewest) : 0;
  char buffer[160];
  std::snprintf(buffer, sizeof buffer,
                fewest > 0 ? "%s gives up after %llu trials, %llu are promised"
                           : "%s never gave up (%llu of %llu): its bounds are met wherever it was refused",
                way.name.c_str(), static_cast<unsigned long long>(fewest),
                static_cast<unsigned long long>(promised));
  result.detail = buffer;
  return result;
}

namespace {

// The bound of T / a, per share of the square, and what finds its place.
struct Bounds {
  const SamplerData& data;
  PackedViewer viewer;
  std::vector<TreeReader> readers;

  explicit Bounds(const SamplerData& the_data) : data(the_data), viewer(pack_viewer(data)) {
    for (const MajorantTree& tree : data.exact) readers.emplace_back(tree, data.domain.symmetry);
  }
  double at(const Incidence& in, Vec2<float> p) const {
    const std::size_t slab = slab_of(data.exact_partition, in);
    return double(data.exact[slab].volume) * readers[slab].density_at(p);
  }
};

}  // namespace

namespace {

// eval(geometry, members, values).
template <class Eval>
RatioFunction ratio_of(std::size_t channels, const SamplerData& data, Eval eval) {
  const auto bounds = std::make_shared<const Bounds>(data);
  return [bounds, channels, eval, &data](std::span<const AttackPoint> points, std::span<double> ratio) {
    const bool isotropic = data.frame.isotropic(), turned = isotropic && data.parameters.empty();
    std::vector<ShadingGeometry<float>> geometry;
    std::vector<Parameters> members;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2<float> p = square_point(data.domain.symmetry, float(points[i][1]), float(points[i][2]));
      const float theta = 89.999f * (pi / 180) * float(points[i][0]);
      const float phi = isotropic ? 0.f : data.frame.axis + 2 * pi * float(points[i][3]);
      Coordinates at{};
      for (std::size_t k = 0; k < data.parameters.size(); ++k) {
        const KnownParameter& q = data.parameters[k];
        at[k] = linear_mix(float(points[i][(isotropic ? 3 : 4) + k]), lowest(q), highest(q));
      }
      const Parameters member = values_of(data.parameters, at);
      ratio[i] = 0;
      Incidence in;
      const Direction wo = direction_from_angles(theta, phi);
      if (data.parameters.empty() ? !find_incidence(bounds->viewer, wo, in)
                                  : !find_incidence(bounds->viewer, wo, member, in)) {
        continue;
      }
      const DomainPoint lifted = lift(domain_at(bounds->viewer, data.domain, in), in.wo, p);
      if (!(lifted.projected_area > 0)) continue;
      ratio[i] = double(lifted.projected_area) / (double(in.albedo) * bounds->at(in, p));
      geometry.push_back(known_geometry(in, lifted.geometry, turned));
      members.push_back(member), index.push_back(i);
    }
    std::vector<float> values(geometry.size() * channels);
    eval(geometry, members, values);
    for (std::size_t k = 0; k < index.size(); ++k) {
      ratio[index[k]] *= double(data.target(values.data() + k * channels, int(channels)));
    }
  };
}

}  // namespace

RatioFunction bound_ratio(AnyBrdf f, const SamplerData& data) {
  const auto channels = std::size_t(f.channels());
  return ratio_of(
      channels, data,
      [f = std::move(f)](std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters>,
                         std::span<float> values) { f.eval(geometry, values); });
}

RatioFunction bound_ratio(AnyFamily family, const SamplerData& data) {
  const auto channels = std::size_t(family.channels());
  return ratio_of(channels, data,
                  [family = std::move(family)](std::span<const ShadingGeometry<float>> geometry,
                                               std::span<const Parameters> members, std::span<float> values) {
                    family.eval(geometry, members, values);
                  });
}

int attack_coordinates(const SamplerData& data) {
  return (data.frame.isotropic() ? 3 : 4) + int(data.parameters.size());
}

}  // namespace reflectree
