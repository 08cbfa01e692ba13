// SPDX-License-Identifier: Apache-2.0
// The runtime of one file draws the bits of the C++ samplers, in every domain and from every way in, and
// refuses what the library refuses.
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/formats/checksum.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "runtime_in_c.h"

namespace reflectree {
namespace {

// A function of two directions, evaluated in the caller's frame by both sides.
struct Subject {
  std::string name;
  std::function<Rgb(Direction, Direction)> f;
  BuildOptions options = {};
  int draws = 20'000;

  Rgb operator()(Direction wo, Direction wi) const { return f(wo, wi); }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.name = name;
    return traits;
  }
};

Subject material(const char* text, std::optional<Domain> domain = {}, int draws = 20'000) {
  const AnyBrdf f = make_brdf(parse_material(text));
  Subject subject{
      text, [f](Direction wo, Direction wi) { return to_rgb(f(shading_geometry(wo, wi))); }, {}, draws};
  subject.options.domain = domain;
  return subject;
}

// Brighter on one side of the plane of incidence: the whole square.
Rgb lopsided(Direction wo, Direction wi) { return to_rgb(0.3f * (1 + 0.8f * (wo.x * wi.y - wo.y * wi.x))); }

const char* const chosen[] = {"ggx:alpha=0.1", "retro_reflector:alpha=0.1", "phong:n=50", "oren_nayar",
                              "0.3*lambert:rho=0.5 + plastic:alpha=0.2"};

std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (int kind = 0; kind <= int(DomainKind::normal_vector); ++kind) {
    Domain domain;
    domain.kind = DomainKind(kind);
    domain.exponent = domain.kind == DomainKind::stretched ? 1.4f : 0;
    for (const Symmetry symmetry : {Symmetry::mirror, Symmetry::none}) {
      domain.symmetry = symmetry;
      all.push_back(material("oren_nayar", domain));
      all.back().options.expected_trials = 2;
      all.back().options.one_shot_variance = 0.1f;
      if (symmetry == Symmetry::none) {
        Subject skew{"lopsided", lopsided};
        skew.options.domain = domain;
        all.push_back(skew);
      }
    }
  }
  for (const Target target :
       {Target{TargetKind::luminance, 0}, Target{TargetKind::maximum, 0}, Target{TargetKind::channel, 2}}) {
    all.push_back(material("plastic:alpha=0.2"));
    all.back().options.target = target;
  }
  // Values whose squares leave the range of float: the sampler has a scale.
  Subject tiny = material("ggx:alpha=0.3");
  tiny.f = [f = tiny.f](Direction wo, Direction wi) { return scaled_value(f(wo, wi), 0x1p-100f); };
  all.push_back(tiny);
  return all;
}

rfl_vec vec(Direction w) { return {w.x, w.y, w.z}; }
Direction direction(rfl_vec w) { return {w.x, w.y, w.z}; }
std::uint32_t next_bits(void* state) { return (*static_cast<Pcg32*>(state))(); }
void evaluate(void* user, rfl_vec wo, rfl_vec wi, float* f) {
  const Rgb value = (*static_cast<const Subject*>(user))(direction(wo), direction(wi));
  f[0] = value.r, f[1] = value.g, f[2] = value.b;
}

// Over the hemisphere, at grazing more often; some are no viewers.
Direction viewer(Pcg32& u) {
  const float z = sqr(to_unit_float(u())), phi = 2 * pi * to_unit_float(u()), r = sqrt(1 - z * z);
  const std::uint32_t special = u() & 1023U;
  if (special == 0) return {0, 0, 1};
  if (special == 1) return {r, 0, -z};
  if (special == 2) return {2 * r, 0, z};
  return {r * cos(phi), r * sin(phi), z};
}

using Drawn = std::optional<DirectionSample<Rgb>>;

// The number of draws that differ in a bit.
int differences(const Drawn& ours, bool drawn, const rfl_draw& theirs, const float* f) {
  if (bool(ours) != drawn) return 1;
  if (!ours) return 0;
  bool same = ours->wi == direction(theirs.wi) && ours->pdf == theirs.pdf;
  for (int c = 0; c < 3; ++c) same = same && channel_value(ours->weight, c) == f[c] * theirs.scale;
  return same ? 0 : 1;
}

