// SPDX-License-Identifier: Apache-2.0
// 1. What is written is read back equal; the same data gives the same bytes.
// 2. Files of version 1 are read for ever: golden/sampler_v1.rfl.
// 3. Unknown optional chunks are skipped, unknown required ones refused by name.
// 4. Damage of any kind is an Error in one line; behind a mended checksum too.
#include "reflectree/formats/sampler_file.hpp"
#include "../scratch.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/checksum.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/sampler/member.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "synthetic_sampler.hpp"

namespace reflectree {
namespace {

const std::string golden = REFLECTREE_SOURCE "/golden/sampler_v1.rfl";

std::string words_of(ByteView bytes) {
  try {
    decode_sampler(bytes, "file");
  } catch (const Error& e) {
    const std::string words = e.what();
    EXPECT_EQ(words.find('\n'), std::string::npos) << words;
    EXPECT_EQ(words.rfind("file", 0), 0U) << words;
    EXPECT_NE(words.find("; "), std::string::npos) << words;
    return words;
  }
  return "";
}

Bytes with_checksum(Bytes bytes) {
  bytes.erase(bytes.end() - 4, bytes.end());
  append_u32(bytes, crc32(bytes));
  return bytes;
}

// The file with another chunk behind the magic.
Bytes with_chunk(const Bytes& file, const std::string& tag, std::uint8_t version, std::uint8_t flags) {
  Bytes chunk;
  append_text(chunk, tag);
  chunk.insert(chunk.end(), {version, 0, flags, 0});
  append_u64(chunk, 3);
  append_text(chunk, "abc");
  Bytes longer = file;
  longer.insert(longer.begin() + 8, chunk.begin(), chunk.end());
  return with_checksum(longer);
}

std::size_t find(const Bytes& file, const std::string& tag) {
  const auto at = std::search(file.begin(), file.end(), tag.begin(), tag.end());
  EXPECT_NE(at, file.end()) << tag;
  return std::size_t(at - file.begin());
}

TEST(Checksum, IsThatOfZipAndPng) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32(ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size())), 0xcbf43926U);
  EXPECT_EQ(crc32({}), 0U);
}

TEST(SamplerFile, ReadsWhatItWrites) {
  const SamplerData data = synthetic::sampler_data();
  const Bytes bytes = encode_sampler(data);
  EXPECT_EQ(decode_sampler(bytes, "file"), data);
  EXPECT_EQ(encode_sampler(decode_sampler(bytes, "file")), bytes);
}

// What most samplers have not costs no byte where it is absent.
TEST(SamplerFile, ScaleNotesAndProbesOfChannelsReturn) {
  SamplerData data = synthetic::sampler_data();
  const std::size_t plain = encode_sampler(data).size();
  data.target.scale = 0x1p80f;
  data.report.notes = {"exact mode takes 2 trials", "and more"};
  data.probes.channels.assign(2 * BrdfProbes::count, 0.5f);
  const Bytes bytes = encode_sampler(data);
  EXPECT_EQ(decode_sampler(bytes, "file"), data);
  EXPECT_GT(bytes.size(), plain + 2 * BrdfProbes::count * 4);
  data.target.scale = 0;
  EXPECT_THROW(encode_sampler(data), Error);
  data.target.scale = 1, data.probes.channels.pop_back();
  EXPECT_THROW(encode_sampler(data), Error);
}

TEST(SamplerFile, FamiliesReturn) {
  const SamplerData data = synthetic::family_data();
  const Bytes bytes = encode_sampler(data);
  EXPECT_EQ(decode_sampler(bytes, "file"), data);
  EXPECT_EQ(encode_sampler(decode_sampler(bytes, "file")), bytes);
  // A reader that does not know of families must refuse, and whoever knows must not do without.
  Bytes without = bytes;
  without[find(bytes, "FMLY")] = 'X';
  EXPECT_NE(words_of(with_checksum(without)).find("XMLY"), std::string::npos);
  without[find(bytes, "FMLY") + 6] = 1;
  EXPECT_NE(words_of(with_checksum(without)), "");
}

