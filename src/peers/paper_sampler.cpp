// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_sampler.hpp"

#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/peers/lobe.hpp"
#include "reflectree/peers/paper_choice.hpp"

namespace reflectree {

namespace {

// w turned about the normal so that the x axis goes to the azimuth of wo.
Direction turned(Direction w, Direction wo) {
  const float r = sqrt(wo.x * wo.x + wo.y * wo.y);
  if (!(r > 0)) return w;
  const float c = wo.x / r, s = wo.y / r;
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

// 53 bits in [0, 1): what chooses a leaf also places a point in it.
double wide(std::uint32_t high, std::uint32_t low) {
  return double((std::uint64_t(high) << 21U) | (low >> 11U)) * 0x1p-53;
}
struct Point {
  double x, y;
};
// High words first: they are the caller's, the low ones are not.
Point wide_point(UniformBits& u) {
  const std::uint32_t x = u(), y = u(), low_x = u(), low_y = u();
  return {wide(x, low_x), wide(y, low_y)};
}

std::vector<PaperTree> tabulated(const AnyBrdf& f, Target target, const PaperOptions& options,
                                 const Host& host) {
  if (!f.traits().isotropic) {
    throw Error("the paper's tables serve isotropic functions only", f.traits().name,
                "build the tree for a single wo instead");
  }
  std::vector<PaperTree> trees(std::size_t(options.thetas));
  const auto work = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double theta = row_theta_o(i, trees.size());
      trees[i] = build_paper_tree(f, target, {float(std::sin(theta)), 0, float(std::cos(theta))}, options);
    }
  };
  if (f.traits().concurrent) {
    host.parallel_for(trees.size(), work);
  } else {
    work(0, trees.size());
  }
  return trees;
}

}  // namespace

PaperSampler::PaperSampler(AnyBrdf f, Target target, std::vector<PaperTree> trees, bool fixed_wo,
                           const PaperOptions& options)
    : f_(std::move(f)),
      target_(target),
      options_(options),
      fixed_wo_(fixed_wo),
      trees_(std::make_shared<const std::vector<PaperTree>>(std::move(trees))) {}
PaperSampler::PaperSampler(AnyBrdf f, Target target, const PaperOptions& options, const Host& host)
    : PaperSampler(f, target, tabulated(f, target, options, host), false, options) {}
PaperSampler::PaperSampler(AnyBrdf f, Target target, Direction wo, const PaperOptions& options)
    : PaperSampler(f, target, {build_paper_tree(f, target, wo, options)}, true, options) {}

PaperSampler::Reading PaperSampler::reading(Direction wo) const {
  const std::vector<PaperTree>& trees = *trees_;
  Reading r;
  if (fixed_wo_) {
    r.wo = wo, r.trees[0] = &trees[0];
    return r;
  }
  r.wo = {sqrt(wo.x * wo.x + wo.y * wo.y), 0, wo.z};
  const double last = double(trees.size() - 1);
  const double row = double(theta_of(wo)) / (pi_v<double> / 2) * double(trees.size()) - 0.5;
  const double place = std::clamp(row, 0.0, last);
  if (options_.between == PaperBetween::nearest) {
    r.trees[0] = &trees[std::size_t(std::round(place))];
    return r;
  }
  const auto lower = std::size_t(place);
  r.trees[0] = &trees[lower];
  if (place > double(lower)) {
    r.trees[1] = &trees[lower + 1];
    r.shares[1] = place - double(lower), r.shares[0] = 1 - r.shares[1];
  }
  return r;
}

double PaperSampler::density(const Reading& r, Direction wi) const {
  double sum = 0;  // per area of the disk
  for (int k = 0; k < 2; ++k) {
    if (!r.trees[k] || !(r.trees[k]->albedo() > 0)) continue;
    const Direction wo = r.trees[k]->wo, w = carried(options_.map, r.wo, wi, wo);
    if (!(w.z > 0)) continue;
    sum += r.shares[k] / r.trees[k]->albedo() * double(target_(eval(f_, wo, w))) * double(w.z) *
           solid_angle_per_area(options_.map, wo, w);
  }
  return sum / solid_angle_per_area(options_.map, r.wo, wi);
}

