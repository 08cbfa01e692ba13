// SPDX-License-Identifier: Apache-2.0
// Bounds that are proved for a function of your own: it says how large it may be over a cell of directions, or how
// steep it is. (For a formula that is a template on its scalar, Enclosed<F> needs neither.)
#include <cstdio>
#include <reflectree/sampler/build.hpp>
#include <reflectree/sampler/certify.hpp>

using namespace reflectree;

struct Chalk {
  float operator()(Direction wo, Direction wi) const { return 0.2f + 0.1f * wo.z * wi.z; }  // sr^-1
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.name = "chalk", traits.isotropic_by_formula = true;
    return traits;
  }
};
struct ChalkWithBound : Chalk {
  float bound(const DirectionCell& cell) const { return 0.2f + 0.1001f * float(cell.wo.z.hi * cell.wi.z.hi); }
};
struct SteepChalk : Chalk {
  float lipschitz() const { return 0.101f; }
};

int main() {
  for (const AnyBrdf& f : {AnyBrdf(ChalkWithBound()), AnyBrdf(SteepChalk())}) {
    SamplerData data = build(f);
    const Certification c = certify(data, f);
    std::printf("%zu of %zu slabs certified, at most %.2f trials\n", c.certified_slabs, c.slabs,
                double(data.report.expected_trials));
  }
}
