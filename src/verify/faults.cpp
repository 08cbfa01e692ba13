// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/faults.hpp"

#include <cmath>

namespace reflectree {

// Rejection: a direction on the side that is to lose survives with probability (1 - |a|) / (1 + |a|).
ErasedSampler bent(ErasedSampler sampler, int coordinate, double amount, Direction pivot) {
  sampler.name += ", bent";
  sampler.sample = [inner = sampler.sample, coordinate, amount, pivot](Direction wo, Pcg32& u,
                                                                       DrawnDirection& out) {
    for (;;) {
      if (!inner(wo, u, out)) return false;
      const Direction d = out.wi - pivot;
      const float side = coordinate == 0 ? d.x : coordinate == 1 ? d.y : d.z;
      if ((side >= 0) == (amount >= 0)) return true;
      if (to_unit_double(u()) < (1 - std::abs(amount)) / (1 + std::abs(amount))) return true;
    }
  };
  return sampler;
}

ErasedSampler swapped_pdf(ErasedSampler sampler) {
  sampler.name += ", pdf swapped";
  sampler.pdf = [inner = sampler.pdf](Direction wo, Direction wi) { return inner(wi, wo); };
  return sampler;
}

TargetFunction swapped(TargetFunction f) {
  f.eval = [inner = f.eval](Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> t) {
    for (std::size_t i = 0; i < wi.size(); ++i) {
      t[i] = 0;
      if (wi[i].z > 0) inner(wi[i], {&wo, 1}, t.subspan(i, 1));
    }
  };
  return f;
}

ErasedSampler lost_support(ErasedSampler sampler, Direction axis, float cos_angle) {
  sampler.name += ", support lost";
  sampler.sample = [inner = sampler.sample, axis, cos_angle](Direction wo, Pcg32& u, DrawnDirection& out) {
    do {
      if (!inner(wo, u, out)) return false;
    } while (dot(out.wi, axis) > cos_angle);
    return true;
  };
  return sampler;
}

ErasedSampler scaled_pdf(ErasedSampler sampler, float factor) {
  sampler.name += ", pdf scaled";
  sampler.sample = [inner = sampler.sample, factor](Direction wo, Pcg32& u, DrawnDirection& out) {
    const bool drawn = inner(wo, u, out);
    out.pdf *= factor;
    return drawn;
  };
  if (sampler.pdf) {
    sampler.pdf = [inner = sampler.pdf, factor](Direction wo, Direction wi) {
      return factor * inner(wo, wi);
    };
  }
  return sampler;
}

ErasedSampler scaled_weight(ErasedSampler sampler, float factor) {
  sampler.name += ", weight scaled";
  sampler.sample = [inner = sampler.sample, factor](Direction wo, Pcg32& u, DrawnDirection& out) {
    const bool drawn = inner(wo, u, out);
    out.weight *= factor;
    return drawn;
  };
  return sampler;
}

ErasedSampler dying(ErasedSampler sampler, std::uint32_t period) {
  sampler.name += ", dying";
  sampler.sample = [inner = sampler.sample, period](Direction wo, Pcg32& u, DrawnDirection& out) {
    return u() % period != 0 && inner(wo, u, out);
  };
  return sampler;
}

}  // namespace reflectree
