// SPDX-License-Identifier: Apache-2.0
#include "analytic_peers.hpp"

#include "reflectree/peers/fit_mixture.hpp"
#include "reflectree/peers/paper_sampler.hpp"
#include "reflectree/peers/resampling.hpp"
#include "textbook.hpp"

namespace reflectree::peers {

namespace {

Made weighted(const char* name, const PeerSubject& subject, LobeMixture mixture) {
  const std::size_t bytes = mixture.bytes();
  return AnySampler<Spectrum>(name, WeightedSampler<AnyBrdf, LobeMixture>(subject.f, std::move(mixture)),
                              bytes);
}

LobeMixture fitted(const PeerSubject& subject, const Host& host, LobeKind lobe, bool oracle = false) {
  FitOptions options;
  options.lobe = lobe;
  options.each_theta = oracle;
  const bool isotropic = subject.f.traits().isotropic;
  if (oracle) options.thetas = isotropic ? 90 : 30;
  if (!isotropic && !oracle) options.thetas = 8;
  return fit_mixture(subject.f, subject.target, options, host);
}

}  // namespace

Made paper(const PeerSubject& subject, const Host& host) {
  PaperOptions options;
  if (!subject.f.traits().isotropic) options.thetas = 30, options.phis = 48;
  PaperSampler sampler(subject.f, subject.target, options, host);
  const std::size_t bytes = sampler.bytes();
  return AnySampler<Spectrum>("paper", std::move(sampler), bytes);
}
Made uniform(const PeerSubject& subject, const Host&) {
  return weighted("uniform", subject, lobe_mixture({{1, {LobeKind::uniform}}}));
}
Made cosine(const PeerSubject& subject, const Host&) {
  return weighted("cosine", subject, lobe_mixture({{1, {LobeKind::cosine}}}));
}
Made lafortune_willems(const PeerSubject& subject, const Host& host) {
  return weighted("lafortune-willems", subject, fitted(subject, host, LobeKind::power));
}
Made textbook(const PeerSubject& subject, const Host&) {
  auto mixture = textbook_mixture(subject.material);
  if (!mixture) return std::nullopt;
  return weighted("textbook", subject, std::move(*mixture));
}
Made textbook_bounded(const PeerSubject& subject, const Host&) {
  auto mixture = bounded_mixture(subject.material);
  if (!mixture) return std::nullopt;
  return weighted("textbook-bounded", subject, std::move(*mixture));
}
Made proxy(const PeerSubject& subject, const Host& host) {
  return weighted("proxy", subject, fitted(subject, host, LobeKind::ggx));
}
Made proxy_oracle(const PeerSubject& subject, const Host& host) {
  return weighted("proxy-oracle", subject, fitted(subject, host, LobeKind::ggx, true));
}
Made resampling(const PeerSubject& subject, const Host& host) {
  LobeMixture candidates = fitted(subject, host, LobeKind::ggx);
  const std::size_t bytes = candidates.bytes();
  return AnySampler<Spectrum>("resampling",
                              ResamplingSampler{subject.f, subject.target, std::move(candidates)}, bytes);
}

}  // namespace reflectree::peers
