// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/models/neural_brdf.hpp"

#include "reflectree/brdf/tables/difference_vector.hpp"

namespace reflectree {

NeuralBrdf::NeuralBrdf(std::string name, std::span<const float, weight_count> weights)
    : name_(std::move(name)) {
  const float* next = weights.data();
  for (Row& row : weights_1_) {
    for (std::size_t j = 0; j < hidden; ++j) row[j] = *next++;
  }
  for (std::size_t j = 0; j < hidden; ++j) bias_1_[j] = *next++;
  for (Row& row : weights_2_) {
    for (std::size_t j = 0; j < hidden; ++j) row[j] = *next++;
  }
  for (std::size_t j = 0; j < hidden; ++j) bias_2_[j] = *next++;
  for (std::size_t i = 0; i < hidden; ++i) {
    for (Row& row : weights_3_) row[i] = *next++;
  }
  for (float& b : bias_3_) b = *next++;
}

Rgb NeuralBrdf::operator()(const ShadingGeometry<float>& g) const {
  const Rgb f = unclipped(g);
  return {max(f.r, 0.f), max(f.g, 0.f), max(f.b, 0.f)};
}

Rgb NeuralBrdf::unclipped(const ShadingGeometry<float>& g) const {
  const auto [sin_h, d] = detail::difference_vector(g);
  const std::array<float, inputs> x{sin_h, 0.f, g.cos_theta_h, d.x, d.y, d.z};

  Row layer_1 = bias_1_, layer_2 = bias_2_;
  for (std::size_t i = 0; i < inputs; ++i) {
    for (std::size_t j = 0; j < padded; ++j) layer_1[j] += x[i] * weights_1_[i][j];
  }
  for (float& v : layer_1) v = max(v, 0.f);
  for (std::size_t i = 0; i < hidden; ++i) {
    for (std::size_t j = 0; j < padded; ++j) layer_2[j] += layer_1[i] * weights_2_[i][j];
  }
  for (float& v : layer_2) v = max(v, 0.f);
  const auto output = [&](std::size_t c) {
    float lanes[4] = {bias_3_[c], 0, 0, 0};  // four partial sums, which the compiler may keep in one vector
    for (std::size_t j = 0; j < padded; j += 4) {
      for (std::size_t k = 0; k < 4; ++k) lanes[k] += layer_2[j + k] * weights_3_[c][j + k];
    }
    const float sum = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    return std::expm1(min(sum, 80.f));  // finite whatever the weights
  };
  return {output(0), output(1), output(2)};
}

BrdfTraits NeuralBrdf::traits() const {
  BrdfTraits traits;
  traits.isotropic_by_formula = true;
  traits.name = name_;
  return traits;
}

}  // namespace reflectree
