// SPDX-License-Identifier: Apache-2.0
// Slabs under construction as the canonical data that is kept.
#pragma once

#include "slab.hpp"

namespace reflectree::detail {

Partition partition_of(const std::vector<Slab>& slabs, const std::vector<KnownParameter>& parameters);
// The slab of such a partition of the whole that holds a viewer.
std::size_t slab_index(const Partition& partition, const Viewer& viewer, const KnownBox& whole);
// The tree of a slab with its bounds, in integer masses that are rounded up.
MajorantTree majorant_tree(const Slab& slab);
DensityTree density_tree(const Slab& slab);
// Gives every leaf, in preorder, the volume under its bound; masses are rounded up.
void set_volumes(MajorantTree& tree, const std::vector<double>& volumes);

}  // namespace reflectree::detail
