// SPDX-License-Identifier: Apache-2.0
// Planted faults: the twins that every check must reject. Each wraps a sampler and spoils one thing.
#pragma once

#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/verify/erased.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

// Density bent by +-amount according to the sign of a coordinate (0, 1, 2: x, y, z) of wi - pivot; pdf and
// weight are claimed as before. Choose coordinate and pivot so that both signs occur.
ErasedSampler bent(ErasedSampler sampler, int coordinate, double amount = 0.02, Direction pivot = {});

// pdf(wi, wo) for pdf(wo, wi).
ErasedSampler swapped_pdf(ErasedSampler sampler);
// t(wi, wo) for t(wo, wi): invisible where the function is reciprocal.
TargetFunction swapped(TargetFunction f);

// Directions inside a cone about `axis` are never drawn.
ErasedSampler lost_support(ErasedSampler sampler, Direction axis, float cos_angle);

// pdf, both claimed and asked, times a factor; the weight stays.
ErasedSampler scaled_pdf(ErasedSampler sampler, float factor);
// Weight times a factor.
ErasedSampler scaled_weight(ErasedSampler sampler, float factor);

// One of `period` samples is "no sample".
ErasedSampler dying(ErasedSampler sampler, std::uint32_t period);

// The same on a way into a sampler. Pivot and axis may depend on wo.
using OfViewer = std::function<Direction(Direction wo)>;
WayIn bent(
    WayIn way, int coordinate, double amount = 0.02, OfViewer pivot = [](Direction) { return Direction{}; });
WayIn lost_support(WayIn way, OfViewer axis, float cos_angle);
WayIn scaled_pdf(WayIn way, float factor);
WayIn scaled_weight(WayIn way, float factor);
WayIn dying(WayIn way, std::uint32_t period);
// Places of a direction and its weights that a fault may rewrite: spoil(wo, u, drawn, weights).
using Spoil = std::function<void(Direction wo, Pcg32& u, DrawnAt& drawn, std::span<float> weights)>;
WayIn spoiled(WayIn way, std::string words, Spoil spoil);

// The heaviest leaf of every slab loses half of its bound; the other bounds stay.
SamplerData with_halved_bounds(SamplerData data);

}  // namespace reflectree
