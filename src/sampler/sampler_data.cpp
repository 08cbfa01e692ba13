// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/sampler_data.hpp"

#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

[[noreturn]] void fail(const std::string& what, const std::string& where) {
  throw Error(what, where, "build the sampler again");
}

}  // namespace

void validate(const SamplerData& data) {
  validate(data.exact_partition);
  validate(data.one_shot_partition);
  const auto is_theta = [](const Partition& p) {
    return p.coordinates.size() == 1 && p.coordinates[0].name == "theta_o";
  };
  if (!is_theta(data.exact_partition) || !is_theta(data.one_shot_partition)) {
    fail("this version serves one known coordinate, theta_o", "partition of the known coordinates");
  }
  const auto spans_hemisphere = [](const Partition& p) {
    return p.coordinates[0].lo == 0 && p.coordinates[0].hi > 1.5707f && p.coordinates[0].hi <= 0.5f * pi;
  };
  if (!spans_hemisphere(data.exact_partition) || !spans_hemisphere(data.one_shot_partition)) {
    fail("theta_o does not span the hemisphere", "partition of the known coordinates");
  }
  if (slab_count(data.exact_partition) != data.exact.size()) fail("one tree per slab is needed", "exact trees");
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
  }
  for (std::size_t s = 0; s < data.one_shot.size(); ++s) {
    validate(data.one_shot[s], "one-shot tree " + std::to_string(s));
  }
  validate(data.albedo);
  if (!(data.target.scale > 0 && std::isfinite(data.target.scale)))
    fail("the scale is not a positive number", "target");
  const std::vector<float>& channels = data.probes.channels;
  if (channels.size() % BrdfProbes::count != 0 ||
      channels.size() > BrdfProbes::count * std::size_t(max_channels)) {
    fail("a value of every channel is needed at every pair", "probes");
  }
  const Domain& d = data.domain;
  if (std::uint8_t(d.kind) > std::uint8_t(DomainKind::normal_vector)) fail("unknown domain", "domain");
  if (!(d.exponent >= 0 && d.exponent < 2)) fail("the exponent is not in [0, 2)", "domain");
}

}  // namespace reflectree
