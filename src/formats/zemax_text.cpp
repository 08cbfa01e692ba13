// SPDX-License-Identifier: Apache-2.0
#include "zemax_text.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"
#include "text_lines.hpp"

namespace reflectree {
namespace {

constexpr std::size_t max_nodes = 4096, max_entries = std::size_t(1) << 25U;
constexpr float largest = 1e9f;

using Angles = std::vector<double>;

class Parser {
 public:
  Parser(ByteView bytes, const std::string& path) : lines_(bytes), path_(path) {}
  ZemaxFile read();

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error("line " + std::to_string(lines_.number()) + ": " + what, path_,
                "mend the line or fetch the file again");
  }
  std::string quoted(std::string_view word) const { return "'" + std::string(word.substr(0, 30)) + "'"; }

  void next_line(const char* wanted) {
    if (!lines_.next(line_)) fail(std::string("the file ends where ") + wanted + " should follow");
  }
  double number(std::string_view word) const {
    const std::optional<double> value = parse_number(word);
    if (!value) fail(quoted(word) + " is not a finite number");
    return *value;
  }
  void expect_end() const {
    if (!line_.empty()) fail(quoted(line_) + " follows what the line should hold");
  }
  bool word_is(std::string_view wanted) const;
  Angles angles(double least, double greatest);
  void header(ZemaxFile& file);
  std::vector<float> curve(const ZemaxFile& file);

  TextLines lines_;
  std::string_view line_, word_;  // what is left of the line; the word taken off it last
  const std::string& path_;
};

// Capitals do not matter: files write Asymmetrical4D and ASymmetrical4D.
bool Parser::word_is(std::string_view wanted) const {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c + ('a' - 'A')) : c; };
  return std::equal(word_.begin(), word_.end(), wanted.begin(), wanted.end(),
                    [&](char a, char b) { return lower(a) == lower(b); });
}

// A count on this line, and as many ascending angles on the lines that follow.
Angles Parser::angles(double least, double greatest) {
  const double count = number(take_word(line_));
  if (!(count >= 1 && count <= double(max_nodes)) || count != std::floor(count))
    fail("not a count of angles");
  Angles all;
  while (all.size() < std::size_t(count)) {
    if (line_.empty()) next_line("an angle");
    const double angle = number(take_word(line_));
    if (!(angle >= least && angle <= greatest)) fail("an angle out of range");
    if (!all.empty() && !(angle > all.back())) fail("angles that do not ascend");
    all.push_back(angle);
  }
  expect_end();
  return all;
}

// Up to the line that names the first curve, which is left in line_ and word_.
void Parser::header(ZemaxFile& file) {
  bool symmetry = false, content = false, scatter = false;
  for (;;) {
    next_line("the data");
    word_ = take_word(line_);
    if (word_is("Monochrome") || word_is("TristimulusX")) break;
    if (word_is("Source")) {
      line_ = {};
    } else if (word_is("Symmetry")) {
      symmetry = true;
      word_ = take_word(line_);
      file.mirrored = word_is("PlaneSymmetrical");
      if (!file.mirrored && !word_is("Asymmetrical") && !word_is("Asymmetrical4D")) {
        fail("symmetry " + quoted(word_) + " is not known");
      }
    } else if (word_is("SpectralContent")) {
      content = true;
      word_ = take_word(line_);
      file.tristimulus = word_is("XYZ");
      if (!file.tristimulus && !word_is("Monochrome"))
        fail("spectral content " + quoted(word_) + " is not known");
    } else if (word_is("ScatterType")) {
      scatter = true;
      word_ = take_word(line_);
      if (word_is("BTDF")) {
        throw Error("a BTDF: light that passes through is not sampled", path_, "name a file of a BRDF");
      }
      if (!word_is("BRDF")) fail("scatter type " + quoted(word_) + " is not known");
    } else if (word_is("SampleRotation")) {
      file.rotation = angles(-360, 720);
    } else if (word_is("AngleOfIncidence")) {
      file.incidence = angles(0, 90);
    } else if (word_is("ScatterAzimuth")) {
      file.azimuth = angles(0, 360);
    } else if (word_is("ScatterRadial")) {
      file.radial = angles(0, 180);
    } else {
      fail(quoted(word_) + " is not known");
    }
    expect_end();
  }
  const auto demand = [this](bool there, const char* what) {
    if (!there) fail(std::string("the data begins without ") + what);
  };
  demand(symmetry, "Symmetry"), demand(content, "SpectralContent"), demand(scatter, "ScatterType");
  demand(!file.rotation.empty(), "SampleRotation"), demand(!file.incidence.empty(), "AngleOfIncidence");
  demand(!file.azimuth.empty(), "ScatterAzimuth"), demand(!file.radial.empty(), "ScatterRadial");
  const double entries = double(file.rotation.size()) * double(file.incidence.size()) *
                         double(file.azimuth.size()) * double(file.radial.size());
  if (entries > double(max_entries)) fail("more entries than are read");
  if (file.azimuth.back() > 180 + zemax_same_angle) file.mirrored = false;  // both sides are there
}

// What stands between DataBegin and DataEnd.
std::vector<float> Parser::curve(const ZemaxFile& file) {
  const auto expect = [this](const char* wanted) {
    next_line(wanted);
    word_ = take_word(line_);
    if (!word_is(wanted)) fail(quoted(word_) + " where " + wanted + " should stand");
  };
  expect("DataBegin");
  std::vector<float> values;  // grows with what is read: counts alone reserve nothing
  for (std::size_t slice = 0; slice < file.rotation.size() * file.incidence.size(); ++slice) {
    expect("TIS");
    number(take_word(line_));
    expect_end();
    for (std::size_t row = 0; row < file.azimuth.size(); ++row) {
      next_line("a row of values");
      for (std::size_t i = 0; i < file.radial.size(); ++i) {
        if (line_.empty()) fail("fewer values than radial angles");
        const double value = number(take_word(line_));
        if (!(std::abs(value) <= double(largest))) fail("an impossible value");
        values.push_back(float(value));
      }
      expect_end();
    }
  }
  expect("DataEnd");
  return values;
}

ZemaxFile Parser::read() {
  ZemaxFile file;
  header(file);
  const char* const curves[] = {"TristimulusX", "TristimulusY", "TristimulusZ"};
  for (std::size_t i = 0; i < (file.tristimulus ? 3U : 1U); ++i) {
    if (i > 0) {
      next_line(curves[i]);
      word_ = take_word(line_);
    }
    const char* wanted = file.tristimulus ? curves[i] : "Monochrome";
    if (!word_is(wanted)) fail(quoted(word_) + " where " + wanted + " should stand");
    expect_end();
    file.values.push_back(curve(file));
  }
  if (lines_.next(line_)) fail("something follows the data");
  return file;
}

}  // namespace

ZemaxFile parse_zemax(ByteView bytes, const std::string& path) { return Parser(bytes, path).read(); }

}  // namespace reflectree
