// SPDX-License-Identifier: Apache-2.0
// Arrays as NumPy's .npy files (format 1.0, little-endian, C order).
#pragma once

#include <span>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// The bytes of a file that numpy.load() reads as a float32 or float64 array of that shape. The product of the
// shape is the number of values.
Bytes encode_npy(std::span<const float> values, std::span<const std::size_t> shape);
Bytes encode_npy(std::span<const double> values, std::span<const std::size_t> shape);

}  // namespace reflectree
