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
  const auto holds = [&](const AffineForm& form) { return form.range.contains(double(value.target)); };
  if (holds(enclosed.target) || (enclosed.mirrored && holds(*enclosed.mirrored))) return;
  throw Error("the function returns values that its enclosure does not hold", "proof of the bounds",
              "give it the enclosure of its own formula, or none");
}

EnclosedField::EnclosedField(const AnyBrdf& f, const PackedSampler& packed)
    : f_(f),
      enclosure_(f.traits().enclosure),
      mirror_symmetric_(enclosure_->is_mirror_symmetric()),
      packed_(packed) {}

Elevations EnclosedField::elevations(CosineRange c) const {
  const RealInterval longer = RealInterval(1) + RealInterval(-length_tolerance, length_tolerance);
  const RealInterval theta = acos(RealInterval(c.lo, c.hi) / longer);
  return {std::max(theta.lo, 0.), std::min(theta.hi, 0.5 * pi_v<double>)};
}

// The lines between the table's nodes, as they are looked up, lie between two lines of one slope; the nodes say
// how far apart.
AffineForm EnclosedField::albedo_over(const AffineForm& cosine) const {
  const PackedAlbedo& table = packed_.viewer.albedo;
  const std::vector<float>& x = table.lookup.borders();
  const float lo = max(float(cosine.range.lo) * (1 - 0x1p-22f), min_cos_theta_o);
  const float hi = min(float(cosine.range.hi) * (1 + 0x1p-22f), 1.f);
  const std::size_t first = table.lookup(lo), last = table.lookup(hi);
  const auto value = [&](std::size_t i, double c) {
    return double(table.pieces[i].base) + double(table.pieces[i].slope) * c;
  };
  const double a = double(lo), b = double(hi);
  const double alpha =
      b > a ? (value(last, b) - value(first, a)) / (b - a) : double(table.pieces[first].slope);
  RealInterval offset{infinity, -infinity}, range{infinity, -infinity};
  double rounding = 0;
  for (std::size_t i = first; i <= last; ++i) {
    for (const double c : {i == first ? a : double(x[i]), i == last ? b : double(x[i + 1])}) {
      const double v = value(i, c), product = std::abs(double(table.pieces[i].slope) * c);
      // fl(base + fl(slope c)), and the doubles here.
      rounding = std::max(rounding, (product + std::abs(v)) * 0x1.01p-24);
      offset = hull(offset, RealInterval(v - alpha * c, v - alpha * c)),
      range = hull(range, RealInterval(v, v));
    }
  }
  const auto wider = [rounding](RealInterval r) { return RealInterval(r.lo - rounding, r.hi + rounding); };
  return linear_enclosure(cosine, alpha, wider(offset), wider(range));
}

AffineForm EnclosedField::target_over(const DomainPointT<AffineForm>& point,
                                      const ShadingGeometry<AffineForm>& g) const {
  if (point.area_by_cosine) {
    // The order of the products is another one: 32 roundings.
    if (const auto f_cos = enclosure_->times_cosine(g))
      return widened(reduced(packed_.target, *f_cos, f_.channels()) * *point.area_by_cosine, 0x1p-19);
  }
  return reduced(packed_.target, (*enclosure_)(g), f_.channels()) * point.projected_area;
}

EnclosedPoint EnclosedField::over(const ProofBox& box, CosineRange cosines, const PackedLeaf& leaf) const {
  const AffineForm theta = AffineForm::variable(0, box.lo[0], box.hi[0]);
  AffineForm c = widened(cos(theta), length_tolerance);
  const AffineForm s = widened(sin(theta), length_tolerance);
  c.range = intersection(c.range, {double(cosines.lo), double(cosines.hi)});
  const Vec3<AffineForm> wo{s, AffineForm(0), c};

  const LeafCell<float> cell = cell_of(leaf);
  const LeafCell<AffineForm> forms{
      AffineForm(cell.x),       AffineForm(cell.y),       AffineForm(cell.width), AffineForm(cell.length),
      AffineForm(cell.slope_x), AffineForm(cell.slope_y), AffineForm(1)};
  PointInLeafT<AffineForm> at = point_at(forms, AffineForm::variable(1, box.lo[1], box.hi[1]),
                                         AffineForm::variable(2, box.lo[2], box.hi[2]));
  // Rounding ascends, and the borders of cells are floats.
  at.p.x.range = intersection(at.p.x.range, {double(cell.x), double(cell.x + cell.width)});
  at.p.y.range = intersection(at.p.y.range, {double(cell.y), double(cell.y + cell.length)});

  const DomainPointT<AffineForm> lifted = lift_box(packed_.domain, wo, at.p);
  EnclosedPoint out{target_over(lifted, lifted.geometry), std::nullopt, albedo_over(c) * at.height};
  if (packed_.domain.half() && !mirror_symmetric_) {
    out.mirrored = target_over(lifted, mirrored_in_plane(lifted.geometry));
  }
  return out;
}

PointValue EnclosedField::at(const ProofPoint& point, CosineRange cosines, const PackedLeaf& leaf) const {
  const float c = clamp(float(std::cos(point[0])), cosines.lo, cosines.hi);
  const Direction wo{float(std::sin(point[0])), 0, c};
  const bool half = packed_.domain.half();
  const PointInLeaf at = point_at(leaf, half, float(point[1]), float(point[2]));
  PointValue out;
  for (const bool mirrored : {false, true}) {
    if (mirrored && !half) break;
    const DomainPoint lifted = lift(packed_.domain, wo, at.p, mirrored);
    out.target = max(out.target, packed_.target(f_(lifted.geometry)) * lifted.projected_area);
  }
  out.unit = packed_.viewer.albedo.at(c) * (at.height / leaf.height);
  return out;
}

}  // namespace reflectree::detail
