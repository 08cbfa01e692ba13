// SPDX-License-Identifier: Apache-2.0
// The chain of warps of Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material
// Acquisition and Rendering": uniform points become points of the table of the target, those become visible
// normals, and a normal reflects wo. Fitted from any BRDF: the normals' distribution by power iteration on
// its retro-reflection. As published it loses samples below the horizon, and all mass at normals without
// retro-reflection: none of GGX's or of the RGL files' was found lost, but 0.3 of a pure Phong lobe's at
// grazing wo, which does not return to wo from beyond 45 degrees.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/host.hpp"
#include "reflectree/peers/bilinear_table.hpp"

namespace reflectree {

// The sizes of the published isotropic files are 8 elevations, 32 x 32 and, of the visible normals, 128 x 128.
struct WarpOptions {
  int slices = 16;
  int normals_width = 128, normals_height = 64;  // nodes of theta_h, phi_h
  int target_nodes = 64;                         // per side
};

// D over x = sqrt(2 theta_h / pi), `count` equal steps from 0 to 1; the projected area of the normal is 1.
std::vector<float> retro_normals(const AnyBrdf& f, Target target, int count);

// D of an anisotropic function: [azimuth][x], `count` steps of x as above, equal azimuths all around.
struct RetroNormals {
  int count = 0, azimuths = 1;
  std::vector<float> d;
  // At x in [0, 1], phi in radians; linear between nodes.
  float at(float x, float phi) const;
};
RetroNormals retro_normals_around(const AnyBrdf& f, Target target, int count, int azimuths);

// One slice of wo, over the half_vector chart.
struct WarpSlice {
  BilinearTable normals, target;

  struct Pair {
    const WarpSlice &a, &b;
    float t;
    Vec2<float> sample(UniformBits& u) const {
      const Vec2<float> s = BilinearTable::Pair{a.target, b.target, t}.sample(u);
      return BilinearTable::Pair{a.normals, b.normals, t}.warp(double(s.x), double(s.y));
    }
    float pdf(Vec2<float> p) const {
      const BilinearTable::Pair visible{a.normals, b.normals, t};
      const Vec2<double> s = visible.unwarp(p);
      return visible.pdf(p) * BilinearTable::Pair{a.target, b.target, t}.pdf({float(s.x), float(s.y)});
    }
  };
  std::size_t bytes() const { return normals.bytes() + target.bytes(); }
};

// [azimuth][theta_o]; `azimuths` of wo all around, 1 for isotropic functions.
std::vector<WarpSlice> fit_warp_chain(const AnyBrdf& f, Target target, const std::vector<float>& theta_o,
                                      const WarpOptions& options = {}, const Host& host = {},
                                      std::size_t azimuths = 1);

}  // namespace reflectree
