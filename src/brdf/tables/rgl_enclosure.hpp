// SPDX-License-Identifier: Apache-2.0
// An isotropic RGL table over boxes of directions: the formula of rgl_table.hpp, step by step, over forms.
#pragma once

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/tables/rgl_table.hpp"

namespace reflectree {

class RglEnclosure final : public BrdfEnclosure {
 public:
  explicit RglEnclosure(const RglTable& table) : table_(table) {}
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override;
  std::optional<RgbT<AffineForm>> times_cosine(const ShadingGeometry<AffineForm>& g) const override;

 private:
  // factor D S / (4 sigma), cut at 0.
  RgbT<AffineForm> value(const ShadingGeometry<AffineForm>& g, const AffineForm& factor) const;
  // Where V^-1 leads, each in [0, 1].
  Vec2<AffineForm> unwarped(const AffineForm& theta_o, const AffineForm& x, const AffineForm& y) const;
  Vec2<AffineForm> unwarped_range(const AffineForm& theta_o, RealInterval x, RealInterval y) const;
  RgbT<AffineForm> colour(const AffineForm& theta_o, const Vec2<AffineForm>& at) const;

  RglTable table_;
};

}  // namespace reflectree
