// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/tabulated.hpp"

#include <utility>

#include "reflectree/peers/bilinear_table.hpp"
#include "reflectree/peers/haar_warp.hpp"
#include "reflectree/peers/sliced_density.hpp"
#include "reflectree/peers/tabulate.hpp"

namespace reflectree {
namespace {

// Relative second moment of the weight of the target, summed over a few wo between the slices.
template <class D>
double cost(const D& density, const PeerSubject& subject) {
  UniformBits u(Pcg32(1));
  const WeightedSampler<AnyBrdf, D> sampler(subject.f, density);
  double total = 0;
  for (const float theta : {0.13f, 0.5f, 0.9f, 1.2f, 1.4f, 1.5f}) {
    constexpr int count = 1000;
    double sum = 0, sum2 = 0;
    for (int i = 0; i < count; ++i) {
      // All around where that makes a difference.
      const float phi = subject.f.traits().isotropic ? 0.f : 2.4f * float(i);
      const auto drawn = sampler.sample(direction_from_angles(theta, phi), u);
      const double w = drawn ? double(subject.target(drawn->weight)) : 0.0;
      sum += w, sum2 += w * w;
    }
    total += sum > 0 ? count * sum2 / (sum * sum) : count;
  }
  return total;
}

std::size_t azimuths_of(const PeerSubject& subject, int wanted) {
  return subject.f.traits().isotropic ? 1 : std::size_t(wanted);
}

// make(chart, theta_o, phi_o) for every slice.
template <class Slice, class Make>
SlicedDensity<Slice> sliced(SquareChart chart, const PeerSubject& subject, const Host& host,
                            const TabulatedTuning& tuning, const Make& make) {
  const std::vector<float> angles = slice_angles(tuning.slices);
  const std::size_t azimuths = azimuths_of(subject, tuning.azimuths);
  std::vector<std::optional<Slice>> made(angles.size() * azimuths);
  const auto all = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      made[i].emplace(make(chart, angles[i % angles.size()], azimuth_of(i / angles.size(), azimuths)));
  };
  subject.f.traits().concurrent ? host.parallel_for(made.size(), all) : all(0, made.size());
  std::vector<Slice> slices;
  for (auto& slice : made) slices.push_back(std::move(*slice));
  return {chart, angles, std::move(slices)};
}

template <class D>
MadePeer wrapped(const char* name, const PeerSubject& subject, D density) {
  const std::size_t bytes = density.bytes();
  return AnySampler<Spectrum>(name, WeightedSampler<AnyBrdf, D>(subject.f, std::move(density)), bytes);
}

// Either chart serves some materials better: the cheaper of the two by trial. make(chart) gives a density.
template <class Make>
MadePeer better_chart(const char* name, const PeerSubject& subject, const Make& make) {
  auto direct = make(SquareChart::hemisphere), half = make(SquareChart::half_vector);
  const bool take_half = cost(half, subject) < cost(direct, subject);
  return wrapped(name, subject, take_half ? std::move(half) : std::move(direct));
}

template <class Slice, class Make>
MadePeer sliced_peer(const char* name, const PeerSubject& subject, const Host& host,
                     const TabulatedTuning& tuning, const Make& make) {
  return better_chart(name, subject,
                      [&](SquareChart chart) { return sliced<Slice>(chart, subject, host, tuning, make); });
}

template <class Slice>
MadePeer node_peer(const char* name, const PeerSubject& subject, const Host& host,
                   const TabulatedTuning& tuning) {
  const int n = tuning.nodes;
  return sliced_peer<Slice>(name, subject, host, tuning, [&](SquareChart chart, float theta_o, float phi_o) {
    return Slice(chart_nodes(subject.f, subject.target, chart, theta_o, n, n, tuning.node_floor, phi_o), n,
                 n);
  });
}

}  // namespace

MadePeer make_cdf_table(const PeerSubject& subject, const Host& host, const TabulatedTuning& tuning) {
  return node_peer<BilinearTable>("cdf-table", subject, host, tuning);
}
MadePeer make_alias_table(const PeerSubject& subject, const Host& host, const TabulatedTuning& tuning) {
  return node_peer<AliasTable>("alias-table", subject, host, tuning);
}
MadePeer make_adaptive_cdf(const PeerSubject& subject, const Host& host, const TabulatedTuning& tuning) {
  const int n = tuning.cells;
  return sliced_peer<CurveCdf>(
      "adaptive-cdf", subject, host, tuning, [&](SquareChart chart, float theta_o, float phi_o) {
        return CurveCdf(
            chart_cells(subject.f, subject.target, chart, theta_o, n, n, tuning.cell_floor, phi_o), n, n,
            tuning.curve);
      });
}
MadePeer make_wavelet(const PeerSubject& subject, const Host& host, const TabulatedTuning& tuning) {
  const int n = tuning.cells;
  return sliced_peer<HaarWarp>(
      "wavelet", subject, host, tuning, [&](SquareChart chart, float theta_o, float phi_o) {
        return HaarWarp(
            chart_cells(subject.f, subject.target, chart, theta_o, n, n, tuning.cell_floor, phi_o), n,
            tuning.dropped_energy);
      });
}
MadePeer make_factored(const PeerSubject& subject, const Host&, const TabulatedTuning& tuning) {
  return better_chart("factored", subject, [&](SquareChart chart) {
    return fit_factored(subject.f, subject.target, chart, slice_angles(tuning.slices), tuning.factored,
                        azimuths_of(subject, tuning.factored.azimuths));
  });
}
MadePeer make_warp_chain(const PeerSubject& subject, const Host& host, const TabulatedTuning& tuning) {
  std::vector<float> angles = slice_angles(tuning.warp.slices);
  auto slices = fit_warp_chain(subject.f, subject.target, angles, tuning.warp, host,
                               azimuths_of(subject, tuning.azimuths));
  return wrapped("warp-chain", subject,
                 SlicedDensity<WarpSlice>(SquareChart::half_vector, std::move(angles), std::move(slices)));
}

}  // namespace reflectree
