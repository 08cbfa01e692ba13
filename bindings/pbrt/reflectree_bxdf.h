// SPDX-License-Identifier: Apache-2.0
// A sampler of Reflectree as a BxDF of pbrt-v4, through the C interface: C++17, processor only.
//
// As in pbrt, wo points to where light leaves and Sample_f draws wi, both in the frame of the surface, and f is
// without the cosine. A surface that is seen from behind reflects like its front, in the mirror of its tangent plane.
// f is the function's own value in both transport modes: for importance its directions change places.
// Regularize does nothing: a function has no width to widen. rho is pbrt's own estimate, through Sample_f.
#ifndef PBRT_REFLECTREE_BXDF_H
#define PBRT_REFLECTREE_BXDF_H

#include <reflectree.h>

#include <pbrt/pbrt.h>

#include <pbrt/base/bxdf.h>
#include <pbrt/options.h>
#include <pbrt/util/color.h>
#include <pbrt/util/colorspace.h>
#include <pbrt/util/error.h>
#include <pbrt/util/hash.h>
#include <pbrt/util/print.h>
#include <pbrt/util/rng.h>
#include <pbrt/util/spectrum.h>
#include <pbrt/util/vecmath.h>

#include <string>
#include <utility>

namespace pbrt {

// How a direction is drawn. Monotone: from pbrt's two numbers, so that stratified points stay stratified. Alias: a
// little faster, from a generator that is seeded by pbrt's numbers. Exact: likewise, in proportion to the function
// times the cosine; the weight f cos / pdf is then as constant as the albedo table.
enum class ReflectreeMode { Monotone, Alias, Exact };

class ReflectreeBxDF {
  public:
    ReflectreeBxDF() = default;
    // sampler: of one channel or three (linear sRGB); it outlives the BxDF.
    ReflectreeBxDF(const reflectree_sampler *sampler, ReflectreeMode mode,
                   const SampledWavelengths &lambda)
        : sampler_(sampler), mode_(mode), lambda_(lambda) {}

    SampledSpectrum f(Vector3f wo, Vector3f wi, TransportMode transport) const {
        if (!SameHemisphere(wo, wi))
            return SampledSpectrum(0.f);
        if (transport == TransportMode::Importance)
            std::swap(wo, wi);
        float values[3];
        Check(reflectree_eval(sampler_, 1, Front(wo).w, Front(wi).w, values));
        return Spectral(values);
    }

    pstd::optional<BSDFSample> Sample_f(Vector3f wo, Float uc, Point2f u, TransportMode transport,
                                        BxDFReflTransFlags sampleFlags) const {
        if (!(sampleFlags & BxDFReflTransFlags::Reflection))
            return {};
        const Direction known = Front(wo);
        Direction drawn;
        float pdf, weight[3] = {};  // of one channel, the others stay 0
        if (mode_ == ReflectreeMode::Monotone) {
            // A float's steps of 2^-24 are filled from uc: small leaves get their whole share.
            const double points[2] = {double(u[0]) + double(uc) * 0x1p-24, double(u[1])};
            Check(reflectree_sample_uniforms(sampler_, 1, known.w, points, drawn.w, &pdf, weight));
        } else {
            RNG rng(Hash(GetOptions().seed, wo), Hash(uc, u));
            auto *draw = mode_ == ReflectreeMode::Exact ? reflectree_sample_exact
                                                       : reflectree_sample_one_shot;
            Check(draw(sampler_, 1, known.w, NextBits, &rng, drawn.w, &pdf, weight));
        }
        if (!(pdf > 0))
            return {};
        const Vector3f wi(drawn.w[0], drawn.w[1], wo.z < 0 ? -drawn.w[2] : drawn.w[2]);
        if (transport == TransportMode::Importance)
            return BSDFSample(f(wo, wi, transport), wi, pdf, Flags());
        for (float &w : weight)
            w *= pdf / drawn.w[2];
        return BSDFSample(Spectral(weight), wi, pdf, Flags());
    }

    // Per solid angle.
    Float PDF(Vector3f wo, Vector3f wi, TransportMode, BxDFReflTransFlags sampleFlags) const {
        if (!(sampleFlags & BxDFReflTransFlags::Reflection) || !SameHemisphere(wo, wi))
            return 0;
        float pdf;
        Check(reflectree_pdf(sampler_, mode_ == ReflectreeMode::Exact ? REFLECTREE_EXACT : REFLECTREE_ONE_SHOT,
                             1, Front(wo).w, Front(wi).w, &pdf));
        return pdf;
    }

    BxDFFlags Flags() const { return BxDFFlags::GlossyReflection; }
    void Regularize() {}
    static constexpr const char *Name() { return "ReflectreeBxDF"; }
    std::string ToString() const {
        return StringPrintf("[ ReflectreeBxDF channels: %d ]", reflectree_sampler_channels(sampler_));
    }

  private:
    struct Direction {
        float w[3];
    };

    static Direction Front(Vector3f w) { return {{float(w.x), float(w.y), float(std::abs(w.z))}}; }

    SampledSpectrum Spectral(const float *values) const {
        if (reflectree_sampler_channels(sampler_) == 1)
            return SampledSpectrum(values[0]);
        return RGBUnboundedSpectrum(*RGBColorSpace::sRGB, RGB(values[0], values[1], values[2])).Sample(lambda_);
    }

    static uint32_t NextBits(void *rng) { return static_cast<RNG *>(rng)->Uniform<uint32_t>(); }

    static void Check(reflectree_status status) {
        if (status != REFLECTREE_OK)
            ErrorExit("reflectree: %s", reflectree_last_error());
    }

    const reflectree_sampler *sampler_ = nullptr;
    ReflectreeMode mode_ = ReflectreeMode::Monotone;
    SampledWavelengths lambda_;
};

}  // namespace pbrt

#endif  // PBRT_REFLECTREE_BXDF_H