std::optional<Direction> PaperSampler::trial(const PaperTree& tree, const PaperNode& leaf, double u, double v,
                                             double height) const {
  const PaperBox box = clip_to_disk(leaf);
  const auto wi =
      direction_at(options_.map, tree.wo, box.x0 + (box.x1 - box.x0) * u, box.y0 + (box.y1 - box.y0) * v);
  if (!wi) return std::nullopt;
  const double t = double(target_(eval(f_, tree.wo, *wi))) * double(wi->z) *
                   solid_angle_per_area(options_.map, tree.wo, *wi);
  return t > leaf.maximum * height ? wi : std::nullopt;
}

std::optional<DirectionSample<Spectrum>> PaperSampler::finished(const Reading& r, Direction wo,
                                                                const PaperTree& tree, Direction wi) const {
  wi = carried(options_.map, tree.wo, wi, r.wo);
  if (!(wi.z > 0)) return std::nullopt;
  const Spectrum value = eval(f_, r.wo, wi);
  // At the tree's own wo one value serves for both.
  const bool own = r.wo == tree.wo && !(r.shares[1] > 0);
  const double pdf = own ? double(target_(value)) * double(wi.z) / tree.albedo() : density(r, wi);
  return DirectionSample<Spectrum>{fixed_wo_ ? wi : turned(wi, wo), float(pdf),
                                   scaled_value(value, float(double(wi.z) / pdf))};
}

std::optional<DirectionSample<Spectrum>> PaperSampler::draw(Direction wo, UniformBits& u) const {
  if (!(wo.z > 0)) return std::nullopt;
  const Reading r = reading(wo);
  auto [x, y] = wide_point(u);
  const PaperTree& tree = *r.trees[r.shares[1] > 0 && to_unit_double(u()) < r.shares[1] ? 1 : 0];
  if (!(tree.albedo() > 0)) return std::nullopt;
  std::size_t leaf = choose_paper_leaf(tree, options_, x, y);
  for (int i = 0; i < options_.max_trials; ++i) {
    const auto wi = trial(tree, tree.nodes[leaf], x, y, to_unit_double(u()));
    if (wi) return finished(r, wo, tree, *wi);
    const Point again = wide_point(u);
    x = again.x, y = again.y;
    if (options_.retry_from_root) leaf = choose_paper_leaf(tree, options_, x, y);
  }
  return std::nullopt;
}

std::size_t PaperSampler::sample_n(Direction wo, UniformBits& u,
                                   std::span<DirectionSample<Spectrum>> out) const {
  if (!(wo.z > 0)) return 0;
  const Reading r = reading(wo);
  const bool restart = options_.retry_from_root;
  // The second tree's share of N, rounded at random.
  const auto second = std::size_t(r.shares[1] * double(out.size()) + to_unit_double(u()));
  std::size_t filled = 0;
  for (int k = 0; k < 2; ++k) {
    std::size_t wanted = k == 1 ? std::min(second, out.size()) : out.size() - std::min(second, out.size());
    if (wanted == 0 || !(r.trees[k]->albedo() > 0)) continue;
    const PaperTree& tree = *r.trees[k];
    // Retrying from the root, the rejected are divided again; else a leaf keeps trying for its own.
    for (int round = 0; wanted > 0 && round < (restart ? options_.max_trials : 1); ++round) {
      std::size_t rejected = 0;
      divide_paper_count(tree, wanted, u, restart, [&](std::size_t leaf, std::size_t count) {
        for (; count > 0; --count) {
          std::optional<Direction> wi;
          for (int i = 0; !wi && i < (restart ? 1 : options_.max_trials); ++i) {
            const double x = to_unit_double(u()), y = to_unit_double(u());
            wi = trial(tree, tree.nodes[leaf], x, y, to_unit_double(u()));
          }
          rejected += !wi;
          if (!wi) continue;
          if (const auto drawn = finished(r, wo, tree, *wi)) out[filled++] = *drawn;
        }
      });
      wanted = rejected;
    }
  }
  return filled;
}

float PaperSampler::pdf(Direction wo, Direction wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  const Reading r = reading(wo);
  return float(density(r, fixed_wo_ ? wi : turned(wi, {wo.x, -wo.y, wo.z})));
}

std::size_t PaperSampler::bytes() const {
  std::size_t sum = 0;
  for (const PaperTree& t : *trees_) sum += bytes_of(t);
  return sum;
}

}  // namespace reflectree
