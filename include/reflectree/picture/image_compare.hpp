// SPDX-License-Identifier: Apache-2.0
// How two pictures of the same scene differ, channel by channel; by z-scores where both carry the standard
// errors of their pixels.
#pragma once

#include <array>
#include <optional>

#include "reflectree/picture/image.hpp"

namespace reflectree {

struct ChannelDifference {
  std::string channel;
  double mean_a = 0, mean_b = 0;
  double mean_error = 0;    // standard error of mean_a - mean_b; 0 where it is not known
  double mse = 0;           // mean of (a - b)^2
  double relative_mse = 0;  // mean of (a - b)^2 / (b^2 + 0.01)
};

inline constexpr std::array<double, 7> z_probabilities{.01, .05, .25, .5, .75, .95, .99};
// Quantiles of (a - b) / standard error, over all channels, of blocks of pixels; a standard normal has -2.33,
// -1.64, -0.67, 0, 0.67, 1.64, 2.33. Left out: blocks whose error is not known or zero, and those with a
// pixel whose relative standard error in `b` exceeds `trust`: it comes from few bright samples (caustics).
struct ZScores {
  std::array<double, 7> quantiles{};
  std::size_t blocks = 0, left_out = 0;
};

struct ImageDifference {
  std::vector<ChannelDifference> channels;  // R, G, B
  std::optional<ZScores> z;
};

struct ImageCompareOptions {
  int block = 8;  // its side in pixels: a sum of many is nearer to a normal
  double trust = .05;
};

// Where a is brighter than b, red; where darker, blue; full at a difference of `scale` of b; blocks averaged.
Image difference_map(const Image& a, const Image& b, int block, double scale);

// Throws Error unless both have R, G and B and one size.
ImageDifference compare_images(const Image& a, const Image& b, const ImageCompareOptions& options = {});

}  // namespace reflectree
