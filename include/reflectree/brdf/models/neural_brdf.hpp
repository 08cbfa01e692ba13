// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "reflectree/brdf/brdf.hpp"

namespace reflectree {

// A small network for one isotropic material. Sztrajman, Rainer, Ritschel, Weyrich 2021, "Neural BRDF
// Representation and Importance Sampling": x = (h, d), the half vector turned to azimuth 0 and the
// difference vector; two hidden layers of 21 with max(0, .), then exp(.) - 1, cut at 0.
class NeuralBrdf {
 public:
  static constexpr std::size_t inputs = 6, hidden = 21, outputs = 3;
  static constexpr std::size_t weight_count =
      inputs * hidden + hidden + hidden * hidden + hidden + hidden * outputs + outputs;

  // Weights of layer 1 (row-major, input index first), its biases, and so on; finite.
  NeuralBrdf(std::string name, std::span<const float, weight_count> weights);

  Rgb operator()(const ShadingGeometry<float>& g) const;
  // The same before it is cut at 0.
  Rgb unclipped(const ShadingGeometry<float>& g) const;
  // The layers, of scalars T: float or AffineForm. The second input, the sine of the half vector's azimuth,
  // is always 0.
  template <class T>
  RgbT<T> layers(const T& sin_theta_h, const T& cos_theta_h, const Vec3<T>& d) const;
  BrdfTraits traits() const;

 private:
  static constexpr std::size_t padded = 24;  // whole vectors of 4 and 8
  using Row = std::array<float, padded>;
  std::string name_;
  std::array<Row, inputs> weights_1_{};
  std::array<Row, hidden> weights_2_{};
  std::array<Row, outputs> weights_3_{};  // one row per output: dot products
  Row bias_1_{}, bias_2_{};
  std::array<float, outputs> bias_3_{};
};

}  // namespace reflectree
