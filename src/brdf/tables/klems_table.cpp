// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/klems_table.hpp"

#include <cassert>
#include <utility>

#include "reflectree/brdf/enclosure.hpp"
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

KlemsBasis::Touched KlemsBasis::patches_of(const Vec3<AffineForm>& w) const {
  const RealInterval z = w.z.range, x = w.x.range, y = w.y.range;
  // In turns; angle_of and what it is multiplied by round by less than 1e-6. Away from where angles leap, on the
  // negative x axis, or turned by half a turn.
  const bool behind = x.hi < 0;
  const RealInterval angle = behind ? atan2(-y, -x) : atan2(y, x);
  const double off = 1e-6, turn = 2 * pi_v<double>, start = behind ? 0.5 : 0;
  const RealInterval turns{angle.lo / turn + start - off, angle.hi / turn + start + off};
  Touched out;
  for (std::size_t ring = 0; ring < patches_.size(); ++ring) {
    const bool above = z.hi > double(cos_theta_[ring + 1]),
               below = ring == 0 || z.lo <= double(cos_theta_[ring]);
    if (!above || !below) continue;
    const int n = patches_[ring];
    const int first = int(std::floor(turns.lo * n + 0.5)), last = int(std::floor(turns.hi * n + 0.5));
    for (int k = first; k <= std::min(last, first + n - 1); ++k)
      out.patches.push_back(first_[ring] + (k % n + n) % n);
  }
  out.beyond = z.lo <= double(cos_theta_.back());
  return out;
}

std::vector<float> KlemsBasis::azimuth_borders(std::size_t ring) const {
  std::vector<float> borders;
  const int n = patches_[ring];
  for (int k = 0; n > 1 && k < n; ++k) borders.push_back(2 * pi * (float(k) + 0.5f) / float(n));
  return borders;
}

std::size_t KlemsBasis::ring_of(int patch) const {
  std::size_t ring = patches_.size() - 1;
  while (patch < first_[ring]) --ring;
  return ring;
}
int KlemsBasis::first_of_ring(int patch) const { return first_[ring_of(patch)]; }

double KlemsBasis::projected_solid_angle(int patch) const {
  const std::size_t ring = ring_of(patch);
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

namespace {

class KlemsEnclosure final : public BrdfEnclosure {
 public:
  explicit KlemsEnclosure(const KlemsTable& table) : table_(table) {}
  // Constant over patches: nothing is lost by the range of those that are touched.
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    const bool through = table_.seen_through;
    const KlemsBasis::Touched in = table_.incident.patches_of({through ? g.wo.x : -g.wo.x, -g.wo.y, g.wo.z});
    const KlemsBasis::Touched out = table_.exiting.patches_of({through ? -g.wi.x : g.wi.x, g.wi.y, g.wi.z});
    RealInterval range{detail::infinity, -detail::infinity};
    if (in.beyond || out.beyond) range = {0, 0};
    for (const int i : in.patches) {
      for (const int k : out.patches) {
        const auto v = double(table_.value(i, k));
        range = hull(range, RealInterval(v, v));
      }
    }
    const AffineForm v = range.lo == range.hi ? AffineForm(float(range.lo)) : AffineForm::anything_in(range);
    return {v, v, v};
  }
  bool is_mirror_symmetric() const override { return table_.knows_rings_alone(); }

 private:
  KlemsTable table_;
};

}  // namespace

bool KlemsTable::knows_rings_alone() const {
  const auto first = [](const KlemsBasis& basis, int patch) { return basis.first_of_ring(patch); };
  for (int in = 0; in < incident.size(); ++in) {
    for (int out = 0; out < exiting.size(); ++out) {
      if (value(in, out) != value(first(incident, in), first(exiting, out))) return false;
    }
  }
  return true;
}

BrdfTraits KlemsTable::traits() const {
  BrdfTraits traits;
  traits.name = name, traits.channels = 1;
  traits.isotropic = traits.isotropic_by_formula = knows_rings_alone();
  traits.enclosure = std::make_shared<KlemsEnclosure>(*this);
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
