// SPDX-License-Identifier: Apache-2.0
// Text -> material -> BRDF -> sampler, and the places where files are looked for.
#include "reflectree/formats/open.hpp"

#include <gtest/gtest.h>

#include "measured_data.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

namespace fs = std::filesystem;

// Small enough for a test.
BuildOptions quick() {
  BuildOptions options;
  options.expected_trials = 4;
  options.one_shot_variance = 1;
  return options;
}

// data/m.csv, work/g.rfl of that table, and a current folder without either.
class Open : public testing::Test {
 protected:
  Open() : folder_("open"), before_(fs::current_path()) {
    for (const char* name : {"data", "work", "here"}) fs::create_directories(folder_ / name);
    write_file_atomically(folder_ / "data/m.csv", std::string_view(synthetic::abc_csv()));
    fs::current_path(folder_ / "here");
  }
  ~Open() override { fs::current_path(before_); }
  FilePlaces data() const { return {folder_ / "data", "", nullptr}; }
  TemporaryFolder folder_;

 private:
  fs::path before_;
};

TEST_F(Open, PlacesAreAsNamedThenBesideThenTheData) {
  EXPECT_EQ(FilePlaces{}.find("m.csv"), "m.csv");
  EXPECT_EQ(data().find("m.csv"), folder_ / "data/m.csv");
  EXPECT_EQ(data().find("/m.csv"), "/m.csv") << "an absolute path is what it is";
  EXPECT_EQ(data().find("none"), "none");
  write_file_atomically(folder_ / "work/m.csv", std::string_view(synthetic::abc_csv()));
  const FilePlaces neighbours = data().with_neighbours_of(folder_ / "work/g.rfl");
  EXPECT_EQ(neighbours.find("m.csv"), folder_ / "work/m.csv");
  write_file_atomically("m.csv", std::string_view("x"));
  EXPECT_EQ(neighbours.find("m.csv"), "m.csv");
}

TEST_F(Open, ATextIsAMaterialWhereverItsFilesAre) {
  EXPECT_EQ(open_brdf("ggx:alpha=.1").traits().name, "ggx:alpha=0.1,f0=1/0.8/0.3");
  std::string told;
  FilePlaces places = data();
  places.elsewhere = [&](const std::string& path, const std::string& found) { told = path + " " + found; };
  EXPECT_EQ(open_brdf("0.5*m.csv#bronze + lambert", places).traits().name,
            "0.5*m.csv#bronze + lambert:rho=0.5");
  EXPECT_EQ(told, "m.csv " + (folder_ / "data/m.csv"));
  EXPECT_THROW(open_brdf("m.csv"), Error);
  EXPECT_THROW(open_brdf("no_model", places), Error);
}

TEST_F(Open, ASamplerFileIsOpenedWithTheMaterialBesideIt) {
  const OpenedSampler built = open_sampler("m.csv#bronze", data(), quick());
  EXPECT_EQ(built.text, "m.csv#bronze");
  EXPECT_TRUE(built.build_seconds && built.sampler_file.empty() && !built.file_size);
  const std::string file = folder_ / "work/g.rfl";
  save_sampler(file, built.data);
  EXPECT_TRUE(names_sampler_file(file, {}));
  EXPECT_FALSE(names_sampler_file("m.csv", data()));
  EXPECT_FALSE(names_sampler_file("ggx", data()));

  EXPECT_THROW(open_sampler(file), Error) << "its material is nowhere";
  for (const FilePlaces& places : {data(), FilePlaces{}}) {
    const OpenedSampler loaded = open_sampler(file, places);
    EXPECT_EQ(loaded.data, built.data);
    EXPECT_EQ(loaded.sampler_file, file);
    EXPECT_EQ(loaded.file_size, fs::file_size(file));
    EXPECT_FALSE(loaded.build_seconds);
    const Direction wo{0.6f, 0, 0.8f}, wi{-0.48f, 0.36f, 0.8f};
    EXPECT_EQ(loaded.sampler.exact.pdf(wo, wi), built.sampler.exact.pdf(wo, wi));
    EXPECT_EQ(open_brdf(file, places).traits().name, "m.csv#bronze");
    fs::copy_file(folder_ / "data/m.csv", folder_ / "work/m.csv", fs::copy_options::skip_existing);
  }
}

TEST_F(Open, AnotherMaterialOfThatNameIsRefused) {
  const std::string file = folder_ / "work/g.rfl";
  save_sampler(file, open_sampler("m.csv#bronze", data(), quick()).data);
  std::string other = synthetic::abc_csv();
  other.replace(other.find("51.7"), 4, "91.7");
  write_file_atomically(folder_ / "work/m.csv", std::string_view(other));
  EXPECT_THROW(open_sampler(file, data()), Error);
  EXPECT_THROW(open_brdf(file, data()), Error);
}

TEST_F(Open, AFunctionOfOnesOwnIsBuiltAlike) {
  const AnyBrdf f = [](Direction, Direction) { return 0.3f; };
  const OpenedSampler subject = build_named_sampler("mine", f, {}, quick(), {});
  EXPECT_EQ(subject.text, "mine");
  EXPECT_EQ(subject.f.channels(), 1);
  EXPECT_GT(subject.sampler.exact.pdf({0, 0, 1}, {0, 0, 1}), 0);
}

}  // namespace
}  // namespace reflectree
