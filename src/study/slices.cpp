// SPDX-License-Identifier: Apache-2.0
// Densities in the plane of incidence.
#include <algorithm>
#include <cmath>

#include "reflectree/study/slices.hpp"

namespace reflectree::study {

namespace {

Direction in_plane(double angle_deg, double phi_o_deg) {
  const double a = angle_deg * pi_v<double> / 180, phi = phi_o_deg * pi_v<double> / 180;
  return {float(std::sin(a) * std::cos(phi)), float(std::sin(a) * std::sin(phi)), float(std::cos(a))};
}

// Four digits are more than a curve shows, and keep files small.
double rounded(double x) {
  if (!(x > 0) || !std::isfinite(x)) return 0;
  const double shift = std::pow(10., 3 - std::floor(std::log10(x)));
  return std::round(x * shift) / shift;
}

}  // namespace

std::vector<double> plane_angles(double theta_o_deg) {
  std::vector<double> angles{-89.7, -89, 89, 89.7};
  for (int a = -88; a <= 88; a += 2) angles.push_back(a + 0.1);
  for (const double centre : {-theta_o_deg, theta_o_deg}) {
    for (double step = 0.05; step < 4; step *= 1.7) {
      for (const double a : {centre - step, centre + step}) {
        if (std::abs(a) < 89.7) angles.push_back(rounded(std::abs(a)) * (a < 0 ? -1 : 1));
      }
    }
  }
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
  return angles;
}

std::vector<double> target_slice(const AnyBrdf& f, const Target& target, double theta_o_deg, double albedo,
                                 double phi_o_deg) {
  const Direction wo = in_plane(theta_o_deg, phi_o_deg);
  std::vector<double> densities;
  for (const double angle : plane_angles(theta_o_deg)) {
    const Direction wi = in_plane(angle, phi_o_deg);
    densities.push_back(albedo > 0 ? rounded(double(target(eval(f, wo, wi))) * double(wi.z) / albedo) : 0);
  }
  return densities;
}

std::vector<double> density_slice(const AnySampler<Spectrum>& sampler, double theta_o_deg, double phi_o_deg) {
  std::vector<double> densities;
  if (!sampler.has_pdf()) return densities;
  const Direction wo = in_plane(theta_o_deg, phi_o_deg);
  for (const double angle : plane_angles(theta_o_deg))
    densities.push_back(rounded(double(sampler.pdf(wo, in_plane(angle, phi_o_deg)))));
  return densities;
}

}  // namespace reflectree::study
