// SPDX-License-Identifier: Apache-2.0
// What pdf says of directions below the horizon.
#pragma once

#include "examined.hpp"

namespace reflectree::detail {

// Integral of pdf over the lower hemisphere, roughly: 1e-3 of a lobe that is wider than a few degrees.
double pdf_below(const Functions& f, Direction wo);

// A remark where it is not what the lost draws there say. Only a pdf that is positive at a lost direction of
// sample's own is asked: whoever draws only above need not answer.
void remark_on_pdf_below(const Functions& f, std::span<const ExaminedView> views, Diagnosis& diagnosis);

}  // namespace reflectree::detail
