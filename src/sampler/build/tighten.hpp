// SPDX-License-Identifier: Apache-2.0
// Estimated bounds of exact mode: what "exact" rests on for a black box. After growth each leaf's bound is
// the largest value seen on its grid; here it is attacked, by local maximisation from that point and by
// random probes where the sampler itself would land, and raised. And the same doubt for the densities of
// one-shot mode, where a value between the points of a grid costs variance.
#pragma once

#include "grow.hpp"

namespace reflectree::detail {

// Raises share and cost of the leaves that were not attacked yet, by local maximisation in (theta_o, x, y), and
// adds the margin for what it may still miss.
void maximise(std::vector<Slab>& slabs, const Survey& survey);

// Random probes, `per_leaf` on average and in proportion to the leaf's cost, in the slabs whose mass of
// overshoot is above `accepted`; every overshoot raises its leaf past the value found. Slabs get the mass seen,
// before the raise.
void probe(std::vector<Slab>& slabs, float per_leaf, std::uint64_t seed, float accepted,
           const Survey& survey);

// Raises the bounds of leaves to what f is at points that were met outside of an attack.
void raise_at(std::vector<Slab>& slabs, std::span<const FieldPoint> points, const Survey& survey);

// Random probes in every leaf of one-shot trees: where they show, beyond doubt, a larger root mean square
// than the grid did, the leaf's cost is raised to it, so that growth goes on there.
void probe_density(std::vector<Slab>& slabs, std::uint64_t seed, const Survey& survey);

}  // namespace reflectree::detail
