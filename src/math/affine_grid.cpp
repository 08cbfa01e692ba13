// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/affine_grid.hpp"

#include "affine_logarithm.hpp"

namespace reflectree {

using namespace affine;

int GridAxis::beyond(double x) const {
  if (!places.empty()) return int(std::upper_bound(places.begin(), places.end(), x) - places.begin());
  const int i = int(std::floor(x)) + 1;
  return periodic ? i : std::clamp(i, 0, count);
}

AffineForm linear_enclosure(std::span<const AffineForm> x, std::span<const double> alpha, RealInterval offset,
                            RealInterval range) {
  AffineForm out;
  out.middle = 0.5 * (offset.lo + offset.hi);
  double error = 0.5 * std::max(offset.hi - offset.lo, 0.);
  double size = std::abs(offset.lo) + std::abs(offset.hi);
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (alpha[k] == 0) continue;
    const Settled settled(x[k]);
    const AffineForm& form = settled.form();
    if (!is_known(form)) return AffineForm::anything_in(range);
    for (std::size_t i = 0; i < n; ++i) out.slope[i] += alpha[k] * form.slope[i];
    out.middle += alpha[k] * form.middle;
    error += std::abs(alpha[k]) * form.error;
    size += std::abs(alpha[k]) * (std::abs(form.middle) + radius_of(form.slope));
  }
  complete(out, radius_of(out.slope), error + size * own, range);
  return out;
}

}  // namespace reflectree