TEST(SamplerFile, ReadsTheGoldenFileOfAFamily) {
  const std::string path = REFLECTREE_SOURCE "/golden/family_v1.rfl";
  const Bytes bytes = read_file(path, 1 << 20);
  const SamplerData data = decode_sampler(bytes, path);
  EXPECT_EQ(encode_sampler(data), bytes);
  EXPECT_EQ(data.parameters, (std::vector<KnownParameter>{{{"alpha", 0.02f, 1}, true}}));
  EXPECT_EQ(data.law.x, (std::array<float, 3>{0.1f, 0.7f, 0}));
  EXPECT_EQ(data.albedo.parameters[0].rows, 4U);
}

TEST(SamplerFile, MembersOfFamiliesReturn) {
  const SamplerData family = synthetic::family_data();
  for (const float alpha : {0.02f, 0.1f, 0.2f, 1.f}) {
    const SamplerData data = member_data(family, {alpha}, "ggx", family.probes);
    // The slab above 0.75 is cut at a logarithm of -2, alpha = 0.135.
    EXPECT_EQ(data.exact.size(), 2U);
    EXPECT_EQ(data.exact[1], family.exact[alpha < 0.135f ? 1 : 2]);
    EXPECT_NEAR(data.domain.scale_x, std::exp(0.1 + 0.7 * std::log(double(alpha))), 1e-5);
    EXPECT_NEAR(data.domain.scale_y, std::exp(0.1 + 0.6 * std::log(double(alpha))), 1e-5);
    EXPECT_EQ(decode_sampler(encode_sampler(data), "file"), data);
  }
  for (const float alpha : {0.019f, 1.1f, NAN})
    EXPECT_THROW(member_data(family, {alpha}, "ggx", family.probes), Error);
  EXPECT_THROW(member_data(synthetic::sampler_data(), {0.1f}, "ggx", family.probes), Error);
}

