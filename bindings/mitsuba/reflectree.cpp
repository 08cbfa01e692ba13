// SPDX-License-Identifier: Apache-2.0
// The BSDF "reflectree" for the scalar variants of Mitsuba 3, as a plug-in of its own: no Python is called, and programs
// without Python have it. The variants of Dr.Jit have `import reflectree.mitsuba`, with the same parameters.
//
// Mitsuba calls the known direction wi and the sampled one wo, and its values contain the cosine; in names of ours wo is
// known. A nested BSDF becomes a function of the C interface; its own eval gives the values.
#include <reflectree.h>

#include <mitsuba/core/fresolver.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/random.h>
#include <mitsuba/core/string.h>
#include <mitsuba/core/util.h>
#include <mitsuba/render/bsdf.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include "random_words.hpp"

NAMESPACE_BEGIN(mitsuba)

// As the wheel has them: registers of four floats.
static_assert(sizeof(Vector<float, 3>) == 16, "compile for the processor that Mitsuba was compiled for");

namespace {

// Ends with the sentence of the C interface.
void check(reflectree_status status) {
    if (status != REFLECTREE_OK)
        Throw("reflectree: %s", reflectree_last_error());
}

struct FreeFunction {
    void operator()(reflectree_function *f) const { reflectree_function_free(f); }
};
struct FreeSampler {
    void operator()(reflectree_sampler *s) const { reflectree_sampler_free(s); }
};
using OwnedFunction = std::unique_ptr<reflectree_function, FreeFunction>;
using OwnedSampler  = std::unique_ptr<reflectree_sampler, FreeSampler>;

// The facts of a sampler by name: lines of "name   value".
std::string fact(const reflectree_sampler *sampler, const std::string &name) {
    const std::string text = std::string("\n") + reflectree_info_text(sampler);
    const size_t line = text.find("\n" + name + " ");
    if (line == std::string::npos)
        return "";
    const size_t value = text.find_first_not_of(' ', line + 1 + name.size());
    return text.substr(value, text.find('\n', value) - value);
}

OwnedSampler build(const reflectree_function *f) {
    reflectree_sampler *s;
    check(reflectree_build(f, nullptr, &s));
    if (const std::string notes = fact(s, "notes"); notes != "none")
        Log(Warn, "reflectree: %s", notes);
    return OwnedSampler(s);
}

OwnedSampler load(const std::string &path, const reflectree_function *f) {
    reflectree_sampler *s;
    check(reflectree_load(path.c_str(), f, nullptr, &s));
    return OwnedSampler(s);
}

// 64 bits of a text (FNV-1a), as hexadecimal digits.
std::string digest(const std::string &text) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (unsigned char byte : text)
        hash = (hash ^ byte) * 0x100000001b3u;
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", (unsigned long long) hash);
    return digits;
}

// Where samplers of nested BSDFs are kept; empty: nowhere.
std::filesystem::path cache_folder(const std::string &asked) {
    if (asked == "none")
        return {};
    if (!asked.empty())
        return asked;
    if (const char *base = std::getenv("XDG_CACHE_HOME"); base && *base)
        return std::filesystem::path(base) / "reflectree" / "mitsuba";
    const char *home = std::getenv("HOME");
    return home ? std::filesystem::path(home) / ".cache" / "reflectree" / "mitsuba" : std::filesystem::path();
}

} // namespace

template <typename Float, typename Spectrum>
class Reflectree final : public BSDF<Float, Spectrum> {
public:
    MI_IMPORT_BASE(BSDF, m_flags, m_components)
    MI_IMPORT_TYPES()

    static constexpr size_t channels_of_spectrum = dr::size_v<Spectrum>;
    // Of spectral variants a function of ours has two interactions of four wavelengths, in nm.
    static constexpr size_t interactions = is_spectral_v<Spectrum> ? 2 : 1;
    static constexpr float wavelengths[2][4] = { { 400, 486, 571, 657 }, { 443, 529, 614, 700 } };

