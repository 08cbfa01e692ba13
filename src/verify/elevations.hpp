// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree::detail {

// From a cosine: near the horizon an angle in float does not know it.
Direction viewer(double cos_theta, double phi);

// Any azimuth; theta_o uniform from 0 to 89.9 degrees.
Direction random_viewer(Pcg32& u);

// `count` elevations, one in each of as many equal strata of [0, 89.9) degrees, at any azimuth.
std::vector<Direction> stratified_viewers(std::size_t count, Pcg32& u);

// Either side of the borders of slabs, a few roundings away, at any azimuth; at most `count` borders of each
// partition, chosen at random where there are more.
std::vector<Direction> border_viewers(const PackedSampler& packed, std::size_t count, Pcg32& u);

// Cosines at which an albedo table is compared: nodes, and middles between two, where a linear interpolation
// errs most. All where there are few; else half of `count` about the nodes that bend the table most, where
// one that is wrong stands out, and the rest at random.
std::vector<double> table_places(const PackedSampler& packed, std::size_t count, Pcg32& u);

}  // namespace reflectree::detail
