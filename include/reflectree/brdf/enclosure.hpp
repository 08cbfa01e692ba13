// SPDX-License-Identifier: Apache-2.0
// A BRDF over boxes of directions: its own formula, with affine forms in place of floats. Bounds that are
// proofs rest on it (docs/exactness.md).
#pragma once

#include <memory>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/math/affine_form.hpp"

namespace reflectree {

// wo + wi over a box, as in shading_geometry.hpp. Where the two may point apart the float formula takes out what
// the sum has along the difference, (|wo|^2 - |wi|^2) / |wo - wi|. Both lengths are 1 up to length_tolerance,
// and |wo - wi|^2 > 2 there: the correction, with the roundings of its own, is less than 4 length_tolerance.
inline constexpr double length_tolerance = 1e-6;
inline Vec3<AffineForm> sum_of_directions(const Vec3<AffineForm>& wo, const Vec3<AffineForm>& wi) {
  Vec3<AffineForm> h = wo + wi;
  if (dot(wo, wi).range.lo >= 0) return h;
  const AffineForm mended = AffineForm::anything_in({-4 * length_tolerance, 4 * length_tolerance});
  return {h.x + mended, h.y + mended, h.z + mended};
}

// x^2 + y^2 of a unit vector is 1 - z^2, too: of the two forms the narrower. What lengths, and both formulas,
// round is less than 3 length_tolerance.
inline AffineForm sin2_theta(const Vec3<AffineForm>& w) {
  const AffineForm plain = w.x * w.x + w.y * w.y;
  const AffineForm slack = AffineForm::anything_in({-3 * length_tolerance, 3 * length_tolerance});
  return narrower(plain, AffineForm(1) - sqr(w.z) + slack);
}

// What encloses a function of three channels (a grey one has three that are equal): every value that it returns
// for a geometry of the box stands in the form.
class BrdfEnclosure {
 public:
  virtual ~BrdfEnclosure() = default;
  virtual RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const = 0;
  // Whether the function returns the same, to the last bit, for wi and its image in the plane of wo, where wo
  // has no y: then one of the two is looked at.
  virtual bool is_mirror_symmetric() const { return false; }
};

namespace detail {
template <class F>
class FormulaEnclosure final : public BrdfEnclosure {
 public:
  FormulaEnclosure(F f, bool mirror_symmetric) : f_(std::move(f)), mirror_symmetric_(mirror_symmetric) {}
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override { return f_(g); }
  bool is_mirror_symmetric() const override { return mirror_symmetric_; }

 private:
  F f_;
  bool mirror_symmetric_;
};
}  // namespace detail

// F, whose formula is a template on its scalar, telling of its own enclosure. Where it is isotropic it must be
// mirror-symmetric as well (tests/sampler/enclosure_test.cpp holds every registered model to it).
template <class F>
struct Enclosed : F {
  Enclosed(F f) : F(std::move(f)) {}
  BrdfTraits traits() const {
    BrdfTraits traits = F::traits();
    traits.enclosure = std::make_shared<detail::FormulaEnclosure<F>>(static_cast<const F&>(*this),
                                                                     traits.isotropic_by_formula);
    return traits;
  }
};

}  // namespace reflectree
