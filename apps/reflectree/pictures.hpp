// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/draw/material_report.hpp"
#include "subject.hpp"

namespace reflectree::cli {

// A material's part of a page, with `samples` exact directions per view.
draw::ReportMaterial draw_material(const OpenedSampler& subject, const std::vector<double>& theta_o_deg,
                                   std::size_t samples, std::uint64_t seed);
// Throws Error where it cannot.
void make_folder(const std::string& path);

}  // namespace reflectree::cli
