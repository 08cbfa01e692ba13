// SPDX-License-Identifier: Apache-2.0
// The order of the work: a scene's samplers, its converged picture, its cells. Rounds go through all samplers
// before the next begins, so that what the machine does meanwhile meets them alike.
#pragma once

#include "measure.hpp"
#include "report.hpp"

namespace reflectree::pictures {

struct Place {
  std::string folder;  // of the page and its pictures
  std::string scenes;
  unsigned threads = 1;
  Host host;  // of one thread
  std::string cells() const { return folder + "/pictures-kept/cells.tsv"; }
  std::string film(const std::string& name) const { return folder + "/pictures-kept/" + name + ".sums"; }
};

// What cells must agree in.
std::string key_of(const Plan& plan);

// Adds the cells that are not there yet, keeping each as it is done. Throws Error, Cancelled.
void study_scene(Results& results, const Plan& plan, const Place& place, const Setting& setting);

}  // namespace reflectree::pictures
