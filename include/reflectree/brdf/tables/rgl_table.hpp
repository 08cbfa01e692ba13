// SPDX-License-Identifier: Apache-2.0
// A measured isotropic BRDF in the parameterisation of Dupuy and Jakob 2018, "An Adaptive
// Parameterization for Efficient Material Acquisition and Rendering", the one of the EPFL RGL database:
//   f cos_i = S(V^-1(m); theta_o) D(m) / (4 sigma(theta_o))
// with m the half vector on the square, V the warp whose density is the distribution of visible normals,
// S the measured colour, D the normal distribution and sigma its projected area. Known direction: wo.
// Noise leaves negative colours in files. They are interpolated as they are and f is cut at 0: cutting them
// first would brighten their neighbours.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "reflectree/brdf/brdf.hpp"

namespace reflectree {

// What an isotropic RGB file holds. Angles theta become u = sqrt(2 theta / pi), azimuths
// v = phi / (2 pi) + 1/2; the last index is u.
struct RglFields {
  std::string name = "rgl";
  std::vector<float> theta_o;  // radians, ascending: nodes of the known direction, at least 2
  std::vector<float> sigma;    // [u]
  std::vector<float> ndf;      // [u], sr^-1
  std::vector<float> vndf;     // [theta_o][warp_height][warp_width]: unnormalised density on the square
  int warp_width = 0, warp_height = 0;
  std::vector<float> rgb;  // [theta_o][3][colour_height][colour_width]
  int colour_width = 0, colour_height = 0;
  bool jacobian = true;  // false: rgb is f cos_i already, without D / (4 sigma)
};

// f(wo, wi) in sr^-1, Rgb. Finite and not negative everywhere; cos_theta_i below 1e-6 counts as 1e-6.
class RglTable {
 public:
  // Sizes must agree, theta_o ascend, and sigma and vndf be no less than 0, as the reader makes sure;
  // asserted but for the last.
  explicit RglTable(const RglFields& fields);

  Rgb operator()(const ShadingGeometry<float>& g) const;
  // The same before it is cut at 0, where the noise of measurement shows.
  Rgb unclipped(const ShadingGeometry<float>& g) const;
  // Batches, three channels per pair, zero below the surface: pairs in a row that share wo share its look-up.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const;
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const;
  BrdfTraits traits() const;

  std::string name;

 private:
  // What depends on wo alone: its pair of nodes, the weight of the upper one, and 4 sigma.
  struct Known {
    std::size_t pair;
    float t1, four_sigma;
  };
  Known known(const ShadingGeometry<float>& g) const;

  // Nodes of two neighbouring theta_o lie side by side, so that a look-up touches two cache lines.
  struct WarpNode {
    float cdf[2], pdf[2];  // integral along u up to the node; density at the node
  };
  struct WarpRow {
    float cdf[2], mass[2];  // integral along v up to the row; integral along the row
  };
  struct ColourNode {
    float rgb[2][4];
  };
  // The stages of a look-up: where the half vector lies in the warp, where that leads in the colours, and
  // what stands there. Batches take many through each, since both tables are larger than the cache.
  struct InWarp {
    const WarpNode* node;
    const WarpRow* rows;
    float x, y, u;  // fractions; u: of the half vector's elevation
  };
  struct InColour {
    const ColourNode* node;
    float x, y;
  };
  InWarp in_warp(const Known& known, const ShadingGeometry<float>& g) const;
  InColour in_colour(const Known& known, const InWarp& at) const;
  Rgb unclipped(const Known& known, float u, const InColour& at, float cos_theta_i) const;

  template <class Table>
  friend struct RglSlices;  // reads the same tables, for the enclosure

  struct Tables {
    std::vector<WarpNode> warp;
    std::vector<WarpRow> rows;
    std::vector<ColourNode> colour;
  };
  std::vector<float> theta_o_, sigma_, ndf_;
  std::shared_ptr<const Tables> tables_;  // copies share it
  const WarpNode* warp_;                  // [theta_o pair][v][u]
  const WarpRow* rows_;                   // [theta_o pair][v]
  const ColourNode* colour_;              // [theta_o pair][y][x]
  int warp_width_, warp_height_, colour_width_, colour_height_;
};

}  // namespace reflectree
