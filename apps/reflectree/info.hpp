// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"

namespace reflectree::cli {

// The facts of a sampler on stdout, as lines or as JSON of `command`.
void show_info(const Context& context, const std::string& command, const OpenedSampler& subject);
void show_info(const Context& context, const std::string& command, const OpenedFamily& subject);

}  // namespace reflectree::cli
