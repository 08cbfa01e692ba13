// SPDX-License-Identifier: Apache-2.0
// Draw by draw, without statistics: sample's pdf is pdf(wo, wi), and weight * pdf is f cos_theta_i.
#pragma once

#include "density.hpp"

namespace reflectree::detail {

struct PointwiseVerdict {
  bool pdf_agrees = true, weight_agrees = true;
  bool weight_explained = false;
};

// Adds checks "pdf_agrees" and "weight_agrees", and findings that the density does not explain already.
PointwiseVerdict check_pointwise(const Functions& f, const Pointwise& draws,
                                 std::span<const ExaminedView> views, const DensityVerdict& density,
                                 Diagnosis& diagnosis);

}  // namespace reflectree::detail
