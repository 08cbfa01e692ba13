// SPDX-License-Identifier: Apache-2.0
// Montes et al. 2008: a leaf of the tree, then rejection in it, by f at the true wo. Trees stand at the
// middles of equal ranges of theta_o, the incident plane at phi_o = 0, or there is a single one for a given
// wo. The claimed density is the paper's, f / I_0, with the I_0 of the tree: wrong by as much as the
// estimates of I and M are, and between two tabulated elevations by as much as f moves. It is biased, and the
// registry says so.
#pragma once

#include <memory>

#include "reflectree/peers/paper_tree.hpp"
#include "reflectree/sampler/direction_sample.hpp"
#include "reflectree/sampler/host.hpp"

namespace reflectree {

class PaperSampler {
 public:
  using Value = Spectrum;

  // Isotropic functions only; throws Error.
  PaperSampler(AnyBrdf f, Target target, const PaperOptions& options = {}, const Host& host = {});
  // For this wo alone, any function; asked about another wo it takes the same tree.
  PaperSampler(AnyBrdf f, Target target, Direction wo, const PaperOptions& options = {});
  // From trees made elsewhere, in order of theta_o.
  PaperSampler(AnyBrdf f, Target target, std::vector<PaperTree> trees, bool fixed_wo,
               const PaperOptions& options);

  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    std::optional<DirectionSample<Value>> out;
    with_bits(u, [&](UniformBits& bits) { out = draw(wo, bits); });
    return out;
  }
  // N divided among the leaves by the CDF of the children, then rejection in each; ordered by leaf.
  // Allocates its counts: one traversal serves all N.
  std::size_t sample_n(Direction wo, UniformBits& u, std::span<DirectionSample<Value>> out) const;

  float pdf(Direction wo, Direction wi) const;
  std::size_t bytes() const;
  const std::vector<PaperTree>& trees() const { return *trees_; }

 private:
  template <class Body>
  static void with_bits(UniformBits& u, const Body& body) {
    body(u);
  }
  template <class Body>
  static void with_bits(Pcg32& u, const Body& body) {
    UniformBits bits(u);
    body(bits);
    u = bits.rest();
  }
  const PaperTree& tree_of(Direction wo) const;
  std::optional<DirectionSample<Value>> draw(Direction wo, UniformBits& u) const;
  // One trial in the leaf; nullopt: rejected.
  std::optional<DirectionSample<Value>> trial(const PaperTree& tree, const PaperNode& leaf, Direction wo,
                                              UniformBits& u) const;

  AnyBrdf f_;
  Target target_;
  PaperOptions options_;
  bool fixed_wo_ = false;
  std::shared_ptr<const std::vector<PaperTree>> trees_;
};

}  // namespace reflectree
