// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/klems_table.hpp"

#include <cassert>
#include <utility>

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

std::vector<float> KlemsBasis::azimuth_borders(std::size_t ring) const {
  std::vector<float> borders;
  const int n = patches_[ring];
  for (int k = 0; n > 1 && k < n; ++k) borders.push_back(2 * pi * (float(k) + 0.5f) / float(n));
  return borders;
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
  return value(in, out);
}

BrdfTraits KlemsTable::traits() const {
  BrdfTraits traits;
  traits.name = name, traits.channels = 1;
  traits.isotropic = false;
  const std::vector<float>& borders = incident.ring_borders();
  for (std::size_t i = 1; i < borders.size(); ++i) {
    if (i + 1 < borders.size() || borders[i] < 1.57f) traits.theta_o_knots.push_back(borders[i]);
    AzimuthKnots band{borders[i], incident.azimuth_borders(i - 1)};
    for (float& phi : band.phi_o) phi = seen_through ? 2 * pi - phi : phi + pi;
    traits.phi_o_knots.push_back(std::move(band));
  }
  const std::vector<float>& ends = exiting.ring_borders();
  for (std::size_t i = 1; i < ends.size(); ++i) {
    PatchBand band{ends[i], exiting.azimuth_borders(i - 1)};
    for (float& phi : band.phi_i) phi = seen_through ? pi - phi : phi;
    traits.patches.push_back(std::move(band));
  }
  if (ends.back() < 0.5f * pi) traits.patches.push_back({0.5f * pi, {}});
  // Sums over the exiting patches, of every incident one.
  std::vector<double> albedo;
  for (int in = 0; in < incident.size(); ++in) {
    albedo.push_back(0);
    for (int out = 0; out < exiting.size(); ++out)
      albedo.back() += exiting.projected_solid_angle(out) * double(value(in, out));
  }
  const float side = seen_through ? -1.f : 1.f;
  traits.albedo = [basis = incident, albedo, side](Direction wo) {
    const int in = basis.patch_of({-side * wo.x, -wo.y, wo.z});
    return in < 0 ? 0. : albedo[std::size_t(in)];
  };
  return traits;
}

}  // namespace reflectree
