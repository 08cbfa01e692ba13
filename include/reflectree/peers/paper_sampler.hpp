// SPDX-License-Identifier: Apache-2.0
// Montes et al. 2008: a leaf of the tree, then rejection in it. The paper says: density q = f / I_0 for the
// wo of a tree; for isotropic functions, trees at discrete theta_o, with the incident plane at phi_o = 0. How
// many, and what serves a wo between two of them, is read into it, in its favour; so are trees at tabulated
// phi_o, which it leaves to future work, for functions that depend on the azimuth of wo. Directions are drawn from
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

  // Throws Error for an anisotropic function and a single phi.
  PaperSampler(AnyBrdf f, Target target, const PaperOptions& options = {}, const Host& host = {});
  // For this wo, any function; asked about another wo it draws from the same tree.
  PaperSampler(AnyBrdf f, Target target, Direction wo, const PaperOptions& options = {});
  // From trees made elsewhere: [phi_o][theta_o], options.phis of the former.
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
  // What serves one wo: up to four trees with their shares. Directions are carried from the azimuth of wo to that
  // of the tree. wo: as f is asked; of isotropic functions turned to phi_o = 0.
  struct Reading {
    Direction wo;
    int count = 1;
    const PaperTree* trees[4] = {};
    double shares[4] = {1};
  };
  Reading reading(Direction wo) const;
  std::optional<DirectionSample<Value>> draw(Direction wo, UniformBits& u) const;
  // One trial in the leaf, at (u, v) of its rectangle: wi for the tree's wo; nullopt: rejected.
  std::optional<Direction> trial(const PaperTree& tree, const PaperNode& leaf, double u, double v,
                                 double height) const;
  // wi about r.wo, carried to the azimuth of the tree and back.
  Direction to_tree(const Reading& r, const PaperTree& tree, Direction wi) const;
  Direction from_tree(const Reading& r, const PaperTree& tree, Direction wi) const;
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
