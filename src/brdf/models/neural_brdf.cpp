// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/models/neural_brdf.hpp"

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/tables/difference_vector.hpp"
#include "reflectree/brdf/tables/enclosed_difference.hpp"

namespace reflectree {

namespace {

// bias + x . weights, of rows of weights by inputs, which the compiler keeps in vectors, and of one row, in four
// partial sums for the same reason. Over boxes a sum is one form.
template <std::size_t inputs, std::size_t size>
std::array<float, size> layer(const std::array<float, size>& bias,
                              const std::array<std::array<float, size>, inputs>& weights,
                              std::span<const float> x) {
  std::array<float, size> sums = bias;
  for (std::size_t i = 0; i < inputs; ++i) {
    for (std::size_t j = 0; j < size; ++j) sums[j] += x[i] * weights[i][j];
  }
  return sums;
}
template <std::size_t size>
float unit(float bias, const std::array<float, size>& weights, const std::array<float, size>& x) {
  float lanes[4] = {bias, 0, 0, 0};
  for (std::size_t j = 0; j < size; j += 4) {
    for (std::size_t k = 0; k < 4; ++k) lanes[k] += x[j + k] * weights[j + k];
  }
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}
template <std::size_t inputs, std::size_t size>
std::array<AffineForm, size> layer(const std::array<float, size>& bias,
                                   const std::array<std::array<float, size>, inputs>& weights,
                                   std::span<const AffineForm> x) {
  std::array<AffineForm, size> sums;
  for (std::size_t j = 0; j < size; ++j) {
    std::array<float, inputs> column;
    for (std::size_t i = 0; i < inputs; ++i) column[i] = weights[i][j];
    sums[j] = weighted_sum(bias[j], column, x.first(inputs));
  }
  return sums;
}
template <std::size_t size>
AffineForm unit(float bias, const std::array<float, size>& weights, const std::array<AffineForm, size>& x) {
  return weighted_sum(bias, weights, x);
}

template <class T>
RgbT<T> clipped(const RgbT<T>& f) {
  return {max(f.r, T(0.f)), max(f.g, T(0.f)), max(f.b, T(0.f))};
}

class NetworkEnclosure final : public BrdfEnclosure {
 public:
  explicit NetworkEnclosure(const NeuralBrdf& network) : network_(network) {}
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    return detail::by_azimuth(detail::half_frame(g), [&](const detail::HalfFrame& frame) {
      const auto [sin_h, d] = detail::difference_vector(g, frame);
      return clipped(network_.layers(sin_h, g.cos_theta_h, d));
    });
  }

 private:
  NeuralBrdf network_;
};

}  // namespace

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

Rgb NeuralBrdf::operator()(const ShadingGeometry<float>& g) const { return clipped(unclipped(g)); }

Rgb NeuralBrdf::unclipped(const ShadingGeometry<float>& g) const {
  const auto [sin_h, d] = detail::difference_vector(g);
  return layers(sin_h, g.cos_theta_h, d);
}

template <class T>
RgbT<T> NeuralBrdf::layers(const T& sin_theta_h, const T& cos_theta_h, const Vec3<T>& d) const {
  const std::array<T, inputs> x{sin_theta_h, T(0.f), cos_theta_h, d.x, d.y, d.z};
  std::array<T, padded> layer_1 = layer(bias_1_, weights_1_, std::span<const T>(x));
  for (T& v : layer_1) v = max(v, T(0.f));
  std::array<T, padded> layer_2 = layer(bias_2_, weights_2_, std::span<const T>(layer_1).first(hidden));
  for (T& v : layer_2) v = max(v, T(0.f));
  const auto output = [&](std::size_t c) {
    return expm1(min(unit(bias_3_[c], weights_3_[c], layer_2), T(80.f)));  // finite whatever the weights
  };
  return {output(0), output(1), output(2)};
}

BrdfTraits NeuralBrdf::traits() const {
  BrdfTraits traits;
  traits.isotropic_by_formula = true;
  traits.name = name_;
  traits.enclosure = std::make_shared<NetworkEnclosure>(*this);
  return traits;
}

}  // namespace reflectree
