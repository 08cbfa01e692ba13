// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/registry.hpp"

#include "analytic_peers.hpp"
#include "reflectree/peers/tabulated.hpp"
#include "reflectree/sampler/sampler.hpp"

namespace reflectree {

namespace {

// Monotone descent from two words: stratified points stay stratified.
struct MonotoneSampler {
  using Value = Spectrum;
  OneShotSampler<AnyBrdf> one_shot;

  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
    return one_shot.sample(wo, u1, u2);
  }
  float pdf(Direction wo, Direction wi) const { return one_shot.pdf(wo, wi); }
};

std::shared_ptr<const PackedSampler> packed(const PeerSubject& subject, const Host& host) {
  if (subject.packed) return subject.packed;
  BuildOptions options;
  options.target = subject.target;
  return std::make_shared<const PackedSampler>(pack(build(subject.f, options, host)));
}

using Made = std::optional<AnySampler<Spectrum>>;

Made exact(const PeerSubject& subject, const Host& host) {
  const auto data = packed(subject, host);
  return AnySampler<Spectrum>("exact", ExactSampler<AnyBrdf>(subject.f, data), bytes_of(*data));
}
Made one_shot(const PeerSubject& subject, const Host& host) {
  const auto data = packed(subject, host);
  return AnySampler<Spectrum>("one-shot", OneShotSampler<AnyBrdf>(subject.f, data), bytes_of(*data));
}
Made monotone(const PeerSubject& subject, const Host& host) {
  const auto data = packed(subject, host);
  return AnySampler<Spectrum>("one-shot-monotone", MonotoneSampler{{subject.f, data}}, bytes_of(*data));
}

template <MakeTabulated make>
Made tabulated(const PeerSubject& subject, const Host& host) {
  return make(subject, host, {});
}

constexpr const char* ours = "Reflectree";

// name, summary, source, general, unbiased, make. Where a method is not unbiased:
// see paper_sampler.hpp, haar_warp.hpp, warp_chain.hpp.
constexpr SamplerInfo all[] = {
    {"exact", "density exactly proportional to the target, by rejection under a tree of bounds", ours, true,
     true, exact},
    {"one-shot", "density of a tree, without rejection, by alias table", ours, true, true, one_shot},
    {"one-shot-monotone", "the same by monotone descent, for stratified points", ours, true, true, monotone},
    {"paper", "quadtrees on the disk at tabulated wo, mixed between neighbours, rejection in the leaf",
     "Montes, Urena, Lastra and Garcia 2008", true, false, peers::paper},
    {"uniform", "uniform over the hemisphere", "folklore", true, true, peers::uniform},
    {"cosine", "cosine lobe, which is uniform over the projected disk", "folklore", true, true,
     peers::cosine},
    {"lafortune-willems", "cosine and cos^n lobe about the mirror direction, fitted",
     "Lafortune and Willems 1994", true, true, peers::lafortune_willems},
    {"textbook", "the samplers published with the analytic models", "the models' papers", false, true,
     peers::textbook},
    {"textbook-bounded", "the same where they are GGX's visible normals, bounded to those that are not lost",
     "Tokuyoshi and Eto 2024", false, true, peers::textbook_bounded},
    {"proxy", "cosine lobe and GGX's visible normals, fitted", "Dupuy and Benyoub 2023", true, true,
     peers::proxy},
    {"proxy-oracle", "the same, tuned for each elevation of wo to the least variance",
     "Dupuy and Benyoub 2023", true, true, peers::proxy_oracle},
    {"resampling", "one of eight candidates of the proxy, kept in proportion to the target",
     "Talbot, Cline and Egbert 2005", true, true, peers::resampling},
    {"cdf-table", "bilinear tables over slices of wo, inverted by their CDFs", "textbook", true, true,
     tabulated<make_cdf_table>},
    {"alias-table", "the same density, cells by alias table", "Walker 1977, Vose 1991", true, true,
     tabulated<make_alias_table>},
    {"factored", "the function in a few terms, each a product of functions of one angle",
     "Lawrence, Rusinkiewicz, Ramamoorthi 2004", true, true, tabulated<make_factored>},
    {"adaptive-cdf", "cascaded CDFs reduced to polylines", "Lawrence, Rusinkiewicz, Ramamoorthi 2005", true,
     true, tabulated<make_adaptive_cdf>},
    {"wavelet", "thresholded Haar wavelets, warped down their quadtree",
     "Claustres et al. 2003, Clarberg et al. 2005", true, false, tabulated<make_wavelet>},
    {"warp-chain", "visible normals, then a table of the target in warped coordinates, fitted from any BRDF",
     "Dupuy and Jakob 2018", true, false, tabulated<make_warp_chain>},
};

}  // namespace

std::span<const SamplerInfo> samplers() { return all; }

const SamplerInfo* find_sampler(std::string_view name) {
  for (const SamplerInfo& info : all) {
    if (info.name == name) return &info;
  }
  return nullptr;
}

}  // namespace reflectree