struct Pair {
  Subject subject;
  SamplerData data;
  Sampler<Subject> ours;
  rfl_sampler theirs{};
  const char* error;

  explicit Pair(const Subject& s)
      : subject(s), data(build(AnyBrdf(s), s.options)), ours(make_sampler(s, data)) {
    const Bytes bytes = encode_sampler(data);
    error = c_load(&theirs, bytes.data(), bytes.size());
  }
  Pair(const Pair&) = delete;
  ~Pair() { rfl_free(&theirs); }
};

// All ways in. Returns draws that differ.
int compare(Pair& p) {
  int wrong = 0;
  std::array<float, 3> f{};
  rfl_draw d;
  Pcg32 viewers(3), a(17, 1), b(17, 1);
  for (int i = 0; i < p.subject.draws; ++i) {
    const Direction wo = viewer(viewers);
    Drawn ours = p.ours.exact.sample(wo, a);
    bool drawn = c_exact(&p.theirs, vec(wo), evaluate, &p.subject, 3, next_bits, &b, &d, f.data()) != 0;
    wrong += differences(ours, drawn, d, f.data());
    ours = p.ours.one_shot.sample(wo, a);
    drawn = c_one_shot(&p.theirs, vec(wo), next_bits, &b, &d) != 0;
    if (drawn) evaluate(&p.subject, vec(wo), d.wi, f.data());
    wrong += differences(ours, drawn, d, f.data());
    if (i % 4 != 0) continue;
    const double u1 = to_unit_double(viewers()), u2 = to_unit_double(viewers());
    ours = p.ours.one_shot.sample(wo, u1, u2);
    drawn = c_one_shot_uniforms(&p.theirs, vec(wo), u1, u2, &d) != 0;
    if (drawn) evaluate(&p.subject, vec(wo), d.wi, f.data());
    wrong += differences(ours, drawn, d, f.data());
    // Densities and inverse, of the sample, and of any direction.
    for (const Direction wi : {ours ? ours->wi : Direction{0, 0, 1}, viewer(viewers)}) {
      wrong += p.ours.one_shot.pdf(wo, wi) != c_one_shot_pdf(&p.theirs, vec(wo), vec(wi));
      double u[2] = {-1, -1};
      const auto back = p.ours.one_shot.invert(wo, wi);
      wrong += bool(back) != (c_one_shot_invert(&p.theirs, vec(wo), vec(wi), u) != 0);
      wrong += back && (back->x != u[0] || back->y != u[1]);
      if (!(wi.z > 0)) continue;
      evaluate(&p.subject, vec(wo), vec(wi), f.data());
      wrong += p.ours.exact.pdf(wo, wi) != c_exact_pdf(&p.theirs, vec(wo), vec(wi), f.data(), 3);
    }
  }
  return wrong;
}

void expect_the_same_bits(const Subject& subject) {
  Pair p(subject);
  const std::string name = subject.name + " in " + name_of(p.data.domain.kind);
  ASSERT_EQ(p.error, nullptr) << name << ": " << p.error;
  EXPECT_EQ(compare(p), 0) << name;
}

TEST(Runtime, DrawsTheBitsOfTheSamplers) {
  for (const char* text : chosen) expect_the_same_bits(material(text));  // in the domain that the builder chooses
}

TEST(RuntimeDomains, DrawTheBitsOfTheSamplers) {
  for (const Subject& subject : subjects()) expect_the_same_bits(subject);
}

TEST(RuntimeMillion, DrawsTheBitsOfTheSamplers) {
  for (const char* text : chosen) expect_the_same_bits(material(text, {}, 1'000'000));
}

