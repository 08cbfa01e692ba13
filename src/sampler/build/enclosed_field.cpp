// SPDX-License-Identifier: Apache-2.0
#include "enclosed_field.hpp"

#include "reflectree/error.hpp"

namespace reflectree::detail {

namespace {

// The reduction of target.hpp.
AffineForm reduced(const Target& target, const RgbT<AffineForm>& f, int channels) {
  const AffineForm scale(target.scale);
  if (channels == 1) return scale * f.r;
  const AffineForm norm = Target::norm(scale * f);
  AffineForm t;
  switch (target.kind) {
    case TargetKind::norm:
      return norm;
    case TargetKind::luminance:
      t = AffineForm(0.2126) * f.r + AffineForm(0.7152) * f.g + AffineForm(0.0722) * f.b;
      break;
    case TargetKind::maximum:
      t = max(max(max(AffineForm(0), f.r), f.g), f.b);
      break;
    case TargetKind::channel:
      t = target.index == 0 ? f.r : target.index == 1 ? f.g : f.b;
      break;
  }
  return AffineForm(0.99) * (scale * t) + AffineForm(0.01) * norm;
}

}  // namespace

void check_value(const EnclosedPoint& enclosed, const PointValue& value) {
  if (!(value.unit > 0)) return;  // no sampler looks there
  const auto holds = [&](const AffineForm& form) { return form.range.contains(double(value.target)); };
  // Here a quotient of the leaf's height rounds twice more.
  const RealInterval unit = widened(enclosed.unit, 8 * 0x1p-24).range;
  if (!unit.contains(double(value.unit)))
    throw Error("the albedo that is looked up is not what its enclosure holds", "proof of the bounds",
                "this is a mistake of ours; the bounds stay estimated");
  if (holds(enclosed.target) || (enclosed.mirrored && holds(*enclosed.mirrored))) return;
  throw Error("the function returns values that its enclosure does not hold", "proof of the bounds",
              "give it the enclosure of its own formula, or none");
}

EnclosedField::EnclosedField(const PackedSampler& packed, int channels, bool turned, ExactSymmetry keeps)
    : packed_(packed),
      channels_(channels),
      turned_(turned),
      viewer_(packed.viewer, turned_),
      both_sides_(packed.domain.half() && !(turned_ && keeps.in_plane_of_wo)),
      images_(viewer_.images(keeps)) {}

EnclosedField::EnclosedField(const AnyBrdf& f, const PackedSampler& packed)
    : EnclosedField(packed, f.channels(), f.traits().isotropic_by_formula && packed.viewer.frame.isotropic(),
                    symmetry_of(*f.traits().enclosure)) {
  f_ = &f, enclosure_ = f.traits().enclosure;
}
EnclosedField::EnclosedField(const AnyFamily& family, const PackedSampler& packed)
    : EnclosedField(packed, family.channels(),
                    family.traits().isotropic_by_formula && packed.viewer.frame.isotropic(),
                    family.enclosure()->keeps()) {
  family_ = &family, family_enclosure_ = family.enclosure();
}

ProofBox EnclosedField::whole(const KnownRange& known) const {
  const Elevations theta = viewer_.elevations(known);
  ProofBox box{{theta.lo, 0, 0}, {theta.hi, 1, 1}};
  const auto beyond = viewer_.unknowns(known);
  for (std::size_t i = 3; i < axes(); ++i) box.lo[i] = beyond[i - 3].lo, box.hi[i] = beyond[i - 3].hi;
  if (divides_angle()) box.lo[star_axis] = -100, box.hi[star_axis] = 100;
  return box;
}

AffineForm EnclosedField::value_over(const DomainPointT<AffineForm>& point,
                                     const ShadingGeometry<AffineForm>& g, const ViewerForms& v) const {
  if (family_)
    return reduced(packed_.target, (*family_enclosure_)(g, v.parameters), channels_) * point.projected_area;
  if (enclosure_->reduces_channels()) {
    const AffineForm t = enclosure_->reduced(packed_.target, g, point.area_by_cosine.has_value());
    return point.area_by_cosine ? widened(t * *point.area_by_cosine, 0x1p-19) : t * point.projected_area;
  }
  if (point.area_by_cosine) {
    // The order of the products is another one: 32 roundings.
    if (const auto f_cos = enclosure_->times_cosine(g))
      return widened(reduced(packed_.target, *f_cos, channels_) * *point.area_by_cosine, 0x1p-19);
  }
  return reduced(packed_.target, (*enclosure_)(g), channels_) * point.projected_area;
}

// Of all images, whose values are about the same, what holds each.
AffineForm EnclosedField::target_over(const DomainPointT<AffineForm>& point,
                                      const ShadingGeometry<AffineForm>& g, const ViewerForms& v) const {
  AffineForm out;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const AffineForm t = value_over(point, viewer_.for_caller(g, v, images_[i]), v);
    out = i == 0 ? t : either(out, t);
  }
  return out;
}

AffineForm EnclosedField::albedo(double theta_lo, double theta_hi, const KnownRange& known) const {
  return viewer_.over({AffineForm::variable(0, theta_lo, theta_hi)}, known).albedo;
}

