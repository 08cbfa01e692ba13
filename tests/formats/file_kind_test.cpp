// SPDX-License-Identifier: Apache-2.0
// What stands in the place of a file is called by its name, by every reader.
#include "reflectree/formats/file_kind.hpp"

#include <gtest/gtest.h>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/picture/image.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

using namespace std::string_literals;
using synthetic::as_bytes;

const std::string pointer =
    "version https://git-lfs.github.com/spec/v1\n"
    "oid sha256:00000000000000000000000000000000000000000000000000000000000000aa\n"
    "size 34992012\n";
const std::string window_xml =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Created by: hand -->\n"
    "<WindowElement xmlns=\"http://windows.lbl.gov\">\n<Optical/></WindowElement>\n";

std::string kind_of(const std::string& text) { return std::string(recognise_file(as_bytes(text)).what); }

TEST(FileKind, TellsWhatItIs) {
  EXPECT_EQ(kind_of(""), "empty");
  EXPECT_EQ(kind_of(pointer), "a Git LFS pointer");
  for (const char* html : {"<!DOCTYPE html>\n<p>", "\n  <html lang=\"en\">", "\xef\xbb\xbf<!doctype HTML>",
                           "<!-- a page -->\n<HTML>", "<?xml version=\"1.0\"?>\n<html xmlns=\"x\">"}) {
    EXPECT_EQ(kind_of(html), "an HTML page") << html;
  }
  const std::string window = "a measured material (WINDOW/Radiance BSDF XML)";
  EXPECT_EQ(kind_of(window_xml), window);
  EXPECT_EQ(kind_of("Recover using: a command\n" + window_xml), window);
  EXPECT_EQ(kind_of("<!--" + std::string(30000, 'x') + "-->" + window_xml), window);
  EXPECT_EQ(kind_of("<?xml version=\"1.0\"?><svg/>"), "an XML file");
  EXPECT_EQ(kind_of("<scene version=\"3.0.0\"/>"), "a scene in Mitsuba's XML");
  EXPECT_EQ(kind_of("PK\x03\x04rest"), "a ZIP archive");
  EXPECT_EQ(kind_of("\x1f\x8b\x08"), "compressed by gzip");
  EXPECT_EQ(kind_of("\x89PNG\r\n\x1a\n"), "a PNG picture");
  EXPECT_EQ(kind_of("\xff\xd8\xff\xe0"), "a JPEG picture");
  EXPECT_EQ(kind_of("II*\0x"s), "a TIFF picture");
  EXPECT_EQ(kind_of(std::string(1000, '\0')), "nothing but zeros");
  EXPECT_EQ(kind_of("#x\nSymmetry  Asymmetrical\nScatterType  BRDF\nSampleRotation  1\n"),
            "a measured material (Zemax .bsdf)");
}

TEST(FileKind, CallsMaterialsByTheirFormat) {
  EXPECT_EQ(recognise_file(synthetic::rgl_file()).what, "a measured material (RGL tensor_file)");
  EXPECT_EQ(kind_of("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0rest"s), "a measured material (MERL .binary)");
  EXPECT_EQ(kind_of("material,a\nx,1\n"), "a table of materials (CSV)");
  EXPECT_EQ(kind_of(synthetic::neural_csv()), "a table of materials (CSV)");
}

TEST(FileKind, LeavesOthersAlone) {
  for (const std::string& text :
       {"x"s, "v 0 0 0\nf 1 1 1\n"s, "<"s, "< a"s, "version 2"s, "PK"s, "a <html> inside"s,
        std::string(1, '\x1f'), "version https://a.b/spec/v1"s}) {
    EXPECT_EQ(kind_of(text), "") << text.substr(0, 40);
  }
}

TEST(FileKind, EveryReaderSaysIt) {
  const TemporaryFolder folder("kind");
  const auto write = [&](const char* name, const std::string& text) {
    write_file_atomically(folder / name, std::string_view(text));
    return folder / name;
  };
  const std::string metal = write("metal.binary", pointer), page = write("sky.hdr", "<html>404</html>"),
                    window = write("shade.xml", window_xml), nothing = write("nothing.rfl", "");
  const std::string pull = ": a Git LFS pointer; fetch the file with git lfs pull";
  EXPECT_EQ(error_words([&] { load_brdf(metal); }), metal + pull);
  EXPECT_EQ(error_words([&] { list_members(metal); }), metal + pull);
  EXPECT_EQ(error_words([&] { load_sampler(metal); }), metal + pull);
  EXPECT_EQ(error_words([&] { read_image(metal); }), metal + pull);
  EXPECT_NE(error_words([&] { read_image(page); }).find("sky.hdr: an HTML page; fetch the file itself"),
            std::string::npos);
  EXPECT_EQ(error_words([&] { load_brdf(window); }),
            window + ": line 4: <Optical> without <Layer>; mend the line or fetch the file again");
  EXPECT_EQ(
      error_words([&] { load_sampler(window); }),
      window + ": a measured material (WINDOW/Radiance BSDF XML); name a file that 'reflectree build' saved");
  EXPECT_EQ(error_words([&] { load_sampler(nothing); }), nothing + ": empty; fetch the file again");
  for (const char* inside : {"", "."}) {
    const std::string path = folder / inside;
    EXPECT_EQ(error_words([&] { load_brdf(path); }), path + ": is a directory; name a file inside it");
    EXPECT_EQ(error_words([&] { load_sampler(path); }), path + ": is a directory; name a file inside it");
    EXPECT_EQ(error_words([&] { read_image(path); }), path + ": is a directory; name a file inside it");
  }
}

TEST(FileKind, KnowsTheSharedFiles) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  int windows = 0, zemax = 0;
  for (const auto& entry : std::filesystem::directory_iterator(measured_data() + "/radiance_xml")) {
    const std::string kind(recognise_file(read_file(entry.path().string(), 1U << 30U)).what);
    EXPECT_EQ(kind, "a measured material (WINDOW/Radiance BSDF XML)") << entry.path();
    ++windows;
  }
  for (const auto& entry : std::filesystem::directory_iterator(measured_data() + "/zemax")) {
    const std::string kind(recognise_file(read_file(entry.path().string(), 1U << 30U)).what);
    EXPECT_EQ(kind, "a measured material (Zemax .bsdf)") << entry.path();
    ++zemax;
  }
  EXPECT_EQ(windows, 7);
  EXPECT_EQ(zemax, 6);
}

}  // namespace
}  // namespace reflectree
