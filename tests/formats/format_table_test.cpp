// SPDX-License-Identifier: Apache-2.0
// What every row of the table of formats promises:
//   1 its words are given, and its example names a file of that ending
//   2 it recognises its examples, whatever their names; no other row does
//   3 read whole, an example is a sound BRDF of the canonical name, for each of its members
//   4 cut short, it is refused in one line, or is sound as well
#include "reflectree/formats/format_table.hpp"

#include <gtest/gtest.h>

#include <set>

#include "examples.hpp"
#include "measured_data.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/merl.hpp"

namespace reflectree {
namespace {

// Whether the bytes are read; if so, the BRDF is checked.
bool reads(ByteView bytes, const std::string& member) {
  static const Pairs pairs = random_pairs(20, 0.5f, 13);
  try {
    const AnyBrdf f = read_brdf(bytes, "a file", member);
    std::vector<float> values(pairs.wo.size() * std::size_t(f.channels()));
    f.eval(pairs.wo, pairs.wi, values);
    for (const float v : values) EXPECT_TRUE(v >= 0 && std::isfinite(v)) << v;
    if (!member.empty()) {
      EXPECT_EQ(f.traits().name, file_text("a file", member));
    }
    return true;
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).rfind("a file: ", 0), 0U) << e.what();
    return false;
  }
}

class FormatTable : public testing::TestWithParam<const MaterialFormat*> {
 protected:
  const MaterialFormat& format = *GetParam();

  std::vector<Bytes> examples() const {
    std::vector<Bytes> files = example_files(format.key);
    if (format.key == "merl") files.push_back(write_merl(tabulate_merl(Lambert{})));
    return files;
  }
  std::vector<std::string> members(ByteView bytes) const {
    std::vector<std::string> names;
    if (format.list_members) names = format.list_members(bytes, "a file");
    if (format.members != FileMembers::materials) names.insert(names.begin(), "");
    return names;
  }
};

TEST_P(FormatTable, GivesItsWords) {
  EXPECT_FALSE(format.key.empty() || format.name.empty() || format.kind.empty());
  const Material m = parse_material(format.example);
  ASSERT_EQ(m.terms.size(), 1U);
  EXPECT_TRUE(m.terms[0].path.ends_with(format.ending)) << format.example;
  EXPECT_EQ(m.terms[0].member.empty(), format.members != FileMembers::materials) << format.example;
  EXPECT_EQ(format.list_members == nullptr, format.members == FileMembers::none);
  EXPECT_NE(format_names().find(format.name), std::string::npos);
}

TEST_P(FormatTable, RecognisesItsExamplesAlone) {
  const std::vector<Bytes> files = examples();
  ASSERT_FALSE(files.empty()) << "keep a small file as examples/" << format.key << format.ending;
  for (const Bytes& bytes : files) {
    for (const MaterialFormat& other : material_formats())
      EXPECT_EQ(other.recognised(bytes), &other == &format) << other.key;
    EXPECT_EQ(&format_of(bytes, "a file"), &format);
  }
  for (const std::string text : {"", "x", "<html>", "lambert"})
    EXPECT_FALSE(format.recognised(synthetic::as_bytes(text)));
}

TEST_P(FormatTable, ReadsAnExampleAndEachOfItsMembers) {
  int read = 0;
  for (const Bytes& bytes : examples()) {
    ASSERT_LE(bytes.size(), format.max_bytes);
    for (const std::string& member : members(bytes)) read += reads(bytes, member);
    EXPECT_FALSE(reads(bytes, "no such member"));
  }
  EXPECT_GT(read, 0);
}

TEST_P(FormatTable, RefusesOrReadsWhatIsCutShort) {
  for (const Bytes& bytes : example_files(format.key)) {
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 500);
    for (std::size_t n = 0; n < bytes.size(); n += step) reads(ByteView(bytes).first(n), "");
    EXPECT_FALSE(reads(ByteView(bytes).first(bytes.size() / 2), ""));
  }
}

TEST_P(FormatTable, TellsWhatIsDoubtful) {
  if (!format.facts) return;
  for (const Bytes& bytes : examples()) {
    for (const std::string& member : members(bytes)) {
      if (!reads(bytes, member)) continue;
      const MeasuredFacts facts = format.facts(bytes, "a file", member);
      EXPECT_FALSE(facts.kind.empty());
      EXPECT_LE(facts.negative + facts.not_measured, facts.entries);
    }
  }
}

std::vector<const MaterialFormat*> all_formats() {
  std::vector<const MaterialFormat*> all;
  for (const MaterialFormat& format : material_formats()) all.push_back(&format);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Rows, FormatTable, testing::ValuesIn(all_formats()),
                         [](const auto& row) { return std::string(row.param->key); });

TEST(FormatTableWords, AreDistinct) {
  std::set<std::string_view> keys, kinds;
  for (const MaterialFormat& format : material_formats()) keys.insert(format.key), kinds.insert(format.kind);
  EXPECT_EQ(keys.size(), material_formats().size());
  EXPECT_EQ(kinds.size(), material_formats().size());
  EXPECT_EQ(format_names().rfind("an RGL tensor_file, a MERL .binary, ", 0), 0U) << format_names();
}

}  // namespace
}  // namespace reflectree