ViewerForms EnclosedField::viewers_of(const ProofBox& box, const KnownRange& known) const {
  std::array<AffineForm, 2 + max_parameters> unknown{AffineForm::variable(0, box.lo[0], box.hi[0])};
  for (std::size_t i = 3; i < axes(); ++i) unknown[i - 2] = AffineForm::variable(i, box.lo[i], box.hi[i]);
  return viewer_.over(unknown, known);
}

EnclosedPoint EnclosedField::over(const ViewerForms& viewer, const ProofBox& box,
                                  const PackedLeaf& leaf) const {
  const LeafCell<float> cell = cell_of(leaf);
  const LeafCell<AffineForm> forms{
      AffineForm(cell.x),       AffineForm(cell.y),       AffineForm(cell.width), AffineForm(cell.length),
      AffineForm(cell.slope_x), AffineForm(cell.slope_y), AffineForm(1)};
  PointInLeafT<AffineForm> at = point_at(forms, AffineForm::variable(1, box.lo[1], box.hi[1]),
                                         AffineForm::variable(2, box.lo[2], box.hi[2]));
  // Rounding ascends, and the borders of cells are floats.
  at.p.x.range = intersection(at.p.x.range, {double(cell.x), double(cell.x + cell.width)});
  at.p.y.range = intersection(at.p.y.range, {double(cell.y), double(cell.y + cell.length)});

  DomainForms domain = viewer_.domain_of(packed_.domain, viewer);
  RealInterval angle{box.lo[star_axis], box.hi[star_axis]};
  if (divides_angle()) domain.star_angle = &angle;
  if (axes() < star_axis) domain.free_variable = star_axis - 1;
  const DomainPointT<AffineForm> lifted = lift_box(domain, viewer.wo, at.p);
  if (!(angle.lo <= angle.hi)) return {};
  EnclosedPoint out{target_over(lifted, lifted.geometry, viewer), std::nullopt, viewer.albedo * at.height,
                    angle};
  if (both_sides_) {
    out.mirrored = target_over(lifted, mirrored_in_plane(lifted.geometry), viewer);
  } else if (at.p.y.range.lo < 0 && at.p.y.range.hi == 0) {  // the pole itself is on the other side
    const DomainPointT<AffineForm> pole =
        lift_box(viewer_.domain_of(packed_.domain, viewer), viewer.wo, {at.p.x, AffineForm(0)});
    out.mirrored = target_over(pole, pole.geometry, viewer);
  }
  return out;
}

double EnclosedField::star_angle(const ProofPoint& point, const LeafCell<float>& cell) const {
  if (!divides_angle()) return 0;
  const double x = double(cell.x) + double(cell.width) * point[1];
  const double around = 0.5 * pi_v<double> * (1 - x), side = cell.y < 0 ? -1 : 1;
  const Domain& domain = packed_.domain;
  const Vec2<double> azimuth{std::cos(around), side * std::sin(around)};
  const Vec2<double> along =
      domain.kind == DomainKind::slope_star
          ? detail::Stretched<double>{double(domain.stretch)}.along(azimuth)
          : detail::Scaled<double>{{double(domain.scale_x), double(domain.scale_y)}}.along(azimuth);
  const double b = std::sin(point[0]) * (along.x * std::cos(point[3]) + along.y * std::sin(point[3]));
  const double z = std::max(std::cos(point[0]), double(min_cos_theta_o));
  return std::asinh(b / (std::hypot(along.x, along.y) * z));
}

PointValue EnclosedField::at(const ProofPoint& point, const KnownRange& known, const PackedLeaf& leaf) const {
  const float c = clamp(float(std::cos(point[0])), known.lo, known.hi), s = float(std::sin(point[0]));
  Direction wo{s, 0, c};
  if (viewer_.sees_azimuth()) {
    if (s == 0 && point[3] > 0) return {};  // the normal's azimuth is 0
    wo = {float(double(s) * std::cos(point[3])), float(double(s) * std::sin(point[3])), c};
    wo = turn(wo, packed_.viewer.cos_axis, packed_.viewer.sin_axis);
  }
  Parameters parameters{};
  const PackedFamily& family = packed_.viewer.family;
  for (std::size_t i = 0, first = axes() - family.count; i < family.count; ++i) {
    const RealInterval& range = known.beyond[viewer_.first_parameter() + i];
    const double coordinate = point[first + i];
    const double value = family.parameters[i].logarithmic ? std::exp(coordinate) : coordinate;
    parameters[i] = clamp(float(value), float(range.lo), float(range.hi));
  }
  Incidence in;
  PointValue out;
  if (!find_incidence(packed_, wo, parameters, in)) return out;
  const Domain domain = domain_at(packed_.viewer, packed_.domain, in);
  const bool half = packed_.domain.half();
  const PointInLeaf at = point_at(leaf, half, float(point[1]), float(point[2]));
  for (const bool mirrored : {false, true}) {
    if (mirrored && !half) break;
    const DomainPoint lifted = lift(domain, in.wo, at.p, mirrored);
    const ShadingGeometry<float> g = known_geometry(in, lifted.geometry, turned_);
    const Spectrum value = family_ ? (*family_)(g, parameters) : (*f_)(g);
    out.target = max(out.target, packed_.target(value) * lifted.projected_area);
  }
  out.unit = in.albedo * (at.height / leaf.height);
  return out;
}

}  // namespace reflectree::detail
