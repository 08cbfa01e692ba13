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

// Two lobes turned against each other and a lopsided ground: nothing to fold.
Rgb two_lobes(Direction wo, Direction wi) {
  const Direction h = normalize(wo + wi);
  const auto lobe = [&](float phi, float ax, float ay) {
    const float c = cos(phi), s = sin(phi), x = (c * h.x + s * h.y) / ax, y = (c * h.y - s * h.x) / ay;
    return std::exp(-(x * x + y * y) / (h.z * h.z));
  };
  const float ground = 0.1f + 0.05f * wi.x;
  return {ground + 0.5f * lobe(0.4f, 0.3f, 0.8f), ground + 0.3f * lobe(1.5f, 0.6f, 0.4f), ground};
}
// A step in the elevation of the viewer: a jump in the table of the albedo.
Rgb stepped(Direction wo, Direction wi) { return to_rgb((0.2f + 0.1f * wi.z) * (wo.z > 0.6f ? 1.f : 0.8f)); }
// Of no symmetry, and of one mirror plane.
Rgb skew(Direction wo, Direction wi) { return to_rgb(0.2f + 0.1f * wo.x * wi.y + 0.05f * wi.x); }
Rgb leaning(Direction, Direction wi) { return to_rgb(0.2f + 0.15f * wi.x); }

