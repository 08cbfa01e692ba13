// SPDX-License-Identifier: Apache-2.0
#include "density_search.hpp"
#include "reflectree/error.hpp"

namespace reflectree::detail {

Explanation explain_density(const Functions& f, std::span<const ExaminedView> views, bool shape_holds,
                            double level, const Host& host) {
  const DensitySearch search{f, views, level, host};
  Explanation best = explain_by_name(search, shape_holds);
  for (const auto step : {explain_total, explain_other_density, explain_cut, explain_half_lobe,
                          explain_mixture, explain_low_bound, explain_turned, explain_shifted}) {
    if (!best.cause.empty()) return best;
    if (shape_holds && step != explain_total) break;  // of these none keeps the shape
    if (host.cancelled()) throw Cancelled();
    best = step(search);
  }
  return best;
}

}  // namespace reflectree::detail
