// SPDX-License-Identifier: Apache-2.0
// The tabulated competitors and what can be tuned about them. Of anisotropic functions slices stand at
// azimuths of wo, too.
#pragma once

#include "reflectree/peers/curve_cdf.hpp"
#include "reflectree/peers/factored.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/peers/warp_chain.hpp"

namespace reflectree {

// The defaults are those of the registry, chosen by bench/studies/peers_tuning.
struct TabulatedTuning {
  int slices = 32;    // elevations of wo
  int azimuths = 32;  // of wo all around, of anisotropic functions
  int nodes = 64;     // per side, of cdf-table and alias-table
  int cells = 128;    // per side, of adaptive-cdf and wavelet
  // Of the mean of a slice: no support is lost between the points of a table, and no weight is huge.
  float node_floor = 1e-4f, cell_floor = 1e-3f;
  CurveOptions curve{};
  double dropped_energy = 1e-3;  // of the wavelet transform
  FactoredOptions factored{};
  WarpOptions warp{};
};

using MadePeer = std::optional<AnySampler<Spectrum>>;  // never nullopt; the type is that of the registry
using MakeTabulated = MadePeer(const PeerSubject&, const Host&, const TabulatedTuning&);

MakeTabulated make_cdf_table, make_alias_table, make_factored, make_adaptive_cdf, make_wavelet,
    make_warp_chain;

}  // namespace reflectree
