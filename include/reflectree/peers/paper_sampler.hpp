// SPDX-License-Identifier: Apache-2.0
// Montes et al. 2008: a leaf of the tree, then rejection in it. The paper says: density q = f / I_0 for the
// wo of a tree; for isotropic functions, trees at discrete theta_o, with the incident plane at phi_o = 0. How
// many, and what serves a wo between two of them, is read into it, in its favour: directions are drawn from
// the tables' own functions and weighted by their density, f(tabulated wo, wi) / I_0, and the weight
// f_cos / pdf carries the rest. So nothing is biased by the tables' distance, wherever one of them has the
// support of f; the variance grows with it. Ninety trees, at the middle of each degree: MERL's own step.
//
// What stays wrong is the paper's: the density claimed is right only as far as the estimates of I and M are
// (paper_statistics.hpp), and the registry says so: the mean weight of nine models lies within 0.8 % of the
// albedo, mostly above, with 8 x 8 points per node, within 0.1 % with 32 x 32 at four times the leaves.
#pragma once

#include <memory>
#include <span>

#include "reflectree/host.hpp"
#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/peers/paper_tree.hpp"
#include "reflectree/sampler/direction_sample.hpp"

namespace reflectree {

class PaperSampler {
 public:
  using Value = Spectrum;

  // Isotropic functions only; throws Error.
  PaperSampler(AnyBrdf f, Target target, const PaperOptions& options = {}, const Host& host = {});
  // For this wo, any function; asked about another wo it draws from the same tree.
  PaperSampler(AnyBrdf f, Target target, Direction wo, const PaperOptions& options = {});
  // From trees made elsewhere, in order of theta_o.
  PaperSampler(AnyBrdf f, Target target, std::vector<PaperTree> trees, bool fixed_wo,
               const PaperOptions& options);

  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    if constexpr (std::same_as<U, UniformBits>) {
      return draw(wo, u);
    } else {
      UniformBits bits(u);
      auto drawn = draw(wo, bits);
      u = bits.rest();
      return drawn;
    }
  }
  // N divided among the leaves by the CDF of the children, then rejection in each; ordered by leaf.
  std::size_t sample_n(Direction wo, UniformBits& u, std::span<DirectionSample<Value>> out) const;

  float pdf(Direction wo, Direction wi) const;
  std::size_t bytes() const;
  const std::vector<PaperTree>& trees() const { return *trees_; }

 private:
  // What serves one wo: one tree, or two with their shares. wo is turned to phi_o = 0 unless it is fixed.
  struct Reading {
    Direction wo;
    const PaperTree* trees[2] = {nullptr, nullptr};
    double shares[2] = {1, 0};
  };
  Reading reading(Direction wo) const;
  std::optional<DirectionSample<Value>> draw(Direction wo, UniformBits& u) const;
  // One trial in the leaf, at (u, v) of its rectangle: wi for the tree's wo; nullopt: rejected.
  std::optional<Direction> trial(const PaperTree& tree, const PaperNode& leaf, double u, double v,
                                 double height) const;
  // The sample for the true wo, from a direction that `tree` accepted; nullopt: below its horizon.
  std::optional<DirectionSample<Value>> finished(const Reading& r, Direction wo, const PaperTree& tree,
                                                 Direction wi) const;
  // Per solid angle, of wi for r.wo.
  double density(const Reading& r, Direction wi) const;

  AnyBrdf f_;
  Target target_;
  PaperOptions options_;
  bool fixed_wo_ = false;
  std::shared_ptr<const std::vector<PaperTree>> trees_;
};

}  // namespace reflectree
