// SPDX-License-Identifier: Apache-2.0
// Steps of the domains' maps over boxes (domain_map.hpp), written so that the forms stay narrow: equal to what
// the maps say, with room for what the maps round. u: half an ulp of float, 2^-24.
#pragma once

#include "reflectree/math/affine_form.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree {

// The maps use p and c as their ratio alone, d = p / (p + (c - p) y), and what that rounds is relative to p. So
// p = 1 and c = c / p, which has two roundings more than l.
inline detail::HalfVectorStar<AffineForm> half_vector_star(const AffineForm& sine, const AffineForm& cosine,
                                                           const AffineForm& cos_phi) {
  const AffineForm sx = sine * cos_phi, l = sqrt(sqr(cosine) + sx * sx) + abs(sx);
  return {AffineForm(1), widened(by_sign(sx, cosine / l, l / cosine), 4 * 0x1p-24)};
}
inline detail::MirrorRim<AffineForm> mirror_rim(const AffineForm& sine, const AffineForm& cosine,
                                                const AffineForm& cos_phi) {
  const AffineForm sx = sine * cos_phi, l = sqrt(sqr(cosine) + sx * sx) + abs(sx);
  return {AffineForm(1), widened(by_sign(sx, l / cosine, cosine / l), 4 * 0x1p-24),
          by_sign(sx, sqr(cosine) / l, l)};
}

// With R = p / c, tau = y d and 1 - tau / R = d (1 - y),
//   (2 (wo.n) - z (n.n)) / (n.n) = z (1 - tau / R) (1 + R tau) / (1 + tau^2),
// where nothing cancels. The map's R errs by 16 u, its d by 6 u max(1, d) and tau by one u more: 1 - tau / R by
// less than 24 u max(1, d), since tau / R <= 1. Its 2 (wo.n) / (n.n) errs by less than 16 u of itself: wo.n is at
// least a third of its terms, as z >= 2 |sin theta_o cos phi| tau where the two differ in sign.
inline AffineForm reflected_cosine(const AffineForm& twice, const AffineForm& z,
                                   const detail::HalfVectorStar<AffineForm>& star, const AffineForm& y,
                                   const AffineForm& d, const AffineForm& cos2_theta_h) {
  constexpr double u = 0x1p-24;
  const AffineForm plain = twice - z;
  const double off = 24 * u * std::max(1., d.range.hi), lost = 16 * u * (twice.range.hi + z.range.hi);
  if (!(off < 1) || !(lost < 1)) return plain;
  const AffineForm to_rim = d * (AffineForm(1) - y) + AffineForm::anything_in({-off, off});
  const AffineForm beyond = AffineForm(1) + y * d * (star.p / star.c);
  return narrower(plain, z * to_rim * (beyond * cos2_theta_h) + AffineForm::anything_in({-lost, lost}));
}

}  // namespace reflectree
