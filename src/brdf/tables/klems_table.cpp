// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/tables/klems_table.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/math/azimuth_key.hpp"
#include "reflectree/math/fast_functions.hpp"

namespace reflectree {

namespace {

constexpr KlemsView views[] = {KlemsView::as_is, KlemsView::half_turn, KlemsView::mirrored_x,
                               KlemsView::mirrored_y};

// Where patch k of n begins in a view, in turns of 1 / 2n, in [0, 2n).
int begin_of(int k, int n, KlemsView view) {
  const int lower = 2 * k - 1, upper = 2 * k + 1;
  switch (view) {
    case KlemsView::half_turn:
      return (lower + n + 2 * n) % (2 * n);
    case KlemsView::mirrored_x:
      return (n - upper + 2 * n) % (2 * n);
    case KlemsView::mirrored_y:
      return (2 * n - upper + 2 * n) % (2 * n);
    default:
      return (lower + 2 * n) % (2 * n);
  }
}
// Radians. In lowest terms: rings of different n that have a border in common have one float.
float radians(int turns, int n) {
  const int common = std::gcd(turns, 2 * n);
  return float(2 * pi_v<double> * (turns / common) / (2 * n / common));
}

}  // namespace

KlemsBasis::KlemsBasis(const std::vector<double>& theta, const std::vector<int>& patches)
    : patches_(patches) {
  assert(theta.size() == patches.size() + 1);
  for (const double t : theta) theta_.push_back(float(t)), cos_theta_.push_back(std::cos(float(t)));
  cos_theta_.front() = 2;  // z may exceed 1 by a rounding
  if (theta.back() > 1.5707) cos_theta_.back() = 0;
  for (const int n : patches) first_.push_back(size_), size_ += n;
  for (const KlemsView view : views) {
    std::vector<Circle>& circles = circles_.emplace_back();
    for (std::size_t ring = 0; ring < patches.size(); ++ring) {
      const int n = patches[ring];
      std::vector<std::pair<int, int>> begins;
      for (int k = 0; k < n; ++k) begins.emplace_back(n > 1 ? begin_of(k, n, view) : 0, first_[ring] + k);
      std::sort(begins.begin(), begins.end());
      Circle& circle = circles.emplace_back();
      for (const auto& [begin, patch] : begins)
        circle.key.push_back(azimuth_key(radians(begin, n))), circle.patch.push_back(patch);
    }
  }
}

int KlemsBasis::patch_of(Direction w, KlemsView view) const {
  std::size_t ring = 0;
  while (ring + 1 < cos_theta_.size() && w.z <= cos_theta_[ring + 1]) ++ring;
  if (ring == patches_.size()) return -1;
  const Circle& circle = circles_[std::size_t(view)][ring];
  const std::size_t last = circle.key.size() - 1;
  const float key = azimuth_key(w.x, w.y);
  // Keys are almost equidistant. A NaN finds the last patch.
  auto k = std::size_t(max(0.f, min(0.25f * key * float(last + 1), float(last))));
  while (k > 0 && !(key >= circle.key[k])) --k;
  while (k < last && key >= circle.key[k + 1]) ++k;
  return circle.patch[key >= circle.key[k] ? k : last];
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

std::vector<float> KlemsBasis::azimuth_borders(std::size_t ring, KlemsView view) const {
  std::vector<float> borders;
  const int n = patches_[ring];
  for (int k = 0; n > 1 && k < n; ++k) borders.push_back(radians(begin_of(k, n, view), n));
  std::sort(borders.begin(), borders.end());
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
  const int in = incident.patch_of(g.wo, incident_view());
  const int out = exiting.patch_of(g.wi, exiting_view());
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
    traits.phi_o_knots.push_back({borders[i], incident.azimuth_borders(i - 1, incident_view())});
  }
  const std::vector<float>& ends = exiting.ring_borders();
  for (std::size_t i = 1; i < ends.size(); ++i) {
    traits.patches.push_back({ends[i], exiting.azimuth_borders(i - 1, exiting_view())});
  }
  if (ends.back() < 0.5f * pi) traits.patches.push_back({0.5f * pi, {}});
  // Sums over the exiting patches, of every incident one.
  std::vector<double> albedo;
  for (int in = 0; in < incident.size(); ++in) {
    albedo.push_back(0);
    for (int out = 0; out < exiting.size(); ++out)
      albedo.back() += exiting.projected_solid_angle(out) * double(value(in, out));
  }
  traits.albedo = [basis = incident, albedo, view = incident_view()](Direction wo) {
    const int in = basis.patch_of(wo, view);
    return in < 0 ? 0. : albedo[std::size_t(in)];
  };
  return traits;
}

}  // namespace reflectree
