// SPDX-License-Identifier: Apache-2.0
#include "zemax.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "probe_pairs.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"
#include "spectral_colour.hpp"
#include "text_lines.hpp"

namespace reflectree {
namespace {

constexpr std::size_t max_nodes = 4096, max_entries = std::size_t(1) << 25U,
                      looked_at = std::size_t(64) << 10U;
constexpr double degree = pi_v<double> / 180, same_angle = 1e-3;  // the latter in degrees
// A zero is taken for a gap only beyond this angle from the normal, where instruments give up.
constexpr double cos_gaps_begin = 0.5;
constexpr float largest = 1e9f;

// Degrees, as in the file.
using Angles = std::vector<double>;

// values[curve]: [rotation][incidence][azimuth][radial], as in the file.
struct ZemaxFile {
  Angles rotation, incidence, azimuth, radial;
  bool mirrored = false, tristimulus = false;
  std::vector<std::vector<float>> values;

  std::size_t size() const { return rotation.size() * incidence.size() * azimuth.size() * radial.size(); }
};

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
  if (file.azimuth.back() > 180 + same_angle) file.mirrored = false;  // both sides are there
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

// Closes a circle of nodes: repeats the first slice of `stride` entries a turn later where the file leaves
// that out. `gap`: how far apart neighbours may be, in the widest steps that the file itself takes.
void close_circle(Angles& nodes, std::vector<std::vector<float>>& values, std::size_t stride,
                  const char* name, const std::string& path) {
  if (nodes.size() < 2) return;
  double widest = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i) widest = std::max(widest, nodes[i] - nodes[i - 1]);
  const double left = nodes.front() + 360 - nodes.back();
  if (left < -same_angle || left > 1.5 * widest) {
    throw Error(std::string(name) + " does not go round", path, "give angles from 0 to 360");
  }
  if (left <= same_angle) {
    nodes.back() = nodes.front() + 360;
    return;
  }
  const std::size_t count = nodes.size();
  nodes.push_back(nodes.front() + 360);
  for (std::vector<float>& v : values) {
    std::vector<float> closed;
    closed.reserve(v.size() / count * (count + 1));
    for (auto block = v.begin(); block != v.end(); block += std::ptrdiff_t(count * stride)) {
      closed.insert(closed.end(), block, block + std::ptrdiff_t(count * stride));
      closed.insert(closed.end(), block, block + std::ptrdiff_t(stride));
    }
    v = std::move(closed);
  }
}

// What the entries are.
struct Entries {
  std::uint64_t above = 0, below = 0, gaps = 0, negative = 0;  // the latter two of those above the surface
  std::vector<std::uint64_t> negative_at;                      // by incidence
  std::vector<std::uint8_t> stand_in;
};

// Marks the gaps, and lets the last entry before them stand in if `held`. A row leads from the mirror
// direction outwards along a great circle, which passes the horizon once.
Entries judge_entries(ZemaxFile& file, bool held) {
  Entries entries;
  entries.negative_at.resize(file.incidence.size());
  entries.stand_in.resize(file.size());
  const std::size_t width = file.radial.size();
  std::vector<double> cosine(width);
  for (std::size_t first = 0, row = 0; first < file.size(); first += width, ++row) {
    const std::size_t incidence = row / file.azimuth.size() % file.incidence.size();
    const double theta = file.incidence[incidence] * degree;
    const double phi = file.azimuth[row % file.azimuth.size()] * degree;
    bool measured = false;
    for (std::size_t i = 0; i < width; ++i) {
      const double r = file.radial[i] * degree;
      cosine[i] = cos(theta) * cos(r) + sin(theta) * sin(r) * cos(phi);
      bool negative = false;
      for (const std::vector<float>& v : file.values) {
        negative = negative || v[first + i] < 0;
        measured = measured || v[first + i] != 0;
      }
      const bool above = cosine[i] > 1e-6;
      ++(above ? entries.above : entries.below);
      if (above && negative) ++entries.negative, ++entries.negative_at[incidence];
    }
    if (!measured || !held) continue;
    const auto is_gap = [&](std::size_t i) {
      if (!(cosine[i] < cos_gaps_begin)) return false;
      for (const std::vector<float>& v : file.values) {
        if (v[first + i] != 0) return false;
      }
      return true;
    };
    std::size_t end = width;
    while (end > 1 && is_gap(end - 1)) --end;
    for (std::size_t i = end; i < width; ++i) {
      if (cosine[i] > 1e-6) ++entries.gaps;
      entries.stand_in[first + i] = 1;
      for (std::vector<float>& v : file.values) v[first + i] = v[first + end - 1];
    }
  }
  return entries;
}

// A member's words: the curve, and whether gaps are held.
struct Way {
  std::string_view curve;
  bool held = true;
};
Way way_of(const ZemaxFile& file, const std::string& path, std::string_view member) {
  constexpr std::string_view ending = "-zeros";
  if (!file.tristimulus) {
    if (member.empty() || member == "held") return {"", true};
    if (member == "zeros") return {"", false};
    throw Error("no member '" + std::string(member) + "'", path, "its members are #held and #zeros");
  }
  Way way{member.empty() ? "rgb" : member, true};
  if (way.curve.ends_with(ending)) way.curve.remove_suffix(ending.size()), way.held = false;
  for (const std::string_view known : {"rgb", "x", "y", "z"}) {
    if (way.curve == known) return way;
  }
  throw Error("no member '" + std::string(member) + "'", path,
              "its members are #rgb, #x, #y and #z, and the same with -zeros");
}

std::vector<float> radians(const Angles& angles) {
  std::vector<float> all;
  for (const double angle : angles) all.push_back(float(angle * degree));
  return all;
}

struct Reading {
  ZemaxFile file;
  Entries entries;
  Way way;
};
Reading read_file_as(ByteView bytes, const std::string& path, const std::string& member) {
  Reading reading;
  reading.file = Parser(bytes, path).read();
  ZemaxFile& file = reading.file;
  reading.way = way_of(file, path, member);
  const std::size_t width = file.radial.size();
  close_circle(file.rotation, file.values, file.incidence.size() * file.azimuth.size() * width,
               "SampleRotation", path);
  if (!file.mirrored) close_circle(file.azimuth, file.values, width, "ScatterAzimuth", path);
  reading.entries = judge_entries(file, reading.way.held);
  return reading;
}

template <class Value>
SpecularTable<Value> empty_table(Reading& reading, const std::string& name) {
  const ZemaxFile& file = reading.file;
  SpecularTable<Value> table;
  table.name = name;
  table.axes = {radians(file.rotation), radians(file.incidence), radians(file.azimuth), radians(file.radial),
                file.mirrored};
  table.stand_in = std::move(reading.entries.stand_in);
  return table;
}

SpecularTable<float> grey_table(Reading& reading, const std::string& name) {
  SpecularTable<float> table = empty_table<float>(reading, name);
  const std::string_view curve = reading.way.curve;
  table.values = std::move(reading.file.values[curve == "y" ? 1 : curve == "z" ? 2 : 0]);
  return table;
}

SpecularTable<Rgb> colour_table(Reading& reading, const std::string& name) {
  SpecularTable<Rgb> table = empty_table<Rgb>(reading, name);
  const auto& v = reading.file.values;
  for (std::size_t i = 0; i < v[0].size(); ++i)
    table.values.push_back(rgb_of_xyz(double(v[0][i]), double(v[1][i]), double(v[2][i])));
  return table;
}

// "3 azimuths", "1 azimuth".
std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

template <class Table>
void probe_table(MeasuredFacts& facts, const Table& table) {
  probe_pairs(facts, [&table](const ShadingGeometry<float>& g, int c) {
    if (table.unmeasured(g) > 0.01f) return PairVerdict::bridged;
    return channel_value(table.unclipped(g), c) < 0 ? PairVerdict::clipped : PairVerdict::sound;
  });
}

}  // namespace

