// SPDX-License-Identifier: Apache-2.0
#include "visible_slope.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/math/fast_functions.hpp"

namespace reflectree::render {

// Single precision (Giles 2010, "Approximating the erfinv function", GPU Computing Gems 2, table 5).
float inverse_erf(float x) {
  x = clamp(x, -.99999994f, .99999994f);
  const float w = -std::log((1 - x) * (1 + x));
  if (w < 5) {
    const float v = w - 2.5f;
    float p = 2.81022636e-08f;
    for (const float c : {3.43273939e-07f, -3.5233877e-06f, -4.39150654e-06f, .00021858087f, -.00125372503f,
                          -.00417768164f, .246640727f, 1.50140941f}) {
      p = c + p * v;
    }
    return p * x;
  }
  const float v = std::sqrt(w) - 3;
  float p = -.000200214257f;
  for (const float c : {.000100950558f, .00134934322f, -.00367342844f, .00573950773f, -.0076224613f,
                        .00943887047f, 1.00167406f, 2.83297682f}) {
    p = c + p * v;
  }
  return p * x;
}

namespace {

constexpr float farthest = 4;  // erfc(4) = 1.5e-8

// Twice the integral up to x is  (1 + erf x) cos + exp(-x^2) sin / sqrt pi.  It grows up to x = cot theta,
// with derivative  2 exp(-x^2) (cos - x sin) / sqrt pi,  and is inverted by Halley's steps, of third order.
class Slopes {
 public:
  Slopes(float cosine, float sine)
      : cosine_(cosine),
        sine_(sine),
        end_(min(cosine / sine, farthest)),
        total_(integral(end_, gauss(end_))) {}

  float at(float u, float start) const {
    const float goal = u * total_;
    float low = -farthest, high = end_, x = min(start, end_);
    for (int i = 0; i < 16; ++i) {
      const float g = gauss(x), error = integral(x, g) - goal, facing = cosine_ - x * sine_;
      (error > 0 ? high : low) = x;
      const float slope = 2 * inverse_root_pi * g * facing;
      const float next = x - error / (slope + error * (x + .5f * sine_ / facing));
      const bool inside = next >= low && next <= high;
      x = inside ? next : (low + high) / 2;
      if (inside && std::abs(error) < .004f * slope)
        break;  // what is left is about the cube of error / slope
    }
    return x;
  }

 private:
  static float gauss(float x) { return exp_of_negative(-x * x); }
  float integral(float x, float g) const {
    const float outside = g * scaled_erfc(std::abs(x));
    return (x < 0 ? outside : 2 - outside) * cosine_ + inverse_root_pi * g * sine_;
  }

  float cosine_, sine_, end_, total_;
};

// Where to start: the slopes for some wo and u, so that one step is mostly enough. Rows are equidistant in
// sin / (sin + cos).
struct Starts {
  static constexpr int rows = 32, columns = 64;
  float x[rows + 1][columns + 1];

  Starts() {
    for (int i = 0; i <= rows; ++i) {
      const float s = clamp(float(i) / rows, 1e-3f, 1 - 1e-4f), size = std::sqrt(s * s + (1 - s) * (1 - s));
      const Slopes slopes((1 - s) / size, s / size);
      for (int j = 0; j <= columns; ++j) x[i][j] = slopes.at(clamp(float(j) / columns, 1e-4f, 1 - 1e-4f), 0);
    }
  }
  float operator()(float cosine, float sine, float u) const {
    const float row = sine / (sine + cosine) * rows, column = u * columns;
    const int i = std::min(int(row), rows - 1), j = std::min(int(column), columns - 1);
    const float t = column - float(j);
    return linear_mix(row - float(i), linear_mix(t, x[i][j], x[i][j + 1]),
                      linear_mix(t, x[i + 1][j], x[i + 1][j + 1]));
  }
};
const Starts starts;

}  // namespace

// Invented for visible normals by Heitz & d'Eon 2014; Jakob 2014, "An Improved Visible Normal Sampling
// Routine for the Beckmann Distribution", inverts by Newton's steps in erf x from a fit.
float visible_slope(float cosine, float sine, float u) {
  if (!(sine > 1e-4f * cosine)) return inverse_erf(2 * u - 1);
  return Slopes(cosine, sine).at(u, starts(cosine, sine, u));
}

}  // namespace reflectree::render