    explicit Reflectree(const Properties &props) : Base(props) {
        int given = 0;
        for (auto &prop : props.objects()) {
            if (Base *bsdf = prop.try_get<Base>()) {
                m_nested = bsdf;
                ++given;
            }
        }
        const std::string material = props.get<std::string>("material", ""), file = props.get<std::string>("file", ""),
                          member = props.get<std::string>("member", ""), saved = props.get<std::string>("sampler", ""),
                          cache = props.get<std::string>("cache", "");
        m_monotone = choice(props, "uniforms", "alias", "monotone") == 1;
        m_exact    = choice(props, "mode", "one-shot", "exact") == 1;
        given += !material.empty() + !file.empty();
        if (given > 1 || (given == 0 && saved.empty()))
            Throw("reflectree: %i functions are given; nest one BSDF, or give material, file or sampler", given);
        if (!member.empty() && file.empty())
            Throw("reflectree: member is one of a file; give file, too");

        if (m_nested) {
            refuse_what_cannot_be_wrapped();
            make_function();
            m_sampler = saved.empty() ? wrapped(cache) : load(resolved(saved), m_function.get());
        } else {
            if (given) {
                const std::string text =
                    file.empty() ? material : resolved(file) + (member.empty() ? "" : "#" + member);
                reflectree_function *f;
                check(reflectree_function_open(text.c_str(), nullptr, &f));
                m_function.reset(f);
            }
            m_sampler = saved.empty() ? build(m_function.get()) : load(resolved(saved), m_function.get());
            m_channels = reflectree_sampler_channels(m_sampler.get());
            if (m_channels != 1 && m_channels != 3)
                Throw("reflectree: %s has %i channels; give a material of one channel or three",
                      fact(m_sampler.get(), "material"), m_channels);
            if (is_spectral_v<Spectrum> && m_channels == 3)
                Throw("reflectree: the values of %s are red, green and blue, and the variant is spectral; use an rgb "
                      "variant, or a material of one channel", fact(m_sampler.get(), "material"));
        }
        auto flags = BSDFFlags::GlossyReflection | BSDFFlags::FrontSide;
        if (fact(m_sampler.get(), "symmetry") != "isotropic")
            flags = flags | BSDFFlags::Anisotropic;
        m_components.push_back(flags);
        m_flags = m_components.back();
    }

    std::pair<BSDFSample3f, Spectrum> sample(const BSDFContext &ctx, const SurfaceInteraction3f &si, Float sample1,
                                             const Point2f &sample2, Mask active) const override {
        BSDFSample3f drawn = dr::zeros<BSDFSample3f>();
        if (!active || !ctx.is_enabled(BSDFFlags::GlossyReflection, 0) || !(si.wi.z() > 0))
            return { drawn, Spectrum(0.f) };
        const float known[3] = { si.wi.x(), si.wi.y(), si.wi.z() };
        float wi[3], pdf;
        if (m_monotone && !m_exact) {
            // A float's steps of 2^-24 are filled from the third number: small leaves get their whole share.
            const double u[2] = { double(sample2.x()) + double(sample1) * 0x1p-24, double(sample2.y()) };
            check(reflectree_sample_uniforms(m_sampler.get(), 1, known, u, wi, &pdf, nullptr));
        } else {
            reflectree::WordsOfNumbers bits(bits_of(sample1), bits_of(sample2.x()), bits_of(sample2.y()));
            auto *draw = m_exact ? reflectree_sample_exact : reflectree_sample_one_shot;
            check(draw(m_sampler.get(), 1, known,
                       [](void *state) { return (*static_cast<reflectree::WordsOfNumbers *>(state))(); }, &bits, wi,
                       &pdf, nullptr));
        }
        if (!(pdf > 0))
            return { drawn, Spectrum(0.f) };
        drawn.wo                = Vector3f(wi[0], wi[1], wi[2]);
        drawn.pdf               = pdf;
        drawn.eta               = 1.f;
        drawn.sampled_type      = +BSDFFlags::GlossyReflection;
        drawn.sampled_component = 0;
        return { drawn, values(ctx, si, drawn.wo) / pdf };
    }

    Spectrum eval(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo,
                  Mask active) const override {
        if (!active || !ctx.is_enabled(BSDFFlags::GlossyReflection, 0))
            return Spectrum(0.f);
        return values(ctx, si, wo);
    }

    Float pdf(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo, Mask active) const override {
        if (!active || !ctx.is_enabled(BSDFFlags::GlossyReflection, 0) || !(si.wi.z() > 0 && wo.z() > 0))
            return 0.f;
        const float known[3] = { si.wi.x(), si.wi.y(), si.wi.z() }, wi[3] = { wo.x(), wo.y(), wo.z() };
        float pdf;
        check(reflectree_pdf(m_sampler.get(), m_exact ? REFLECTREE_EXACT : REFLECTREE_ONE_SHOT, 1, known, wi, &pdf));
        return pdf;
    }

    std::pair<Spectrum, Float> eval_pdf(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo,
                                        Mask active) const override {
        return { eval(ctx, si, wo, active), pdf(ctx, si, wo, active) };
    }

    void traverse(TraversalCallback *callback) override {
        if (m_nested)
            callback->put("nested", m_nested, ParamFlags::NonDifferentiable);
    }

    // One-shot mode stays right with a sampler of other parameters, only noisier; exact mode does not.
    void parameters_changed(const std::vector<std::string> & /*keys*/) override {
        if (m_nested && m_exact)
            m_sampler = build(m_function.get());
    }

