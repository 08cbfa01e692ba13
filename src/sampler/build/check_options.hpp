// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/sampler/build.hpp"

namespace reflectree::detail {

// Throws Error for an option that is out of range.
void check_options(const BuildOptions& options, int channels);
// The host with what it left empty filled in.
Host completed(Host host);

}  // namespace reflectree::detail
