// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/faults.hpp"

#include <algorithm>
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
  f.patches.clear();
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

WayIn spoiled(WayIn way, std::string words, Spoil spoil) {
  way.name += ", " + std::move(words);
  way.draw = [inner = way.draw, spoil](Direction wo, Pcg32& u, std::span<DrawnAt> out,
                                       std::span<float> weights) {
    inner(wo, u, out, weights);
    const std::size_t channels = weights.size() / std::max<std::size_t>(out.size(), 1);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i].drawn) spoil(wo, u, out[i], weights.subspan(i * channels, channels));
    }
  };
  return way;
}

namespace {

// Draws again until keep(wo, u, drawn) says so; the lane stays.
template <class Keep>
WayIn redrawn(WayIn way, std::string words, const Keep& keep) {
  const auto inner = way.draw;
  return spoiled(std::move(way), std::move(words),
                 [inner, keep](Direction wo, Pcg32& u, DrawnAt& drawn, std::span<float> weights) {
                   const std::uint16_t lane = drawn.lane;
                   while (drawn.drawn && !keep(wo, u, drawn)) inner(wo, u, {&drawn, 1}, weights);
                   drawn.lane = lane;
                 });
}

}  // namespace

WayIn bent(WayIn way, int coordinate, double amount, OfViewer pivot) {
  return redrawn(std::move(way), "bent", [=](Direction wo, Pcg32& u, const DrawnAt& drawn) {
    const Direction d = drawn.wi - pivot(wo);
    const float side = coordinate == 0 ? d.x : coordinate == 1 ? d.y : d.z;
    if ((side >= 0) == (amount >= 0)) return true;
    return to_unit_double(u()) < (1 - std::abs(amount)) / (1 + std::abs(amount));
  });
}

WayIn lost_support(WayIn way, OfViewer axis, float cos_angle) {
  return redrawn(std::move(way), "support lost", [=](Direction wo, Pcg32&, const DrawnAt& drawn) {
    return !(dot(drawn.wi, axis(wo)) > cos_angle);
  });
}

WayIn scaled_pdf(WayIn way, float factor) {
  return spoiled(std::move(way), "pdf scaled",
                 [factor](Direction, Pcg32&, DrawnAt& drawn, std::span<float>) { drawn.pdf *= factor; });
}

WayIn scaled_weight(WayIn way, float factor) {
  return spoiled(std::move(way), "weight scaled",
                 [factor](Direction, Pcg32&, DrawnAt&, std::span<float> weights) {
                   for (float& w : weights) w *= factor;
                 });
}

WayIn dying(WayIn way, std::uint32_t period) {
  return spoiled(std::move(way), "dying", [period](Direction, Pcg32& u, DrawnAt& drawn, std::span<float>) {
    drawn.drawn = u() % period != 0;
  });
}

SamplerData with_halved_bounds(SamplerData data) {
  for (MajorantTree& tree : data.exact) {
    const auto heaviest = std::max_element(tree.mass.begin(), tree.mass.end());
    double sum = 0;
    for (const std::uint32_t m : tree.mass) sum += m;
    const std::uint32_t lost = *heaviest / 2;
    *heaviest -= lost;
    tree.volume = float(double(tree.volume) * (sum - lost) / sum);
  }
  return data;
}

}  // namespace reflectree
