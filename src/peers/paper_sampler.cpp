// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_sampler.hpp"

#include "reflectree/error.hpp"
#include "reflectree/math/square_maps.hpp"
#include "reflectree/peers/lobe.hpp"

namespace reflectree {

namespace {

// w turned about the normal so that the x axis goes to the azimuth of wo.
Direction turned(Direction w, Direction wo) {
  const float r = sqrt(wo.x * wo.x + wo.y * wo.y);
  if (!(r > 0)) return w;
  const float c = wo.x / r, s = wo.y / r;
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
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

const PaperTree& PaperSampler::tree_of(Direction wo) const {
  const std::size_t n = trees_->size();
  return (*trees_)[std::min(std::size_t(theta_of(wo) / (pi / 2) * float(n)), n - 1)];
}

std::optional<DirectionSample<Spectrum>> PaperSampler::trial(const PaperTree& tree, const PaperNode& leaf,
                                                             Direction wo, UniformBits& u) const {
  const PaperBox box = clip_to_disk(leaf);
  const double x = box.x0 + (box.x1 - box.x0) * to_unit_double(u());
  const double y = box.y0 + (box.y1 - box.y0) * to_unit_double(u());
  const double z = leaf.maximum * to_unit_double(u());
  if (x * x + y * y >= 1) return std::nullopt;
  const Vec2<float> p{float(x), float(y)};
  Direction wi =
      options_.area_preserving ? disk_to_hemisphere_equal_area(p) : disk_to_hemisphere_projected(p);
  if (!fixed_wo_) wi = turned(wi, wo);
  if (!(wi.z > 0)) return std::nullopt;
  const Spectrum value = eval(f_, wo, wi);
  const double t = double(target_(value));
  if (!(t * (options_.area_preserving ? 2 * double(wi.z) : 1) > z)) return std::nullopt;
  const double albedo = tree.nodes[0].integral;
  return DirectionSample<Spectrum>{wi, float(t * double(wi.z) / albedo), scaled(value, float(albedo / t))};
}

std::optional<DirectionSample<Spectrum>> PaperSampler::draw(Direction wo, UniformBits& u) const {
  if (!(wo.z > 0)) return std::nullopt;
  const PaperTree& tree = tree_of(wo);
  if (!(tree.nodes[0].integral > 0)) return std::nullopt;
  const bool restart = options_.retry_from_root;
  std::size_t leaf = 0;
  for (int i = 0; i < options_.max_trials; ++i) {
    if (i == 0 || restart) leaf = choose_paper_leaf(tree, to_unit_double(u()), restart);
    if (auto drawn = trial(tree, tree.nodes[leaf], wo, u)) return drawn;
  }
  return std::nullopt;
}

std::size_t PaperSampler::sample_n(Direction wo, UniformBits& u,
                                   std::span<DirectionSample<Spectrum>> out) const {
  if (!(wo.z > 0)) return 0;
  const PaperTree& tree = tree_of(wo);
  if (!(tree.nodes[0].integral > 0)) return 0;
  const bool restart = options_.retry_from_root;
  std::vector<std::size_t> counts(tree.nodes.size());
  std::size_t filled = 0, wanted = out.size();
  // Retrying from the root, the rejected are divided again; else a leaf keeps trying for its own.
  for (int round = 0; wanted > 0 && round < (restart ? options_.max_trials : 1); ++round) {
    divide_paper_count(tree, wanted, u, restart, counts);
    wanted = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      for (; counts[i] > 0; --counts[i]) {
        std::optional<DirectionSample<Spectrum>> drawn;
        for (int k = 0; !drawn && k < (restart ? 1 : options_.max_trials); ++k) {
          drawn = trial(tree, tree.nodes[i], wo, u);
        }
        if (drawn) {
          out[filled++] = *drawn;
        } else {
          ++wanted;
        }
      }
    }
  }
  return filled;
}

float PaperSampler::pdf(Direction wo, Direction wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  const double albedo = tree_of(wo).nodes[0].integral;
  return albedo > 0 ? float(double(target_(eval(f_, wo, wi))) * double(wi.z) / albedo) : 0;
}

std::size_t PaperSampler::bytes() const {
  std::size_t sum = 0;
  for (const PaperTree& t : *trees_) sum += sizeof(t) + t.nodes.size() * sizeof(PaperNode);
  return sum;
}

}  // namespace reflectree
