// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/klems_table.hpp"

#include <cassert>

#include "reflectree/math/fast_functions.hpp"

namespace reflectree {

KlemsBasis::KlemsBasis(const std::vector<double>& theta, const std::vector<int>& patches)
    : patches_(patches) {
  assert(theta.size() == patches.size() + 1);
  for (const double t : theta) theta_.push_back(float(t)), cos_theta_.push_back(float(cos(t)));
  cos_theta_.front() = 2;  // z may exceed 1 by a rounding
  if (theta.back() > 1.5707) cos_theta_.back() = 0;
  for (const int n : patches) first_.push_back(size_), size_ += n;
}

int KlemsBasis::patch_of(Direction w) const {
  std::size_t ring = 0;
  while (ring + 1 < cos_theta_.size() && w.z <= cos_theta_[ring + 1]) ++ring;
  if (ring == patches_.size()) return -1;
  const int n = patches_[ring];
  const float turns = angle_of(w.y, w.x) * (0.5f / pi);
  const int k = int(std::floor(max(-float(n), turns * float(n) + 0.5f)));  // in this order a NaN becomes -n
  return first_[ring] + (k < 0 ? k + n : k >= n ? k - n : k);
}

double KlemsBasis::projected_solid_angle(int patch) const {
  std::size_t ring = patches_.size() - 1;
  while (patch < first_[ring]) --ring;
  return pi_v<double> * (sqr(cos(double(theta_[ring]))) - sqr(cos(double(theta_[ring + 1])))) /
         patches_[ring];
}

float KlemsTable::operator()(const ShadingGeometry<float>& g) const {
  const float side = seen_through ? -1.f : 1.f;
  const int in = incident.patch_of({-side * g.wo.x, -g.wo.y, g.wo.z});
  const int out = exiting.patch_of({side * g.wi.x, g.wi.y, g.wi.z});
  if (in < 0 || out < 0) return 0;
  return values[std::size_t(in) * std::size_t(exiting.size()) + std::size_t(out)];
}

BrdfTraits KlemsTable::traits() const {
  BrdfTraits traits;
  traits.name = name;
  traits.isotropic = false;
  const std::vector<float>& borders = incident.ring_borders();
  for (std::size_t i = 1; i + 1 < borders.size(); ++i) traits.theta_o_knots.push_back(borders[i]);
  return traits;
}

}  // namespace reflectree