Subject coarse(Subject subject) {
  subject.options.expected_trials = 4, subject.options.one_shot_variance = 1;
  subject.options.albedo_error = 3e-2f;
  return subject;
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

  explicit Pair(const Subject& s) : Pair(s, build(AnyBrdf(s), s.options)) {}
  Pair(const Subject& s, const SamplerData& built) : subject(s), data(built), ours(make_sampler(s, data)) {
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

void expect_the_same_bits(const Subject& subject, const SamplerData& data) {
  Pair p(subject, data);
  const std::string name =
      subject.name + " in " + name_of(data.domain.kind) + ", " + name_of(data.frame.symmetry);
  ASSERT_EQ(p.error, nullptr) << name << ": " << p.error;
  EXPECT_EQ(compare(p), 0) << name;
}

void expect_the_same_bits(const Subject& subject) {
  expect_the_same_bits(subject, build(AnyBrdf(subject), subject.options));
}

TEST(Runtime, DrawsTheBitsOfTheSamplers) {
  for (const char* text : chosen)
    expect_the_same_bits(material(text));  // in the domain that the builder chooses
  expect_the_same_bits({"stepped", stepped});
}

TEST(RuntimeDomains, DrawTheBitsOfTheSamplers) {
  for (const Subject& subject : subjects()) expect_the_same_bits(subject);
}

TEST(RuntimeMillion, DrawsTheBitsOfTheSamplers) {
  for (const char* text : chosen) expect_the_same_bits(material(text, {}, 1'000'000));
}

// Over half the circle, with the albedo's rows of a few viewers in segments of two, of three and of five rows.
SamplerData in_segments(SamplerData data) {
  const std::vector<float> old = std::exchange(data.albedo.albedo, {});
  const std::size_t columns = data.albedo.cos_theta_o.size();
  for (const std::size_t k : {0, 1, 2, 1, 0, 2, 1, 0, 1, 0}) {
    const auto first = old.begin() + std::ptrdiff_t(k * columns);
    data.albedo.albedo.insert(data.albedo.albedo.end(), first, first + std::ptrdiff_t(columns));
  }
  const float a = 0.5f, b = 1.2f, c = data.albedo.phi_o.back(), step = 0.25f * (c - b);
  data.albedo.phi_o = {0, a, a, 0.5f * (a + b), b, b, b + step, b + 2 * step, b + 3 * step, c};
  return data;
}

// Every symmetry of the viewer as it is built; then symmetries, domains and segments of the albedo by changed data,
// whose directions follow nothing, but must be the same.
TEST(Runtime, DrawsTheBitsOfAnisotropicSamplers) {
  Subject metal = coarse(material("ggx:alpha_x=0.3,alpha_y=0.5,phi_deg=20"));
  metal.draws = 10'000, metal.options.expected_trials = 1.5f, metal.options.one_shot_variance = 0.05f;
  const SamplerData two_planes = build(AnyBrdf(metal), metal.options);
  EXPECT_EQ(two_planes.frame.symmetry, ViewerSymmetry::two_planes);
  EXPECT_EQ(two_planes.domain.kind, DomainKind::slope_star);
  EXPECT_GT(two_planes.exact.size(), 4U);
  EXPECT_GT(two_planes.one_shot.size(), 4U);
  expect_the_same_bits(metal, two_planes);
  const Subject skewed = coarse({"skewed", skew, {}, 5'000});
  const SamplerData none = build(AnyBrdf(skewed), skewed.options);
  EXPECT_EQ(none.frame.symmetry, ViewerSymmetry::none);
  expect_the_same_bits(skewed, none);

  Subject plane = coarse({"leaning", leaning, {}, 5'000});
  const SamplerData one_plane = build(AnyBrdf(plane), plane.options);
  EXPECT_EQ(one_plane.frame.symmetry, ViewerSymmetry::one_plane);
  expect_the_same_bits(plane, one_plane);
  plane.draws = 200;  // many of them by 256 trials in vain
  expect_the_same_bits(plane, in_segments(one_plane));
  SamplerData half_turn = one_plane;
  half_turn.frame.symmetry = ViewerSymmetry::half_turn, half_turn.albedo.even = false;
  for (int kind = 0; kind <= int(DomainKind::slope_star); ++kind) {
    half_turn.domain.kind = DomainKind(kind);
    half_turn.domain.exponent = half_turn.domain.kind == DomainKind::stretched ? 1.4f : 0;
    half_turn.domain.stretch = 0.7f;
    expect_the_same_bits(plane, half_turn);
  }
  expect_the_same_bits(plane, in_segments(half_turn));
}

TEST(RuntimeAnisotropicMillion, DrawsTheBitsOfTheSamplers) {
  expect_the_same_bits(material("ggx:alpha_x=0.05,alpha_y=0.3", {}, 1'000'000));
  Subject lobes{"two lobes", two_lobes, {}, 1'000'000};
  lobes.options.expected_trials = 1.5f, lobes.options.one_shot_variance = 0.05f;
  lobes.options.albedo_error = 1e-3f;
  expect_the_same_bits(lobes);
}

// The twin: another height, threshold or slope of the heaviest leaf of one slab is seen.
TEST(Runtime, AnotherLeafIsSeen) {
  Pair p(material("ggx:alpha=0.1", {}, 20'000));
  ASSERT_EQ(p.error, nullptr);
  for (const rfl_lookup& forest : {p.theirs.h.exact, p.theirs.h.one_shot}) {
    const std::uint32_t* slab = p.theirs.words + forest.table + RFL_SLAB * 4;
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
struct Verdicts {
  int refused = 0, taken = 0;
};
Verdicts judge_damaged(const Bytes& good, const std::vector<const char*>& tags, int times) {
  Pcg32 u(23);
  Verdicts verdicts;
  for (const char* tag : tags) {
    const auto [at, length] = chunk_of(good, tag);
    EXPECT_GT(length, 0U);
    for (int i = 0; i < times && length > 0; ++i) {
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
      ++(library ? verdicts.taken : verdicts.refused);
      rfl_free(&s);
    }
  }
  // Cut anywhere, or with another checksum.
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 7) {
    rfl_sampler s;
    EXPECT_NE(c_load(&s, good.data(), size), nullptr);
  }
  return verdicts;
}

TEST(Runtime, JudgesDamagedFilesAsTheLibraryDoes) {
  const Bytes good = encode_sampler(build(make_brdf(parse_material("plastic:alpha=0.3"))));
  const Verdicts verdicts =
      judge_damaged(good, {"TARG", "DOMN", "EXPA", "EXTR", "ONPA", "ONTR", "ALBD"}, 400);
  EXPECT_GT(verdicts.refused, 200);
  EXPECT_GT(verdicts.taken, 200);
}

TEST(Runtime, JudgesDamagedAnisotropicFilesAsTheLibraryDoes) {
  const Subject plane = coarse({"leaning", leaning});
  const SamplerData data = build(AnyBrdf(plane), plane.options);
  for (const SamplerData& one : {data, in_segments(data)}) {
    const Verdicts verdicts =
        judge_damaged(encode_sampler(one), {"DOMN", "EXPA", "EXTR", "ONPA", "ONTR", "ALBD", "ANIS"}, 100);
    EXPECT_GT(verdicts.refused, 50);
    EXPECT_GT(verdicts.taken, 50);
  }
}

// A family, and a member cut out of one, are refused in words.
TEST(Runtime, FamiliesAreRefusedInWords) {
  Bytes file = encode_sampler(build(make_brdf(parse_material("lambert"))));
  file.resize(file.size() - 4);
  for (const char c : {'W', 'D', 'T', 'H'}) file.push_back(std::uint8_t(c));
  file.insert(file.end(), {1, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0});
  for (int i = 0; i < 2; ++i) append_f32(file, 2);
  append_u32(file, crc32(file));
  rfl_sampler s;
  const char* error = c_load(&s, file.data(), file.size());
  ASSERT_NE(error, nullptr);
  EXPECT_NE(std::string(error).find("family"), std::string::npos);
  EXPECT_EQ(s.words, nullptr);
}

}  // namespace
}  // namespace reflectree