TEST(SamplerFile, RefusesFamiliesThatAreNotValid) {
  const auto refused = [](const char* word, const auto& spoil) {
    SamplerData data = synthetic::family_data();
    spoil(data);
    try {
      encode_sampler(data);
      ADD_FAILURE() << word;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  refused("range", [](SamplerData& d) { d.parameters[0].range.hi = 2; });
  refused("smaller number", [](SamplerData& d) { d.parameters[0].range.hi = 0.01f; });
  refused("not positive", [](SamplerData& d) { d.parameters[0].range.lo = 0; });
  refused("another name", [](SamplerData& d) { d.exact_partition.coordinates[1].name = "beta"; });
  refused("widths", [](SamplerData& d) { d.law.x[1] = 5; });
  refused("axes", [](SamplerData& d) { d.albedo.parameters.clear(), d.albedo.albedo.resize(3); });
  refused("axis", [](SamplerData& d) { d.albedo.parameters[0].hi = 0.5f; });
  refused("rows", [](SamplerData& d) { d.albedo.parameters[0].rows = 3, d.albedo.albedo.resize(9); });
  refused("value each", [](SamplerData& d) { d.albedo.albedo.pop_back(); });
  refused("widths", [](SamplerData& d) { d.domain.scale_x = 0.5f; });
  refused("known coordinates", [](SamplerData& d) { d.parameters.clear(), d.law = {}; });
}

TEST(SamplerFile, SavesAndLoadsABuiltSamplerThatSamplesAlike) {
  const AnyBrdf f = make_brdf(parse_material("ggx:alpha=0.5"));
  const SamplerData data = build(f);
  const std::string path = scratch("sampler.rfl");
  save_sampler(path, data);
  const SamplerData loaded = load_sampler(path);
  std::filesystem::remove(path);
  EXPECT_EQ(loaded, data);
  const auto built = make_sampler(f, data), read = make_sampler(f, loaded);
  Pcg32 u(1), v(1);
  for (int i = 0; i < 1000; ++i) {
    const Direction wo = direction_from_angles(1.5f * float(i) / 1000, 0.3f);
    EXPECT_EQ(built.exact.sample(wo, u)->wi, read.exact.sample(wo, v)->wi);
    EXPECT_EQ(built.one_shot.sample(wo, u)->pdf, read.one_shot.sample(wo, v)->pdf);
  }
}

TEST(SamplerFile, RefusesToWriteWhatIsNotValid) {
  SamplerData data = synthetic::sampler_data();
  data.exact[0].mass[1] = 0;
  EXPECT_THROW(encode_sampler(data), Error);
}

// The file was written by this format's first release; never write it again.
TEST(SamplerFile, ReadsTheGoldenFileOfVersion1) {
  const Bytes bytes = read_file(golden, 1 << 20);
  const SamplerData data = decode_sampler(bytes, golden);
  EXPECT_EQ(encode_sampler(data), bytes);
  EXPECT_EQ(data.material, "ggx:alpha=0.5,f0=1/0.8/0.3");
  EXPECT_EQ(data.target, Target{});
  EXPECT_EQ(data.domain, (Domain{DomainKind::equal_area, Symmetry::mirror, 0}));
  ASSERT_EQ(data.exact.size(), 1U);
  EXPECT_EQ(data.exact[0].mass.size(), 5U);
  EXPECT_EQ(data.exact[0].status, BoundStatus::estimated);
  EXPECT_EQ(data.one_shot.size(), 2U);
  EXPECT_EQ(data.albedo.albedo.size(), 195U);
  EXPECT_EQ(data.report.evaluations, 268544U);
  const AnyBrdf f = make_brdf(parse_material(data.material));
  EXPECT_NO_THROW(check_identity(data, f));
  // It still samples: the mean weight of one-shot mode is the albedo.
  const auto sampler = make_sampler(f, data);
  const Direction wo = direction_from_angles(0.7f, 0.f);
  Pcg32 u(1);
  double sum = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    if (const auto s = sampler.one_shot.sample(wo, u)) sum += double(data.target(s->weight)) / n;
  }
  EXPECT_NEAR(sum, double(sampler.exact.albedo(wo)), 0.01);
}

TEST(SamplerFile, RefusesAnotherMaterial) {
  const SamplerData data = load_sampler(golden);
  EXPECT_THROW(check_identity(data, make_brdf(parse_material("ggx:alpha=0.51"))), Error);
}

TEST(SamplerFile, SkipsUnknownOptionalChunksAlone) {
  const Bytes file = encode_sampler(synthetic::sampler_data());
  EXPECT_EQ(decode_sampler(with_chunk(file, "NEWS", 1, 1), "file"), synthetic::sampler_data());
  EXPECT_EQ(decode_sampler(with_chunk(file, "MATL", 2, 1), "file"), synthetic::sampler_data());
  EXPECT_NE(words_of(with_chunk(file, "NEWS", 1, 0)).find("NEWS"), std::string::npos);
  EXPECT_NE(words_of(with_chunk(file, "MATL", 2, 0)).find("later version"), std::string::npos);
  EXPECT_NE(words_of(with_chunk(file, "MATL", 1, 0)), "");
}

TEST(SamplerFile, CanDoWithoutItsReportButNotWithoutATree) {
  const Bytes file = encode_sampler(synthetic::sampler_data());
  SamplerData bare = synthetic::sampler_data();
  bare.report = {};
  Bytes renamed = file;
  renamed[find(file, "REPT")] = 'X';
  EXPECT_EQ(decode_sampler(with_checksum(renamed), "file"), bare);
  for (const char* tag : {"MATL", "TARG", "DOMN", "EXPA", "EXTR", "ONPA", "ONTR", "ALBD", "PROB"}) {
    Bytes without = file;
    const std::size_t at = find(file, tag);
    without[at] = 'X', without[at + 6] = 1;  // optional
    EXPECT_NE(words_of(with_checksum(without)).find(tag), std::string::npos) << tag;
  }
}

// Behind a mended checksum, only files that lost exactly their optional last chunks are whole.
class SamplerFileDamage : public ::testing::TestWithParam<SamplerData> {};
INSTANTIATE_TEST_SUITE_P(All, SamplerFileDamage,
                         ::testing::Values(synthetic::sampler_data(), synthetic::family_data()),
                         [](const auto& of) { return of.index == 0 ? "OfOne" : "OfAFamily"; });

TEST_P(SamplerFileDamage, RefusesEveryTruncation) {
  const Bytes file = encode_sampler(GetParam());
  int whole = 0;
  for (std::size_t n = 0; n < file.size(); ++n) {
    const Bytes shorter(file.begin(), file.begin() + std::ptrdiff_t(n));
    ASSERT_NE(words_of(shorter), "") << n;
    if (n >= 12 && words_of(with_checksum(shorter)).empty()) ++whole;
  }
  // Cut between optional chunks a file is whole.
  EXPECT_EQ(whole, GetParam().parameters.empty() ? 3 : 2);
}

TEST_P(SamplerFileDamage, NoticesEveryFlippedBit) {
  Bytes file = encode_sampler(GetParam());
  for (std::size_t bit = 0; bit < file.size() * 8; ++bit) {
    const auto mask = std::uint8_t(1U << (bit % 8));
    file[bit / 8] ^= mask;
    ASSERT_NE(words_of(file), "") << bit;
    file[bit / 8] ^= mask;
  }
}

// Behind a right checksum a flip is refused, or leads to data that is valid, packs, and writes again.
TEST_P(SamplerFileDamage, SurvivesEveryFlippedBitBehindAMendedChecksum) {
  Bytes file = encode_sampler(GetParam());
  int refused = 0, accepted = 0;
  for (std::size_t bit = 0; bit + 32 < file.size() * 8; ++bit) {
    const auto mask = std::uint8_t(1U << (bit % 8));
    file[bit / 8] ^= mask;
    const Bytes mended = with_checksum(file);
    file[bit / 8] ^= mask;
    if (!words_of(mended).empty()) {
      ++refused;
      continue;
    }
    ++accepted;
    const SamplerData data = decode_sampler(mended, "file");
    EXPECT_NO_THROW(pack(data)) << bit;
    EXPECT_NO_THROW(encode_sampler(data)) << bit;
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(accepted, 1000);
}

TEST(SamplerFile, NamesForeignEmptyAndOversizedFiles) {
  EXPECT_NE(words_of({}).find("empty"), std::string::npos);
  const Bytes foreign(1000, std::uint8_t('x'));
  EXPECT_NE(words_of(foreign).find("not a sampler"), std::string::npos);
  Bytes longer = encode_sampler(synthetic::sampler_data());
  longer.push_back(0);
  EXPECT_NE(words_of(longer), "");
  // Lengths that nothing backs are refused before memory is asked for.
  const Bytes file = encode_sampler(synthetic::sampler_data());
  for (const char* tag : {"MATL", "EXPA", "EXTR", "ONTR", "ALBD", "PROB"}) {
    Bytes huge = file;
    const std::size_t count = find(file, tag) + 16 + (std::string(tag) == "ALBD" ? 4 : 0);
    for (std::size_t i = 0; i < 4; ++i) huge[count + i] = 0xff;
    EXPECT_NE(words_of(with_checksum(huge)), "") << tag;
    Bytes chunk = file;
    for (std::size_t i = 8; i < 16; ++i) chunk[find(file, tag) + i] = 0xff;
    EXPECT_NE(words_of(with_checksum(chunk)), "") << tag;
  }
}

}  // namespace
}  // namespace reflectree
