// SPDX-License-Identifier: Apache-2.0
// The table of the albedo, judged once trees have been grown: lobes narrower than the first cells of a cubature
// are met by some of its integrals and stepped over by others, or by all.
#pragma once

#include "tree_marks.hpp"

namespace reflectree::detail {

// A viewer for whom the table of the albedo is not what cubature finds.
struct WrongAlbedo {
  Known known;
  double table, found, miss;  // miss: relative, beyond what the cubature leaves open
};

// Asks a cubature of fine cells that closes in on the marks, for viewers who met peaks, where the table bends,
// and anywhere. The worst first.
std::vector<WrongAlbedo> judge_by_trees(const std::vector<Slab>& slabs, const TreeMarks& marks,
                                        const Survey& survey, std::uint64_t seed);

}  // namespace reflectree::detail
