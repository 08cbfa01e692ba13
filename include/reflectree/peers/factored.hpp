// SPDX-License-Identifier: Apache-2.0
// The factored function. Lawrence, Rusinkiewicz and Ramamoorthi 2004, "Efficient BRDF Importance Sampling
// Using a Factored Representation": f cos_i ~ sum over l of F_l(wo) u_l(x) v_l(y), x the elevation and y the
// azimuth of the half vector (or of wi itself, their second parametrisation). Two factorisations: theta_o
// against all directions with J terms, then each term's directions, x against y, with K; l runs over the J K
// pairs. A direction is drawn from one term, chosen by F_l, but its density is that of all terms together.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/peers/density.hpp"
#include "reflectree/peers/sliced_density.hpp"

namespace reflectree {

struct FactoredOptions {
  int outer_terms = 4, inner_terms = 2;  // J, K
  int width = 64, height = 32;           // cells of x, of y
  int azimuths = 16;                     // of wo all around, of anisotropic functions
  float floor = 1e-3f;                   // of the mean of each factor: no support is lost
};

// A density over [0, 1], constant over equal cells.
class CellCdf {
 public:
  // cells >= 0; all zero: uniform. None is let below `floor` times the mean.
  explicit CellCdf(std::span<const float> cells, float floor = 0);

  float sample(double u) const;
  float pdf(float x) const;
  std::size_t bytes() const { return sizeof(*this) + cdf_.size() * sizeof(float); }

 private:
  std::vector<float> cdf_;  // upper ends
};

class FactoredDensity {
 public:
  // theta_o ascends; weight: [azimuth][theta_o][l], F_l, sums to 1 at each wo.
  FactoredDensity(SquareChart chart, std::vector<float> theta_o, std::vector<float> weight,
                  std::vector<CellCdf> u, std::vector<CellCdf> v);

  std::optional<DrawnFromDensity> sample(Direction wo, UniformBits& u) const;
  float pdf(Direction wo, Direction wi) const;
  std::size_t bytes() const;

 private:
  struct WeightsAt {
    AnglePosition theta;
    AzimuthPosition phi;
  };
  WeightsAt weights_at(Direction wo) const;
  float weight(const WeightsAt& at, std::size_t term) const;
  float pdf_square(const WeightsAt& at, Vec2<float> p) const;

  SquareChart chart_;
  std::vector<float> theta_o_, weight_;
  std::vector<CellCdf> u_, v_;
};

// `azimuths` of wo all around; 1 for isotropic functions.
FactoredDensity fit_factored(const AnyBrdf& f, Target target, SquareChart chart, std::vector<float> theta_o,
                             const FactoredOptions& options = {}, std::size_t azimuths = 1);

}  // namespace reflectree