    std::string to_string() const override {
        std::ostringstream out;
        out << "Reflectree[" << std::endl
            << "  nested = " << (m_nested ? string::indent(m_nested) : fact(m_sampler.get(), "material")) << ","
            << std::endl
            << "  leaves = " << fact(m_sampler.get(), "one_shot_leaves") << std::endl
            << "]";
        return out.str();
    }

    MI_DECLARE_CLASS(Reflectree)

private:
    static int choice(const Properties &props, const char *name, const char *first, const char *second) {
        const std::string said = props.get<std::string>(name, first);
        if (said != first && said != second)
            Throw("reflectree: %s \"%s\" is none; say %s or %s", name, said, first, second);
        return said == second;
    }

    static std::string resolved(const std::string &path) { return file_resolver()->resolve(path).string(); }

    static uint32_t bits_of(float x) {
        uint32_t bits;
        std::memcpy(&bits, &x, sizeof bits);
        return bits;
    }

    // f cos of what is shown.
    Spectrum values(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo) const {
        if (m_nested)
            return m_nested->eval(BSDFContext(ctx.mode), si, wo, true);
        if (!(si.wi.z() > 0 && wo.z() > 0))
            return Spectrum(0.f);
        const float known[3] = { si.wi.x(), si.wi.y(), si.wi.z() }, wi[3] = { wo.x(), wo.y(), wo.z() };
        float f[3];
        check(reflectree_eval(m_sampler.get(), 1, known, wi, f));
        Spectrum out(f[0] * wo.z());
        if constexpr (!is_spectral_v<Spectrum>) {
            if (m_channels == 3)
                out = Spectrum(f[0], f[1], f[2]) * wo.z();
        }
        return out;
    }

    // f cos of the nested BSDF at a place of its own, channel by channel.
    void nested_values(const Vector3f &known, const Vector3f &drawn, float place, float *out) const {
        SurfaceInteraction3f si = dr::zeros<SurfaceInteraction3f>();
        si.t  = 1.f;
        si.wi = known;
        si.p  = Point3f(place - 0.5f, 2 * place - 1, 0);
        si.uv = Point2f(place, 1 - place);
        si.n  = Normal3f(0, 0, 1);
        si.sh_frame = Frame3f(Vector3f(1, 0, 0), Vector3f(0, 1, 0), Vector3f(0, 0, 1));
        si.dp_du = Vector3f(1, 0, 0), si.dp_dv = Vector3f(0, 1, 0);
        for (size_t k = 0; k < interactions; ++k) {
            if constexpr (is_spectral_v<Spectrum>)
                si.wavelengths = { wavelengths[k][0], wavelengths[k][1], wavelengths[k][2], wavelengths[k][3] };
            const Spectrum values = m_nested->eval(BSDFContext(), si, drawn, true);
            for (size_t c = 0; c < channels_of_spectrum; ++c)
                *out++ = float(values[c]);
        }
    }

    // Where values are negative, as interpolated measurements may be, their size is sampled.
    static int function_of_nested(void *user, size_t n, const float *wo, const float *wi, float *values) {
        const auto *self = static_cast<const Reflectree *>(user);
        constexpr size_t channels = channels_of_spectrum * interactions;
        for (size_t i = 0; i < n; ++i, values += channels) {
            const float *o = wo + 3 * i, *d = wi + 3 * i;
            self->nested_values(Vector3f(o[0], o[1], o[2]), Vector3f(d[0], d[1], d[2]), 0.5f, values);
            for (size_t c = 0; c < channels; ++c)
                values[c] = std::abs(values[c]) / d[2];
        }
        return 0;
    }

    void make_function() {
        reflectree_function *f;
        check(reflectree_function_callback("a BSDF of Mitsuba", int(channels_of_spectrum * interactions),
                                           REFLECTREE_CONCURRENT, function_of_nested, this, nullptr, &f));
        m_function.reset(f);
    }

    // Pairs of directions, half of them near the mirror direction.
    template <typename Body> static void probe(int count, const Body &body) {
        PCG32<uint32_t> random(1, 20080204);
        const auto direction = [&] {
            const float z = 0.05f + 0.95f * random.next_float32(), phi = 6.2831853f * random.next_float32();
            const float r = std::sqrt(1 - z * z);
            return Vector3f(r * std::cos(phi), r * std::sin(phi), z);
        };
        for (int i = 0; i < count; ++i) {
            const Vector3f wo = direction();
            Vector3f wi = direction();
            if (i >= count / 2)
                wi = dr::normalize(Vector3f(-wo.x(), -wo.y(), wo.z()) + 0.1f * random.next_float32() * wi);
            body(wo, wi);
        }
    }

