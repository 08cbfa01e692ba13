// SPDX-License-Identifier: Apache-2.0
// verify of a family: some members, each with its share of the effort.
#include "parallel.hpp"
#include "reflectree/sampler/known/parameter.hpp"
#include "reflectree/verify/verify_suspect.hpp"

namespace reflectree {

std::vector<Parameters> members_to_verify(const std::vector<ParameterRange>& ranges, int anywhere,
                                          std::uint64_t seed) {
  std::vector<Parameters> members(2);
  for (std::size_t i = 0; i < ranges.size(); ++i) members[0][i] = ranges[i].lo, members[1][i] = ranges[i].hi;
  Pcg32 u = detail::part_generator(seed, 30);
  for (int k = 0; k < anywhere; ++k) {
    members.emplace_back();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const KnownParameter p{ranges[i], is_logarithmic(ranges[i])};
      members.back()[i] = value_of(p, linear_mix(to_unit_float(u()), lowest(p), highest(p)));
    }
  }
  return members;
}

VerifyReport verify_members(
    const std::vector<ParameterRange>& ranges,
    const std::function<VerifyReport(const Parameters&, const VerifyOptions&, const Host&)>& judge,
    const VerifyOptions& options, const Host& host) {
  const std::vector<Parameters> members = members_to_verify(ranges, options.members, options.seed);
  VerifyOptions each = options;
  each.effort /= double(members.size()), each.family_significance /= double(members.size());
  VerifyReport all;
  for (std::size_t i = 0; i < members.size(); ++i) {
    Host part = host;
    part.progress = [&host, i, &members](float fraction) {
      if (host.progress) host.progress((float(i) + fraction) / float(members.size()));
    };
    VerifyReport one = judge(members[i], each, part);
    all.checks.insert(all.checks.end(), one.checks.begin(), one.checks.end());
    all.figures.insert(all.figures.end(), one.figures.begin(), one.figures.end());
    if (i == 0) all.notes = std::move(one.notes);
  }
  return all;
}

}  // namespace reflectree
