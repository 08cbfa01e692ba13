// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/sampler_data.hpp"

#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

[[noreturn]] void fail(const std::string& what, const std::string& where) {
  throw Error(what, where, "build the sampler again");
}

// theta_o over the hemisphere and, of anisotropic functions, phi_o over what symmetry leaves of it.
void check_coordinates(const Partition& p, const ViewerFrame& frame) {
  const char* where = "partition of the known coordinates";
  const bool isotropic = frame.isotropic();
  const std::size_t wanted = isotropic ? 1 : 2;
  if (p.coordinates.size() != wanted || p.coordinates[0].name != "theta_o" ||
      (!isotropic && p.coordinates[1].name != "phi_o")) {
    fail("this version serves the known coordinates theta_o, or theta_o and phi_o", where);
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

}  // namespace

void validate(const SamplerData& data) {
  validate(data.exact_partition);
  validate(data.one_shot_partition);
  if (std::uint8_t(data.frame.symmetry) > std::uint8_t(ViewerSymmetry::none))
    fail("unknown symmetry", "frame of the viewer");
  if (!(abs(data.frame.axis) <= 7)) fail("the axis is not an angle", "frame of the viewer");
  check_coordinates(data.exact_partition, data.frame);
  check_coordinates(data.one_shot_partition, data.frame);
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
  if (!(data.target.scale > 0 && std::isfinite(data.target.scale)))
    fail("the scale is not a positive number", "target");
  const std::vector<float>& channels = data.probes.channels;
  if (channels.size() % BrdfProbes::count != 0 ||
      channels.size() > BrdfProbes::count * std::size_t(max_channels)) {
    fail("a value of every channel is needed at every pair", "probes");
  }
  const Domain& d = data.domain;
  if (std::uint8_t(d.kind) > std::uint8_t(DomainKind::slope_star)) fail("unknown domain", "domain");
  if (d.kind == DomainKind::slope_star && data.frame.isotropic())
    fail("a star of slopes is not turned", "domain");
  if (!data.frame.isotropic() && d.half()) fail("half a square for an anisotropic function", "domain");
  if (!(d.stretch > 0.001f && d.stretch < 1000)) fail("the stretch is not in (0.001, 1000)", "domain");
  if (!(d.exponent >= 0 && d.exponent < 2)) fail("the exponent is not in [0, 2)", "domain");
}

}  // namespace reflectree
