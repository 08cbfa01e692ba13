// SPDX-License-Identifier: Apache-2.0
// What the study in pictures measures, as plain values: a cell is one sampler's picture of one scene by one
// method from one seed, and how far it is from the converged picture. A file keeps the cells that are done.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace reflectree::pictures {

// relMSE, the mean over pixels and channels of (a - b)^2 / (b^2 + 0.01), less the converged picture's own
// noise. `trimmed`: without the one pixel in a thousand where it is largest, which a few bright paths fill.
struct RelativeError {
  double all = 0, trimmed = 0;
};

struct Shot {
  int samples = 0;     // per pixel
  double seconds = 0;  // CPU time of the one thread that made it
  RelativeError error;
};

struct PictureCell {
  std::string scene, method, sampler;
  int round = 0;  // each has a seed of its own
  Shot equal;     // at the samples that all have
  Shot timed;     // at those that fit into the time of our `equal`
};

// A sampler that does not serve.
struct Absence {
  std::string scene, method, sampler, why;
};

struct Results {
  std::string key;  // what cells must agree in to stand in one table
  std::vector<PictureCell> cells;
  std::vector<Absence> absences;

  // In order of rounds.
  std::vector<const PictureCell*> of(std::string_view scene, std::string_view method,
                                     std::string_view sampler) const;
};

void keep(const std::string& path, const Results& results);
// Throws Error for a file that is damaged or whose key is another.
Results kept(const std::string& path, const std::string& key);

}  // namespace reflectree::pictures
