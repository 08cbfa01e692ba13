// SPDX-License-Identifier: Apache-2.0
// The parts of the paper's results that need more than one sampler, light or material; each prints its section.
#pragma once

#include <string>

namespace reflectree::study {

// Quadtree and samples over the disk, into `folder` if it is named.
void show_pictures(const std::string& folder);
// 5 x 5 and 10 x 10 uniform samples, jittered, against 100 adaptive ones in one call.
void show_few_against_many();
// Microseconds to a relative RMSE of 1 %.
void show_time();
// Memory and precomputation of the measured materials.
struct Measured {
  bool all = false;  // of REFLECTREE_DATA; else every twelfth
  std::string merl;  // a folder of MERL .binary files, each of which is taken; "": none
};
void show_measured(const Measured& what);

}  // namespace reflectree::study
