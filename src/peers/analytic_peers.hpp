// SPDX-License-Identifier: Apache-2.0
// Factories of the registry: lobes, mixtures of lobes, and what is drawn from them.
#pragma once

#include "reflectree/peers/registry.hpp"

namespace reflectree::peers {

using Made = std::optional<AnySampler<Spectrum>>;

Made paper(const PeerSubject&, const Host&);
Made uniform(const PeerSubject&, const Host&);
Made cosine(const PeerSubject&, const Host&);
Made lafortune_willems(const PeerSubject&, const Host&);
Made textbook(const PeerSubject&, const Host&);
Made textbook_bounded(const PeerSubject&, const Host&);
Made proxy(const PeerSubject&, const Host&);
Made proxy_oracle(const PeerSubject&, const Host&);
Made resampling(const PeerSubject&, const Host&);

}  // namespace reflectree::peers