bool is_zemax_file(ByteView bytes) {
  const ByteView start = bytes.first(std::min(bytes.size(), looked_at));
  TextLines lines(start);
  std::string_view line;
  if (!lines.next(line)) return false;
  const std::string_view first = take_word(line);
  if (first != "Source" && first != "Symmetry" && first != "SpectralContent" && first != "ScatterType")
    return false;
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  return text.find("\nSampleRotation") != text.npos || text.find("\nScatterType") != text.npos;
}

std::vector<std::string> zemax_members(ByteView bytes, const std::string& path) {
  if (!Parser(bytes, path).read().tristimulus) return {"held", "zeros"};
  return {"rgb", "x", "y", "z", "rgb-zeros", "x-zeros", "y-zeros", "z-zeros"};
}

AnyBrdf read_zemax(ByteView bytes, const std::string& path, const std::string& member) {
  Reading reading = read_file_as(bytes, path, member);
  const std::string name = file_text(path, member);
  if (reading.way.curve == "rgb") return colour_table(reading, name);
  return grey_table(reading, name);
}

MeasuredFacts zemax_facts(ByteView bytes, const std::string& path, const std::string& member) {
  Reading reading = read_file_as(bytes, path, member);
  const ZemaxFile& file = reading.file;
  const Entries& entries = reading.entries;
  MeasuredFacts facts;
  facts.kind = "Zemax BSDF of " + counted(file.rotation.size(), "rotation") + ", " +
               counted(file.incidence.size(), "incidence") + ", " + counted(file.azimuth.size(), "azimuth") +
               " and " + counted(file.radial.size(), "radial angle");
  facts.entries = entries.above, facts.negative = entries.negative, facts.not_measured = entries.gaps;
  facts.theta_o = radians(file.incidence), facts.negative_at = entries.negative_at;
  facts.channels = reading.way.curve == "rgb" ? 3 : 1;
  facts.notes.push_back("wo is the file's incident direction");
  if (file.rotation.size() > 1) facts.notes.push_back("phi_o is 90 deg less the sample's rotation");
  if (reading.way.held && entries.below + entries.gaps > 0) {
    facts.notes.push_back("the last value before a gap or the horizon stands in up to it; " +
                          std::to_string(entries.below) + " entries are at or below the horizon");
  }
  if (facts.channels == 3) {
    probe_table(facts, colour_table(reading, path));
  } else {
    probe_table(facts, grey_table(reading, path));
  }
  return facts;
}

}  // namespace reflectree
