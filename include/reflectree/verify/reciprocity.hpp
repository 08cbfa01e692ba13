// SPDX-License-Identifier: Apache-2.0
// How far a function is from physics and from the symmetries that a sampler may rely on. Measured data is
// neither reciprocal nor energy-conserving: measured and reported, never failed or mended.
#pragma once

#include <cstdint>

#include "reflectree/verify/erased.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {

// Of t and its image over random pairs of directions (half of them near mirror pairs).
struct Asymmetry {
  double mean = 0;    // sum |t - image| / sum t
  double median = 0;  // of |t - image| / max(t, image)
  double worst = 0;
};

struct PhysicsReport {
  Asymmetry reciprocity;  // image: t(wi, wo)
  Asymmetry isotropy;     // both directions turned about the normal
  Asymmetry mirror;       // both directions mirrored about a plane through the normal
  double max_albedo = 0;  // of the target, over theta_o up to 89 degrees
  double max_albedo_theta_o = 0;
};
PhysicsReport measure_physics(const TargetFunction& f, int pairs = 20'000, std::uint64_t seed = 1);

// Isotropy and mirror symmetry as a builder relies on them: mean asymmetry within the tolerance.
CheckResult check_isotropy(const PhysicsReport& report, double tolerance = 1e-3);
CheckResult check_mirror_symmetry(const PhysicsReport& report, double tolerance = 1e-3);

}  // namespace reflectree
