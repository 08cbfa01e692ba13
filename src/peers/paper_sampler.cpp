// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_sampler.hpp"

#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/peers/lobe.hpp"
#include "reflectree/peers/paper_choice.hpp"
#include "reflectree/peers/sliced_density.hpp"

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
  if (!f.traits().isotropic && options.phis < 2) {
    throw Error("one azimuth of wo serves isotropic functions only", f.traits().name,
                "tabulate more azimuths, or build the tree for a single wo");
  }
  const auto thetas = std::size_t(options.thetas), phis = std::size_t(options.phis);
  std::vector<PaperTree> trees(phis * thetas);
  const auto work = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double theta = row_theta_o(i % thetas, thetas);
      const Direction wo{float(std::sin(theta)), 0, float(std::cos(theta))};
      const float phi = azimuth_of(i / thetas, phis);
      trees[i] = build_paper_tree(f, target, turned(wo, {std::cos(phi), std::sin(phi), 0}), options);
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
  const auto phis = std::size_t(options_.phis), thetas = trees.size() / phis;
  r.wo = phis > 1 ? wo : Direction{sqrt(wo.x * wo.x + wo.y * wo.y), 0, wo.z};
  const double last = double(thetas - 1);
  const double row = double(theta_of(wo)) / (pi_v<double> / 2) * double(thetas) - 0.5;
  const double place = std::clamp(row, 0.0, last);
  const AzimuthPosition phi = locate_azimuth(phis, wo);
  if (options_.between == PaperBetween::nearest) {
    r.trees[0] = &trees[(phi.t < 0.5f ? phi.below : phi.above) * thetas + std::size_t(std::round(place))];
    return r;
  }
  const auto lower = std::size_t(place);
  const double above = place - double(lower);
  r.count = 0;
  const auto add = [&](std::size_t azimuth, double share) {
    const PaperTree* tree = &trees[azimuth * thetas + lower];
    r.trees[r.count] = tree, r.shares[r.count++] = above > 0 ? share * (1 - above) : share;
    if (above > 0) r.trees[r.count] = tree + 1, r.shares[r.count++] = share * above;
  };
  add(phi.below, 1 - double(phi.t));
  if (phi.t > 0) add(phi.above, double(phi.t));
  return r;
}

// Isotropic functions have but one azimuth, that of r.wo; a fixed wo serves as it is.
Direction PaperSampler::to_tree(const Reading& r, const PaperTree& tree, Direction wi) const {
  if (fixed_wo_ || options_.phis == 1) return wi;
  return turned(turned(wi, {r.wo.x, -r.wo.y, r.wo.z}), tree.wo);
}
Direction PaperSampler::from_tree(const Reading& r, const PaperTree& tree, Direction wi) const {
  if (fixed_wo_ || options_.phis == 1) return wi;
  return turned(turned(wi, {tree.wo.x, -tree.wo.y, tree.wo.z}), r.wo);
}

double PaperSampler::density(const Reading& r, Direction wi) const {
  double sum = 0;  // per area of the disk
  for (int k = 0; k < r.count; ++k) {
    if (!(r.trees[k]->albedo() > 0)) continue;
    const Direction wo = r.trees[k]->wo, own = to_tree(r, *r.trees[k], r.wo);
    const Direction w = carried(options_.map, own, to_tree(r, *r.trees[k], wi), wo);
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
  wi = from_tree(r, tree, carried(options_.map, tree.wo, wi, to_tree(r, tree, r.wo)));
  if (!(wi.z > 0)) return std::nullopt;
  const Spectrum value = eval(f_, r.wo, wi);
  // At the tree's own wo one value serves for both.
  const bool own = r.wo == tree.wo && r.count == 1;
  const double pdf = own ? double(target_(value)) * double(wi.z) / tree.albedo() : density(r, wi);
  return DirectionSample<Spectrum>{fixed_wo_ || options_.phis > 1 ? wi : turned(wi, wo), float(pdf),
                                   scaled_value(value, float(double(wi.z) / pdf))};
}

std::optional<DirectionSample<Spectrum>> PaperSampler::draw(Direction wo, UniformBits& u) const {
  if (!(wo.z > 0)) return std::nullopt;
  const Reading r = reading(wo);
  auto [x, y] = wide_point(u);
  int chosen = 0;
  if (r.count > 1) {  // from the last on: two trees have always been told apart so
    double rest = to_unit_double(u());
    for (chosen = r.count - 1; chosen > 0 && rest >= r.shares[chosen]; --chosen) rest -= r.shares[chosen];
  }
  const PaperTree& tree = *r.trees[chosen];
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
  // The trees' shares of N: one random offset rounds their sums, so that each has the right mean.
  const double offset = to_unit_double(u());
  std::size_t counts[4] = {out.size()};
  double sum = 0;
  for (int k = r.count - 1; k > 0; --k) {
    const std::size_t before = out.size() - counts[0];
    sum += r.shares[k];
    const std::size_t upto = std::clamp(std::size_t(sum * double(out.size()) + offset), before, out.size());
    counts[k] = upto - before, counts[0] = out.size() - upto;
  }
  std::size_t filled = 0;
  for (int k = 0; k < r.count; ++k) {
    std::size_t wanted = counts[k];
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
  return float(density(r, fixed_wo_ || options_.phis > 1 ? wi : turned(wi, {wo.x, -wo.y, wo.z})));
}

std::size_t PaperSampler::bytes() const {
  std::size_t sum = 0;
  for (const PaperTree& t : *trees_) sum += bytes_of(t);
  return sum;
}

}  // namespace reflectree
