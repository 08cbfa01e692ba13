// SPDX-License-Identifier: Apache-2.0
// How cost grows with what is outside of one sampler; each prints its section.
#pragma once

#include <string>

namespace reflectree::study {

// CPU seconds of a build and of a sample when 1, 2, ... threads work at once.
void show_threads();
// Samples that go from one of N materials to another.
void show_materials(const std::string& folder);
// The general methods against the sharpness of GGX, with fitted exponents; the plot into `folder`
// if it is named.
void show_competitors(const std::string& folder);

}  // namespace reflectree::study