// The twin: another height, threshold or slope of the heaviest leaf of one slab is seen.
TEST(Runtime, AnotherLeafIsSeen) {
  Pair p(material("ggx:alpha=0.1", {}, 20'000));
  ASSERT_EQ(p.error, nullptr);
  for (const rfl_lookup& forest : {p.theirs.exact, p.theirs.one_shot}) {
    const std::uint32_t* slab = forest.table + RFL_SLAB * 4;
    const auto mass = [&](std::uint32_t i) {
      const std::uint32_t* leaf = p.theirs.words + slab[0] + RFL_LEAF * i;
      return rfl_float(leaf[1]) * rfl_power(127U - ((leaf[3] >> 16U) & 255U) - (leaf[3] >> 24U));
    };
    std::uint32_t heaviest = 0;
    for (std::uint32_t i = 0; i < slab[1]; ++i) heaviest = mass(i) > mass(heaviest) ? i : heaviest;
    std::uint32_t* leaf = p.theirs.owned + slab[0] + RFL_LEAF * heaviest;
    const std::uint32_t good[RFL_LEAF] = {leaf[0], leaf[1], leaf[2], leaf[3], leaf[4]};
    leaf[0] /= 2;
    EXPECT_GT(compare(p), 0) << "threshold";
    leaf[0] = good[0], leaf[1] ^= 1U << 18U;
    EXPECT_GT(compare(p), 0) << "height";
    leaf[1] = good[1], leaf[4] ^= 4U;
    EXPECT_GT(compare(p), 0) << "slope along x";
    leaf[4] = good[4];
  }
  EXPECT_EQ(compare(p), 0);
}

TEST(Runtime, AnisotropicSamplersAreRefusedInWords) {
  BuildOptions coarse;
  coarse.expected_trials = 4, coarse.one_shot_variance = 1;
  const Bytes bytes = encode_sampler(build(make_brdf(parse_material("ggx:alpha_x=0.5,alpha_y=0.6")), coarse));
  rfl_sampler s;
  const char* error = c_load(&s, bytes.data(), bytes.size());
  ASSERT_NE(error, nullptr);
  EXPECT_NE(std::string(error).find("anisotropic"), std::string::npos);
  EXPECT_EQ(s.words, nullptr);
}

// Where the payload of a chunk is.
std::pair<std::size_t, std::size_t> chunk_of(const Bytes& file, const std::string& tag) {
  for (std::size_t at = 8; at + 16 <= file.size() - 4;) {
    ByteReader head(ByteView(file).subspan(at), "test");
    const std::string name = head.text(4);
    head.u32();
    const std::uint64_t length = head.u64();
    if (name == tag) return {at + 16, std::size_t(length)};
    at += 16 + std::size_t(length);
  }
  return {0, 0};
}

// Bytes are damaged and the checksum is made good: whatever the library refuses the runtime refuses, and what
// it takes the runtime takes. Under a sanitizer this also shows that no length or index is believed.
TEST(Runtime, JudgesDamagedFilesAsTheLibraryDoes) {
  const Bytes good = encode_sampler(build(make_brdf(parse_material("plastic:alpha=0.3"))));
  Pcg32 u(23);
  int refused = 0, taken = 0;
  for (const char* tag : {"TARG", "DOMN", "EXPA", "EXTR", "ONPA", "ONTR", "ALBD"}) {
    const auto [at, length] = chunk_of(good, tag);
    ASSERT_GT(length, 0U);
    for (int i = 0; i < 400; ++i) {
      Bytes bad = good;
      const std::size_t first = i < 60 ? std::size_t(i) % length : u() % length;
      for (int k = u() % 3; k >= 0; --k) bad[at + (first + u() % 2) % length] = std::uint8_t(u() >> 13U);
      if (i % 7 == 0) bad[at + first] = std::uint8_t(good[at + first] ^ (1U << (u() % 8)));
      bad.resize(bad.size() - 4);
      append_u32(bad, crc32(bad));
      bool library = true;
      try {
        decode_sampler(bad, "test");
      } catch (const std::exception&) {
        library = false;
      }
      rfl_sampler s;
      const char* error = c_load(&s, bad.data(), bad.size());
      EXPECT_EQ(library, error == nullptr) << tag << " " << i << ": " << (error ? error : "taken");
      ++(library ? taken : refused);
      rfl_free(&s);
    }
  }
  EXPECT_GT(refused, 200);
  EXPECT_GT(taken, 200);
  // Cut anywhere, or with another checksum.
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 7) {
    rfl_sampler s;
    EXPECT_NE(c_load(&s, good.data(), size), nullptr);
  }
}

}  // namespace
}  // namespace reflectree