    // Deltas, transmission, back sides and what varies over the surface.
    void refuse_what_cannot_be_wrapped() const {
        const auto refuse = [&](const char *what, const char *how) {
            Throw("reflectree around %s: %s; %s", m_nested->class_name(), what, how);
        };
        const auto flags = m_nested->flags();
        if (has_flag(flags, BSDFFlags::Delta) || has_flag(flags, BSDFFlags::Delta1D))
            refuse("it has a mirror-like part (a delta), which has no values to sample",
                   "nest a rough BSDF, or blend the mirror with a reflectree by a blendbsdf");
        if (has_flag(flags, BSDFFlags::Transmission))
            refuse("it transmits light, and samplers are of reflection", "nest a BSDF that reflects only");
        if (has_flag(flags, BSDFFlags::SpatiallyVarying))
            refuse("its parameters vary over the surface, and a sampler serves one set of them",
                   "nest a BSDF without textures");
        constexpr size_t channels = channels_of_spectrum * interactions;
        float largest = 0;
        probe(256, [&](const Vector3f &wo, const Vector3f &wi) {
            float values[channels];
            nested_values(wo, wi, 0.5f, values);
            for (float v : values)
                largest = std::max(largest, std::abs(v));
        });
        probe(256, [&](const Vector3f &wo, const Vector3f &wi) {
            const Vector3f under_o(wo.x(), wo.y(), -wo.z()), under_i(wi.x(), wi.y(), -wi.z());
            float values[channels], other[channels];
            nested_values(wo, under_i, 0.5f, values);
            for (float v : values)
                if (v != 0)
                    refuse("it transmits light, and samplers are of reflection", "nest a BSDF that reflects only");
            nested_values(under_o, under_i, 0.5f, values);
            for (float v : values)
                if (v != 0)
                    refuse("it reflects from the back side, too",
                           "nest what is inside of it, and put a twosided around the reflectree");
            nested_values(wo, wi, 0.5f, values);
            for (float place : { 0.f, 0.3f, 0.9f }) {
                nested_values(wo, wi, place, other);
                for (size_t c = 0; c < channels; ++c)
                    if (std::abs(other[c] - values[c]) > 1e-3f * std::abs(values[c]) + 1e-6f * largest)
                        refuse("its values vary over the surface, and a sampler serves one set of parameters",
                               "nest a BSDF without textures and bumps");
            }
        });
    }

    // From its file, where there is one; its name is that of the nested BSDF's text and of some values.
    OwnedSampler wrapped(const std::string &cache) const {
        const std::filesystem::path folder = cache_folder(cache);
        if (folder.empty())
            return build(m_function.get());
        std::ostringstream identity;
        identity << reflectree_version() << " " << (is_spectral_v<Spectrum> ? "spectral" : "rgb") << " "
                 << m_nested->class_name() << " " << m_nested->to_string();
        probe(32, [&](const Vector3f &wo, const Vector3f &wi) {
            float values[channels_of_spectrum * interactions];
            nested_values(wo, wi, 0.5f, values);
            for (float v : values)
                identity << " " << v;
        });
        const std::filesystem::path path = folder / ("native-" + digest(identity.str()) + ".rfl");
        std::error_code failed;
        if (std::filesystem::exists(path, failed)) {
            reflectree_sampler *s;
            if (reflectree_load(path.c_str(), m_function.get(), nullptr, &s) == REFLECTREE_OK)
                return OwnedSampler(s);
            Log(Warn, "reflectree: %s; it is built again", reflectree_last_error());
        }
        OwnedSampler built = build(m_function.get());
        std::filesystem::create_directories(folder, failed);
        if (reflectree_save(built.get(), path.c_str()) != REFLECTREE_OK)
            Log(Warn, "reflectree: the sampler is not kept: %s", reflectree_last_error());
        return built;
    }

    ref<Base> m_nested;
    OwnedFunction m_function; // empty: that of the sampler's file
    OwnedSampler m_sampler;
    int m_channels = 0;
    bool m_monotone = false, m_exact = false;
};

// The scalar variants; in others Mitsuba says that there is no such plug-in.
extern "C" MI_EXPORT void init_plugin(std::string_view name, PluginRegisterFn add) {
    const std::string running = util::info_build(1);
    if (running.find("Mitsuba version " MI_VERSION) == std::string::npos)
        Throw("reflectree: this plug-in was compiled for Mitsuba " MI_VERSION ", and this is \"%s\"; compile it again "
              "(docs/mitsuba.md)", running);
    using Rgb = Reflectree<float, Color<float, 3>>;
    using Spectral = Reflectree<float, Spectrum<float, 4>>;
    add(name, "scalar_rgb", Rgb::Type, [](void *, const Properties &p) -> ref<Object> { return new Rgb(p); });
    add(name, "scalar_spectral", Spectral::Type,
        [](void *, const Properties &p) -> ref<Object> { return new Spectral(p); });
}
NAMESPACE_END(mitsuba)
