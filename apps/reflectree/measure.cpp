// SPDX-License-Identifier: Apache-2.0
#include "measure.hpp"

#include <algorithm>
#include <chrono>

#include "reflectree/brdf/number_text.hpp"
#include "reflectree/draw/disk_image.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/domain_map.hpp"

namespace reflectree::cli {

namespace {

constexpr float degree = pi / 180;

// The bound of every slab, by point location in the canonical trees.
class Bounds {
 public:
  explicit Bounds(const SamplerData& data) : data_(data) {
    for (const MajorantTree& tree : data_.exact) {
      finders_.emplace_back(tree.nodes, data_.domain);
      double sum = 0;
      for (const std::uint32_t m : tree.mass) sum += m;
      scale_.push_back(double(tree.volume) / sum);
    }
  }

  // Of T / a at a point of the square, per share of it.
  double at(Direction wo, Vec2<float> p) const {
    const std::size_t slab = draw::slab_of(data_.exact_partition, wo);
    const Tree& tree = data_.exact[slab];
    const auto leaf = finders_[slab].find(p);
    const double root = data_.domain.half ? 2 : 4;
    const double area = double(leaf.cell.x1 - leaf.cell.x0) * double(leaf.cell.y1 - leaf.cell.y0) / root;
    return scale_[slab] * tree.mass[leaf.index] / area * double(draw::leaf_shape(tree, leaf, p));
  }

 private:
  const SamplerData& data_;
  std::vector<draw::LeafFinder> finders_;
  std::vector<double> scale_;
};

struct FirstTrial {
  double ratio = -1;
  void trial(bool, float value, float majorant) {
    if (ratio < 0) ratio = double(value) / double(majorant);
  }
  void exhausted() {}
};

template <class Draw>
double nanoseconds(std::uint64_t seed, const Draw& draw) {
  constexpr int rounds = 3, samples = 60'000;
  constexpr std::size_t viewers = 1024;
  Pcg32 u(seed, 5);
  std::vector<Direction> wo(viewers);
  for (Direction& w : wo) w = random_viewer(u);
  double best = 1e30;
  for (int round = 0; round < rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < samples; ++i) draw(wo[i % viewers], u);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count() / samples);
  }
  return best;
}

}  // namespace

Direction random_viewer(Pcg32& u) { return direction_from_angles(89.9f * degree * to_unit_float(u()), 0.f); }

std::vector<double> parse_theta_o(const std::string& text) {
  std::vector<double> theta_o_deg;
  std::string_view rest = text;
  while (true) {
    const auto theta = take_number(rest);
    if (!theta || !(*theta >= 0 && *theta < 90)) break;
    theta_o_deg.push_back(double(*theta));
    if (rest.empty()) return theta_o_deg;
    if (rest[0] != ',') break;
    rest.remove_prefix(1);
  }
  throw Error("'" + text + "' is no list of elevations", "--theta-o-deg",
              "give degrees from 0 to below 90, with commas between them");
}

RatioFunction bound_ratio(const Subject& subject) {
  const auto bounds = std::make_shared<const Bounds>(subject.data);
  return [bounds, &subject](std::span<const AttackPoint> points, std::span<double> ratio) {
    const SamplerData& data = subject.data;
    const auto channels = std::size_t(subject.f.channels());
    std::vector<ShadingGeometry<float>> geometry;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float y = float(points[i][2]);
      const Vec2<float> p{2 * float(points[i][1]) - 1, data.domain.half ? y : 2 * y - 1};
      const Direction wo = direction_from_angles(89.999f * degree * float(points[i][0]), 0.f);
      const DomainPoint at = lift(data.domain, wo, p);
      ratio[i] = 0;
      if (!(at.projected_area > 0)) continue;
      const double albedo = double(albedo_at(data.albedo, wo.z));
      if (!(albedo > 0)) continue;
      ratio[i] = double(at.projected_area) / (albedo * bounds->at(wo, p));
      geometry.push_back(at.geometry), index.push_back(i);
    }
    std::vector<float> values(geometry.size() * channels);
    subject.f.eval(geometry, values);
    for (std::size_t k = 0; k < index.size(); ++k) {
      ratio[index[k]] *= double(data.target(values.data() + k * channels, int(channels)));
    }
  };
}

RatioTrial first_trial_ratio(const Subject& subject) {
  return [&subject](Pcg32& u) {
    FirstTrial first;
    subject.sampler.exact.sample(random_viewer(u), u, first);
    return std::max(first.ratio, 0.);
  };
}

Overshoot measure_overshoot(const Subject& subject, std::uint64_t trials, std::uint64_t seed,
                            const Host& host) {
  AttackOptions options;
  options.seed = seed;
  Overshoot result;
  result.attack = attack(bound_ratio(subject), options, host);
  result.mass = overshoot_mass(first_trial_ratio(subject), trials, result.attack.worst, seed, host);
  return result;
}

Speed measure_speed(const Subject& subject, std::uint64_t seed) {
  Speed speed;
  SampleStatistics statistics;
  Pcg32 u(seed, 6);
  for (int i = 0; i < 100'000; ++i) subject.sampler.exact.sample(random_viewer(u), u, statistics);
  if (statistics.accepted) speed.mean_trials = double(statistics.trials) / double(statistics.accepted);
  // The sum keeps the work from being left out.
  double sum = 0;
  speed.exact_ns = nanoseconds(seed, [&](Direction wo, Pcg32& bits) {
    if (const auto s = subject.sampler.exact.sample(wo, bits)) sum += double(s->pdf);
  });
  speed.one_shot_ns = nanoseconds(seed, [&](Direction wo, Pcg32& bits) {
    if (const auto s = subject.sampler.one_shot.sample(wo, bits)) sum += double(s->pdf);
  });
  if (!(sum >= 0)) speed.exact_ns = speed.one_shot_ns = 0;
  return speed;
}

}  // namespace reflectree::cli
