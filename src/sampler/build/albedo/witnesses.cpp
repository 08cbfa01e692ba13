// SPDX-License-Identifier: Apache-2.0
#include "witnesses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "panels.hpp"
#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree::detail {

namespace {

// Azimuths of the viewer at which the sum of T over fixed points of the square bends most, a degree or more
// apart: if something happens in few degrees, it happens there.
std::vector<float> restless_azimuths(const Field& field, const Host& host, Pcg32& u) {
  constexpr std::size_t places = 512, points = 64, most = 12, beside = 3;
  const float span = azimuth_span(field.frame.symmetry);
  std::vector<FieldPoint> fixed;
  for (std::size_t k = 0; k < points; ++k) {
    const float theta = theta_max * to_unit_float(u()), x = to_unit_float(u());
    fixed.push_back({viewer_at({theta, 0}).wo, square_point(field.domain.symmetry, x, to_unit_float(u()))});
  }
  std::vector<FieldPoint> all;
  for (std::size_t i = 0; i <= places; ++i) {
    for (const FieldPoint& q : fixed) all.push_back({turned_to(q.wo, span * float(i) / places), q.p});
  }
  std::vector<FieldValue> values(all.size());
  Effort uncounted;
  eval_in_parallel(field, host, uncounted, all, values);
  std::vector<double> sum(places + 1);
  for (std::size_t i = 0; i < all.size(); ++i) sum[i / points] += double(values[i].mean);
  std::vector<std::pair<double, std::size_t>> bends;
  for (std::size_t i = beside; i + beside <= places; ++i)
    bends.push_back({-std::abs(sum[i] - 0.5 * (sum[i - beside] + sum[i + beside])), i});
  std::sort(bends.begin(), bends.end());
  std::vector<std::size_t> chosen;
  for (const auto& [bend, i] : bends) {
    const bool apart = std::all_of(chosen.begin(), chosen.end(), [i = i](std::size_t c) {
      return std::max(c, i) - std::min(c, i) > beside;
    });
    if (apart && chosen.size() < most) chosen.push_back(i);
  }
  std::vector<float> azimuths;
  for (const std::size_t i : chosen) azimuths.push_back(span * float(i) / places);
  return azimuths;
}

}  // namespace

AlbedoWitnesses::AlbedoWitnesses(const Field& field, double relative_error, std::uint64_t seed,
                                 const Host& host, std::uint64_t limit)
    : field_(field) {
  constexpr std::size_t count = 48;
  constexpr float progress = 0.4f;
  Pcg32 u(seed, 21);
  const float span = azimuth_span(field.frame.symmetry);
  for (std::size_t i = 0; i < count; ++i) {
    const float theta = theta_max * to_unit_float(u());
    viewers_.push_back(viewer_at({theta, span * to_unit_float(u())}));
  }
  if (!field.frame.isotropic()) {
    for (const float phi_o : restless_azimuths(field, host, u))
      viewers_.push_back(viewer_at({theta_max * to_unit_float(u()), phi_o}));
  }
  if (!field.patches.empty()) {
    integrals_.values = integrals_over_patches(field, viewers_), integrals_.error = 1e-5;
    return;
  }
  Effort apart{0, limit};
  integrals_ =
      integrate(field, viewers_, {0.15 * relative_error, 13, 7, true, progress, progress}, host, apart);
}

double AlbedoWitnesses::miss_of(const AlbedoTable& table) const {
  // Of steps cubature says too little about its own error: what f tells is believed where both are near. The
  // cross-examination, which draws from the trees, knows the mean over all viewers to a thousandth.
  constexpr double near = 0.01, doubt = 10;
  const bool told = bool(field_.f.traits().albedo);
  double worst = 0;
  for (std::size_t i = 0; i < viewers_.size(); ++i) {
    const Direction wo = viewers_[i].wo;
    const double a =
        double(field_.frame.isotropic() ? albedo_at(table, wo.z) : albedo_at(table, wo.z, azimuth_of(wo)));
    const double b = integrals_.values[i], larger = max(a, b);
    if (!(larger > 0)) continue;
    const double miss = std::abs(a - b) / larger;
    if (!told) {
      worst = max(worst, (miss - integrals_.error) / times_allowed(wo.z));
    } else if (miss > near + doubt * integrals_.error) {
      char what[128];
      const auto scale = double(field_.target.scale);
      std::snprintf(what, sizeof what, "the function tells an albedo of %.4g, where cubature finds %.4g",
                    a / scale, b / scale);
      const Direction w = field_.to_caller(wo);
      char where[96];
      std::snprintf(where, sizeof where, " at wo = (%.7g, %.7g, %.7g)", double(w.x), double(w.y),
                    double(w.z));
      throw Error(what, field_.f.traits().name + where, "mend traits().albedo, or leave it out");
    }
  }
  return worst;
}

}  // namespace reflectree::detail
