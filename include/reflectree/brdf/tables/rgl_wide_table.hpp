// SPDX-License-Identifier: Apache-2.0
// A measured BRDF of any number of channels, isotropic or not, in the parameterisation of Dupuy and Jakob
// 2018 that rgl_table.hpp describes; isotropic RGB, the common case, is quicker there. Known direction: wo.
//   f cos_i = S(V^-1(m); wo) D(m) / (4 sigma(wo))
// Anisotropic: D and sigma are functions of both angles, S and V^-1 are linear between nodes of phi_o as
// between those of theta_o, and azimuths of m are the surface's own. Isotropic (one phi_o): azimuths of m are
// relative to that of wo.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "reflectree/brdf/brdf.hpp"

namespace reflectree {

// A table over the square: [v][u] with u = sqrt(2 theta / pi), v = phi / (2 pi) + 1/2.
struct RglSquare {
  int width = 0, height = 0;  // nodes along u and along v
  std::vector<float> values;
};

struct RglWideFields {
  std::string name = "rgl";
  // Nodes of the known direction, radians, ascending; one phi_o: isotropic. Several begin at -pi and span a
  // turn divided by `reduction`.
  std::vector<float> phi_o{0}, theta_o;
  // 1: nothing; 2: a half turn about the normal leaves the material as it is; 4: x and y
  // are mirrored by planes.
  int reduction = 1;
  RglSquare sigma, ndf;
  int warp_width = 0, warp_height = 0;
  std::vector<float> vndf;  // [phi_o][theta_o][warp_height][warp_width]: unnormalised density on the square
  int channels = 3, colour_width = 0, colour_height = 0;
  std::vector<float> colours;  // [phi_o][theta_o][channel][colour_height][colour_width]
  bool jacobian = true;        // false: colours are f cos_i already, without D / (4 sigma)
};

// f(wo, wi) in sr^-1. Finite and not negative everywhere; cos_theta_i below 1e-6 counts as 1e-6.
class RglWideTable {
 public:
  // Sizes must agree, nodes ascend, and sigma and vndf be no less than 0, as formats/rgl.hpp makes sure.
  explicit RglWideTable(const RglWideFields& fields);

  Spectrum operator()(const ShadingGeometry<float>& g) const;
  // The same before it is cut at 0, where the noise of measurement shows.
  Spectrum unclipped(const ShadingGeometry<float>& g) const;
  // Batches, zero below the surface: pairs in a row that share wo share its look-up.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const;
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const;
  BrdfTraits traits() const;

  std::string name;

 private:
  // What depends on wo alone: the slices between whose nodes it lies, their weights, and 4 sigma.
  struct Known {
    std::size_t slice[4];
    float weight[4];
    float four_sigma;
    bool flip_x, flip_y;  // of directions, into the part of the circle that is tabulated
  };
  struct WarpNode {
    float cdf, pdf;  // integral along u up to the node; density at the node
  };
  struct WarpRow {
    float cdf, mass;  // integral along v up to the row; integral along the row
  };
  // The stages of a look-up, as in RglTable.
  struct InWarp {
    std::size_t node, row;  // in a slice
    float x, y, normals;    // fractions; D(m), cut at 0
  };
  struct InColour {
    std::size_t node;  // in a slice
    float x, y;
  };
  Known known(const ShadingGeometry<float>& g) const;
  InWarp in_warp(const Known& known, const ShadingGeometry<float>& g) const;
  InColour in_colour(const Known& known, const InWarp& at) const;
  void colour(const Known& known, const InWarp& warp, const InColour& at, float cos_theta_i,
              float* out) const;

  template <class Table>
  friend struct RglSlices;  // reads the same tables, for the enclosure

  struct Tables {
    std::vector<WarpNode> warp;
    std::vector<WarpRow> rows;
    std::vector<float> colour;
  };
  std::vector<float> phi_o_, theta_o_;
  int reduction_, channels_;
  RglSquare sigma_, ndf_;
  int warp_width_, warp_height_, colour_width_, colour_height_;
  std::size_t slices_;                          // around a known direction: 2 or 4
  std::size_t warp_size_, rows_, colour_size_;  // of a slice
  std::size_t stride_;                          // floats of a node of colours
  std::shared_ptr<const Tables> tables_;        // copies share it
  const WarpNode* warp_;                        // [slice][v][u]
  const WarpRow* row_;                          // [slice][v]
  const float* colour_;                         // [slice][y][x][stride]
};

}  // namespace reflectree
