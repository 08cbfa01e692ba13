// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/own_bound.hpp"

#include "reflectree/brdf/enclosure.hpp"

namespace reflectree::detail {

namespace {

class BoundEnclosure final : public BrdfEnclosure {
 public:
  explicit BoundEnclosure(CellBound bound) : bound_(std::move(bound)) {}
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    const auto ranges = [](const Vec3<AffineForm>& w) {
      return Vec3<RealInterval>{w.x.range, w.y.range, w.z.range};
    };
    RealInterval values = bound_({ranges(g.wo), ranges(g.wi), ranges(g.wh), g.cos_theta_d.range});
    // No answer, such as 0 / 0.
    if (!(values.lo <= values.hi)) values = {0, infinity};
    const AffineForm form = AffineForm::anything_in(values);
    return {form, form, form};
  }

 private:
  CellBound bound_;
};

}  // namespace

std::shared_ptr<const BrdfEnclosure> enclosure_by(CellBound bound) {
  return std::make_shared<BoundEnclosure>(std::move(bound));
}

CellCentre centre_of(const DirectionCell& cell) {
  CellCentre out{};
  const auto centre = [&out](const Vec3<RealInterval>& w) {
    const Vec3<double> middle{w.x.middle(), w.y.middle(), std::max(w.z.middle(), 1e-7)};
    const double inverse = 1 / std::sqrt(dot(middle, middle));
    const Direction at{float(inverse * middle.x), float(inverse * middle.y), float(inverse * middle.z)};
    const auto off = [](RealInterval range, float v) {
      return sqr(RealInterval(range.lo - double(v), range.hi - double(v))).hi;
    };
    out.radius += std::sqrt(off(w.x, at.x) + off(w.y, at.y) + off(w.z, at.z)) * (1 + 1e-12);
    return at;
  };
  out.wo = centre(cell.wo), out.wi = centre(cell.wi);
  return out;
}

}  // namespace reflectree::detail
