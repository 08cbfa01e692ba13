// SPDX-License-Identifier: Apache-2.0
// A cosine lobe and one specular lobe, fitted to any BRDF by minimising the relative second moment of the
// weight, int T^2 / p / (int T)^2 = 1 + relVar, over a grid of widths and weights. Of anisotropic functions the
// visible normals have two widths, along the axis that the function tells of and across it.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/host.hpp"
#include "reflectree/peers/lobe.hpp"

namespace reflectree {

struct FitOptions {
  LobeKind lobe = LobeKind::ggx;  // or power, with n = 2 / alpha^2 - 2
  int thetas = 16;                // elevations looked at
  int azimuths = 4;               // and azimuths in half a turn, of anisotropic functions
  bool each_theta = false;        // true: tuned by an oracle for each of them; false: one mixture for all
  int widths = 28;                // alpha from 0.002 to 1, in equal ratios
  int weights = 24;               // of the cosine lobe, from 0.005 to 0.995, graded towards both ends
  int points_a_width = 128;       // quadrature points drawn from each candidate lobe
  std::uint64_t seed = 1;
};

// One mixture for all elevations minimises the mean of log(1 + relVar), which no single angle dominates.
LobeMixture fit_mixture(const AnyBrdf& f, Target target, const FitOptions& options = {},
                        const Host& host = {});

}  // namespace reflectree
