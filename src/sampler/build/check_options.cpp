// SPDX-License-Identifier: Apache-2.0
#include "check_options.hpp"

#include <cstdio>
#include <memory>

#include "reflectree/error.hpp"

namespace reflectree::detail {

namespace {

void check_range(const char* name, float value, float lo, float hi) {
  if (value >= lo && value <= hi) return;
  char what[96], how[96];
  std::snprintf(what, sizeof what, "%s is %g", name, double(value));
  std::snprintf(how, sizeof how, "give it a number from %g to %g", double(lo), double(hi));
  throw Error(what, "build options", how);
}

}  // namespace

void check_options(const BuildOptions& options, int channels) {
  // Exact mode gives up after 256 trials: of 16 on average 7 directions in 10^8 are lost.
  check_range("expected_trials", options.expected_trials, 1.01f, 16);
  check_range("one_shot_variance", options.one_shot_variance, 1e-4f, 100);
  check_range("albedo_error", options.albedo_error, 1e-6f, 0.5f);
  const Target& target = options.target;
  if (target.kind > TargetKind::channel) {
    throw Error("the kind of target is unknown", "build options", "give norm, luminance, maximum or channel");
  }
  if (target.kind == TargetKind::channel && int(target.index) >= channels) {
    throw Error("the target is channel " + std::to_string(target.index) + " of " + std::to_string(channels),
                "build options", "count channels from 0");
  }
  if (!(target.scale > 0 && target.scale <= 3e38f)) {
    throw Error("the target's scale is not positive and finite", "build options", "leave it at 1");
  }
  if (options.max_evaluations < 1'000'000) {
    throw Error("max_evaluations is " + std::to_string(options.max_evaluations), "build options",
                "give it 1000000 or more");
  }
  if (!options.domain) return;
  const Domain& domain = *options.domain;
  if (std::uint8_t(domain.kind) > std::uint8_t(DomainKind::normal_vector)) {
    throw Error("the domain is unknown", "build options", "give one of domain.hpp, or none");
  }
  if (!(domain.exponent >= 0 && domain.exponent < 2)) {
    throw Error("the domain's exponent is not in [0, 2)", "build options",
                "give the a of f ~ cos_i^-a, from 0 to below 2");
  }
}

Host completed(Host host) {
  const Host plain;
  if (!host.parallel_for) host.parallel_for = plain.parallel_for;
  if (!host.progress) host.progress = plain.progress;
  // What turns out to need another round goes no further back.
  host.progress = [show = host.progress, highest = std::make_shared<float>(0.f)](float fraction) {
    if (fraction > *highest) *highest = fraction;
    show(*highest);
  };
  if (!host.stage) host.stage = plain.stage;
  if (!host.cancelled) host.cancelled = plain.cancelled;
  return host;
}

}  // namespace reflectree::detail
