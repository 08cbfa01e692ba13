// SPDX-License-Identifier: Apache-2.0
// The material "reflectree" of pbrt-v4:
//
//   Material "reflectree" "string material" "ggx:alpha=0.1"      a material's text, or a measured file
//       "string cache" "ggx.rfl"      a sampler file: read if it is there, else written after building; default: none
//       "string mode" "monotone"      "monotone", "alias" or "exact"
//
// and "displacement" and "normalmap" as elsewhere. Files are looked for beside the scene. Values of three channels are
// linear sRGB, of one channel grey.
#ifndef PBRT_REFLECTREE_MATERIAL_H
#define PBRT_REFLECTREE_MATERIAL_H

#include <reflectree_bxdf.h>

#include <pbrt/base/material.h>
#include <pbrt/base/texture.h>
#include <pbrt/paramdict.h>
#include <pbrt/util/file.h>
#include <pbrt/util/progressreporter.h>

#include <map>
#include <memory>
#include <mutex>

namespace pbrt {

class ReflectreeMaterial {
  public:
    using BxDF = ReflectreeBxDF;
    using BSSRDF = void;

    ReflectreeMaterial(std::string material, const reflectree_sampler *sampler, ReflectreeMode mode,
                       FloatTexture displacement, Image *normalMap)
        : material_(std::move(material)),
          sampler_(sampler),
          mode_(mode),
          displacement_(displacement),
          normalMap_(normalMap) {}

    static ReflectreeMaterial *Create(const TextureParameterDictionary &parameters, Image *normalMap,
                                      const FileLoc *loc, Allocator alloc) {
        const std::string material = parameters.GetOneString("material", "");
        if (material.empty())
            ErrorExit(loc, "\"reflectree\" needs \"string material\": a text such as "
                           "\"ggx:alpha=0.1\", or a file");
        const std::string name = parameters.GetOneString("mode", "monotone");
        ReflectreeMode mode = ReflectreeMode::Monotone;
        if (name == "alias")
            mode = ReflectreeMode::Alias;
        else if (name == "exact")
            mode = ReflectreeMode::Exact;
        else if (name != "monotone")
            ErrorExit(loc, "\"%s\": unknown mode of \"reflectree\"; it is \"monotone\", \"alias\" or \"exact\"",
                      name);
        std::string cache = parameters.GetOneString("cache", "");
        if (!cache.empty())
            cache = ResolveFilename(cache);
        return alloc.new_object<ReflectreeMaterial>(material, SamplerOf(material, cache, loc), mode,
                                                    parameters.GetFloatTextureOrNull("displacement", alloc),
                                                    normalMap);
    }

    template <typename TextureEvaluator, typename Context>
    ReflectreeBxDF GetBxDF(TextureEvaluator, Context, SampledWavelengths &lambda) const {
        return ReflectreeBxDF(sampler_, mode_, lambda);
    }
    template <typename TextureEvaluator>
    bool CanEvaluateTextures(TextureEvaluator) const {
        return true;
    }
    template <typename TextureEvaluator, typename Context>
    void GetBSSRDF(TextureEvaluator, Context, SampledWavelengths &, void *) const {}

    FloatTexture GetDisplacement() const { return displacement_; }
    const Image *GetNormalMap() const { return normalMap_; }
    static constexpr bool HasSubsurfaceScattering() { return false; }
    static const char *Name() { return "ReflectreeMaterial"; }
    std::string ToString() const { return StringPrintf("[ ReflectreeMaterial material: %s ]", material_); }

  private:
    // One sampler per material and cache, built once, kept until the program ends.
    static const reflectree_sampler *SamplerOf(const std::string &material, const std::string &cache,
                                               const FileLoc *loc) {
        using Owned = std::unique_ptr<reflectree_sampler, void (*)(reflectree_sampler *)>;
        static std::mutex mutex;
        static std::map<std::pair<std::string, std::string>, Owned> samplers;
        const std::lock_guard<std::mutex> lock(mutex);
        auto found = samplers.find({material, cache});
        if (found == samplers.end())
            found = samplers.emplace(std::make_pair(material, cache),
                                     Owned(Prepared(material, cache, loc), reflectree_sampler_free)).first;
        return found->second.get();
    }

    static reflectree_sampler *Prepared(const std::string &material, const std::string &cache,
                                        const FileLoc *loc) {
        const std::string folder = ResolveFilename(".");
        const auto check = [&](reflectree_status status) {
            if (status != REFLECTREE_OK)
                ErrorExit(loc, "reflectree: %s", reflectree_last_error());
        };
        reflectree_function *function;
        check(reflectree_function_open(material.c_str(), folder.c_str(), &function));
        const int channels = reflectree_function_channels(function);
        if (channels != 1 && channels != 3)
            ErrorExit(loc, "%s has %d channels; give a material of one channel or three", material, channels);
        reflectree_sampler *sampler;
        if (!cache.empty() && FileExists(cache)) {
            check(reflectree_load(cache.c_str(), function, folder.c_str(), &sampler));
        } else {
            sampler = Built(function, material, check);
            if (!cache.empty())
                check(reflectree_save(sampler, cache.c_str()));
        }
        reflectree_function_free(function);
        // What was promised and is not kept.
        const std::string facts = reflectree_info_text(sampler);
        const size_t notes = facts.find("\nnotes");
        const size_t words = notes == std::string::npos ? notes : facts.find_first_not_of(' ', notes + 6);
        if (words != std::string::npos && facts.compare(words, 5, "none\n") != 0)
            Warning(loc, "reflectree: %s: %s", material, facts.substr(words, facts.find('\n', words) - words));
        return sampler;
    }

    template <typename Check>
    static reflectree_sampler *Built(const reflectree_function *function, const std::string &material,
                                     const Check &check) {
        constexpr int steps = 1000;
        struct Progress {
            ProgressReporter reporter;
            int done = 0;
        } progress{ProgressReporter(steps, "Sampler of " + material, GetOptions().quiet)};
        reflectree_build_options options;
        check(reflectree_build_options_init(&options, sizeof options));
        options.progress_user = &progress;
        options.progress = [](void *user, float fraction, const char *) {
            Progress &p = *static_cast<Progress *>(user);
            const int now = int(fraction * steps);
            p.reporter.Update(now - p.done);
            p.done = now;
            return 0;
        };
        reflectree_sampler *sampler;
        check(reflectree_build(function, &options, &sampler));
        progress.reporter.Done();
        return sampler;
    }

    std::string material_;
    const reflectree_sampler *sampler_;
    ReflectreeMode mode_;
    FloatTexture displacement_;
    Image *normalMap_;
};

}  // namespace pbrt

#endif  // PBRT_REFLECTREE_MATERIAL_H
