// SPDX-License-Identifier: Apache-2.0
// What grown trees tell the cubature of the albedo: where they are fine, and where the attack met a peak
// between the points of a leaf. The first cells of a cubature step over lobes narrower than themselves; the
// trees have met those by thousands of probes.
#pragma once

#include <vector>

#include "build/slab.hpp"

namespace reflectree::detail {

struct TreeMarks {
  Partition partition;
  KnownBox whole;
  std::vector<std::vector<Landmark>> slabs;
  // Of every slab the peak that may weigh most of those that a rule of 17 points in their leaf steps over.
  struct Peak {
    float mass;  // at most, of the albedo
    Known seen_by;
    Vec2<float> p;
  };
  std::vector<Peak> peaks;

  const std::vector<Landmark>& at(const Viewer& viewer) const;
};

TreeMarks tree_marks(const std::vector<Slab>& slabs, const Survey& survey);

}  // namespace reflectree::detail
