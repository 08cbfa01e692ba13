// SPDX-License-Identifier: Apache-2.0
#include <numeric>

#include "density_search.hpp"
#include "reflectree/verify/bin_masses.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree::detail {

double total_of(const Masses& m) { return std::accumulate(m.begin(), m.end(), 0.); }

Masses normalised_to(Masses m, double total) {
  const double scale = total_of(m) > 0 ? total / total_of(m) : 0;
  for (double& x : m) x *= scale;
  return m;
}

Masses lobe_masses(const ExaminedView& v, bool cosine, const Host& host) {
  TargetFunction t;
  t.eval = [cosine](Vec3<double>, std::span<const Vec3<double>> wi, std::span<double> out) {
    for (std::size_t i = 0; i < wi.size(); ++i) {
      out[i] = cosine ? 1 / pi_v<double> : 0.5 / pi_v<double> / std::max(wi[i].z, 1e-12);
    }
  };
  return function_masses(t, v.bins, 1e-3, host).mass;
}

bool DensitySearch::total_fits(const ExaminedView& v, double total) const {
  return std::abs(total + v.lost / v.draws + v.below / v.draws - 1) <=
         integral_tolerance(v, normal_two_sided_quantile(level));
}

}  // namespace reflectree::detail
