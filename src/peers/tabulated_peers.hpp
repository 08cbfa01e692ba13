// SPDX-License-Identifier: Apache-2.0
// The tabulated competitors' entries in the registry.
#pragma once

#include "reflectree/peers/registry.hpp"

namespace reflectree {

using MadePeer = std::optional<AnySampler<Spectrum>>;  // nullopt: the function is not isotropic

MadePeer make_cdf_table(const PeerSubject& subject, const Host& host);
MadePeer make_alias_table(const PeerSubject& subject, const Host& host);
MadePeer make_adaptive_cdf(const PeerSubject& subject, const Host& host);
MadePeer make_wavelet(const PeerSubject& subject, const Host& host);
MadePeer make_warp_chain(const PeerSubject& subject, const Host& host);

}  // namespace reflectree
