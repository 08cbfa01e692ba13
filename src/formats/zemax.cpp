// SPDX-License-Identifier: Apache-2.0
#include "zemax.hpp"

#include <cmath>

#include "probe_pairs.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "spectral_colour.hpp"
#include "text_lines.hpp"
#include "zemax_text.hpp"

namespace reflectree {
namespace {

constexpr std::size_t looked_at = std::size_t(64) << 10U;
constexpr double degree = pi_v<double> / 180;
// A zero is taken for a gap only beyond this angle from the normal, where instruments give up.
constexpr double cos_gaps_begin = 0.5;

using Angles = std::vector<double>;

// Closes a circle of nodes: repeats the first slice of `stride` entries a turn later where the file leaves
// that out. `gap`: how far apart neighbours may be, in the widest steps that the file itself takes.
void close_circle(Angles& nodes, std::vector<std::vector<float>>& values, std::size_t stride,
                  const char* name, const std::string& path) {
  if (nodes.size() < 2) return;
  double widest = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i) widest = std::max(widest, nodes[i] - nodes[i - 1]);
  const double left = nodes.front() + 360 - nodes.back();
  if (left < -zemax_same_angle || left > 1.5 * widest) {
    throw Error(std::string(name) + " does not go round", path, "give angles from 0 to 360");
  }
  if (left <= zemax_same_angle) {
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
  reading.file = parse_zemax(bytes, path);
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
  if (!parse_zemax(bytes, path).tristimulus) return {"held", "zeros"};
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
