// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/sampler_data.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

[[noreturn]] void fail(const std::string& what, const std::string& where) {
  throw Error(what, where, "build the sampler again");
}

// theta_o over the hemisphere; of anisotropic functions phi_o over what symmetry leaves of it; of families
// their parameters over their ranges.
void check_coordinates(const Partition& p, const ViewerFrame& frame,
                       const std::vector<KnownParameter>& parameters) {
  const char* where = "partition of the known coordinates";
  const bool isotropic = frame.isotropic();
  const std::size_t of_viewer = isotropic ? 1 : 2;
  if (p.coordinates.size() != of_viewer + parameters.size() || p.coordinates[0].name != "theta_o" ||
      (!isotropic && p.coordinates[1].name != "phi_o")) {
    fail("this version serves the known coordinates theta_o, or theta_o and phi_o, and a family's parameters",
         where);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const KnownCoordinate& c = p.coordinates[of_viewer + i];
    if (c.name != parameters[i].range.name) fail("a coordinate has another name than its parameter", where);
    // Logarithms may differ between libraries by a rounding.
    const float lo = lowest(parameters[i]), hi = highest(parameters[i]), apart = 1e-5f * (hi - lo);
    if (!(abs(c.lo - lo) <= apart && abs(c.hi - hi) <= apart))
      fail(c.name + " does not span its range", where);
  }
  const KnownCoordinate& theta = p.coordinates[0];
  if (!(theta.lo == 0 && theta.hi > 1.5707f && theta.hi <= 0.5f * pi)) {
    fail("theta_o does not span the hemisphere", where);
  }
  if (isotropic) return;
  const KnownCoordinate& phi = p.coordinates[1];
  if (!(phi.lo == 0 && abs(phi.hi - azimuth_span(frame.symmetry)) <= 1e-4f)) {
    fail("phi_o does not span what the symmetry leaves of the circle", where);
  }
}

void check_parameters(const SamplerData& data) {
  const char* where = "parameters of the family";
  if (data.parameters.empty()) {
    if (data.law != ScaleLaw{}) fail("a law without parameters", where);
    return;
  }
  std::vector<ParameterRange> ranges;
  for (const KnownParameter& p : data.parameters) {
    ranges.push_back(p.range);
    if (p.range.name.empty() || p.range.name.size() > 64) fail("a name is empty or too long", where);
    if (p.logarithmic && !(p.range.lo > 0)) fail("the logarithm of what is not positive", where);
  }
  check_ranges(ranges, where);
  // Widths that floats and lanes can bear, wherever the parameters are.
  for (const auto* law : {&data.law.x, &data.law.y}) {
    double lo = double((*law)[0]), hi = lo;
    for (std::size_t i = 0; i < data.parameters.size(); ++i) {
      const double a = double((*law)[1 + i]) * double(lowest(data.parameters[i])),
                   b = double((*law)[1 + i]) * double(highest(data.parameters[i]));
      lo += std::min(a, b), hi += std::max(a, b);
    }
    if (!(lo > -9.3 && hi < 9.3)) fail("the law of the widths leaves [1e-4, 1e4]", where);
  }
}

}  // namespace

void validate(const SamplerData& data) {
  validate(data.exact_partition);
  validate(data.one_shot_partition);
  if (std::uint8_t(data.frame.symmetry) > std::uint8_t(ViewerSymmetry::none))
    fail("unknown symmetry", "frame of the viewer");
  if (!(abs(data.frame.axis) <= 7)) fail("the axis is not an angle", "frame of the viewer");
  check_parameters(data);
  check_coordinates(data.exact_partition, data.frame, data.parameters);
  check_coordinates(data.one_shot_partition, data.frame, data.parameters);
  if (slab_count(data.exact_partition) != data.exact.size())
    fail("one tree per slab is needed", "exact trees");
  if (slab_count(data.one_shot_partition) != data.one_shot.size())
    fail("one tree per slab is needed", "one-shot trees");
  if (data.exact.size() > 60000 || data.one_shot.size() > 60000) fail("more than 60000 slabs", "partitions");
  for (std::size_t s = 0; s < data.exact.size(); ++s) {
    const std::string where = "exact tree " + std::to_string(s);
    validate(data.exact[s], where);
    if (!(std::isfinite(data.exact[s].volume) && data.exact[s].volume >= 0))
      fail("the volume is not a number", where);
    if (data.exact[s].status != BoundStatus::certified && data.exact[s].status != BoundStatus::estimated) {
      fail("unknown status of the bounds", where);
    }
    const float ratio = data.exact[s].bound_ratio;
    if (!(std::isfinite(ratio) && ratio >= 0)) fail("the ratio of the bounds is not a number", where);
    if (ratio != 0 && data.exact[s].status != BoundStatus::certified)
      fail("a ratio of estimated bounds", where);
  }
  for (std::size_t s = 0; s < data.one_shot.size(); ++s) {
    validate(data.one_shot[s], "one-shot tree " + std::to_string(s));
  }
  validate(data.albedo);
  const std::vector<float>& azimuths = data.albedo.phi_o;
  if (azimuths.empty() != data.frame.isotropic() || data.albedo.even != is_mirrored(data.frame.symmetry) ||
      (!azimuths.empty() && !(abs(azimuths.back() - azimuth_span(data.frame.symmetry)) <= 1e-4f))) {
    fail("the azimuths do not fit the symmetry", "albedo table");
  }
  if (data.albedo.parameters.size() != data.parameters.size())
    fail("its axes do not fit the family's parameters", "albedo table");
  for (std::size_t i = 0; i < data.parameters.size(); ++i) {
    const AlbedoAxis& axis = data.albedo.parameters[i];
    const float lo = lowest(data.parameters[i]), hi = highest(data.parameters[i]), apart = 1e-5f * (hi - lo);
    if (!(abs(axis.lo - lo) <= apart && abs(axis.hi - hi) <= apart))
      fail("an axis does not span its parameter", "albedo table");
  }
  if (!(data.target.scale > 0 && std::isfinite(data.target.scale)))
    fail("the scale is not a positive number", "target");
  const std::vector<float>& channels = data.probes.channels;
  if (channels.size() % BrdfProbes::count != 0 ||
      channels.size() > BrdfProbes::count * std::size_t(max_channels)) {
    fail("a value of every channel is needed at every pair", "probes");
  }
  const Domain& d = data.domain;
  if (std::uint8_t(d.kind) > std::uint8_t(DomainKind::scaled_star)) fail("unknown domain", "domain");
  // A family has the law of the widths, a member the widths themselves.
  for (const float scale : {d.scale_x, d.scale_y}) {
    if (!(scale > 0.9e-4f && scale < 1.1e4f)) fail("a width is not in [1e-4, 1e4]", "domain");
    if (scale != 1 && (d.kind != DomainKind::scaled_star || !data.parameters.empty()))
      fail("widths of a domain that has none", "domain");
  }
  if (d.kind == DomainKind::slope_star && data.frame.isotropic())
    fail("a star of slopes is not turned", "domain");
  if (!data.frame.isotropic() && d.half()) fail("half a square for an anisotropic function", "domain");
  if (!(d.stretch > 0.001f && d.stretch < 1000)) fail("the stretch is not in (0.001, 1000)", "domain");
  if (!(d.exponent >= 0 && d.exponent < 2)) fail("the exponent is not in [0, 2)", "domain");
}

}  // namespace reflectree
