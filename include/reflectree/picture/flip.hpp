// SPDX-License-Identifier: Apache-2.0
// How different two pictures look where they take turns on a screen: FLIP for low dynamic range (Andersson,
// Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild 2020, "FLIP: A Difference Evaluator for Alternating
// Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2)). Both are tone-mapped as write_png does: times
// 2^exposure, clipped to [0, 1].
#pragma once

#include "reflectree/picture/image.hpp"

namespace reflectree {

struct FlipOptions {
  // Of a screen 0.7 m wide with 3840 pixels, seen from 0.7 m: the authors' (eq. 1, sect. 4.1.1).
  double pixels_per_degree = 67.0206;
  float exposure = 0;
};

// One channel, "FLIP", in [0, 1]. Throws Error unless both have R, G and B, in linear light, and one size.
Image flip_difference(const Image& reference, const Image& test, const FlipOptions& options = {});
double image_mean(const Image& one_channel);
// Black, red, yellow, white: for a PNG.
Image heat_image(const Image& one_channel);

}  // namespace reflectree
