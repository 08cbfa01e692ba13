// SPDX-License-Identifier: Apache-2.0
// What is doubtful in a file of measurements: entries that noise made negative or that were not measured,
// and how often that reaches a value.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

struct MeasuredFacts {
  std::string kind;                // of the file, in words
  std::uint64_t entries = 0;       // numbers between which values are interpolated; 0 for a formula
  std::uint64_t negative = 0;      // of them: noise, interpolated as they are
  std::uint64_t not_measured = 0;  // of them: marked as missing
  // Where the known direction was measured, radians, and how many of its colours are negative; empty where
  // the file does not say.
  std::vector<float> theta_o;
  std::vector<std::uint64_t> negative_at;
  int channels = 3;                // 1: all that is told by channel is the same for the three
  std::vector<std::string> notes;  // what the reader decided where the format leaves it open, in words

  // Of `pairs` random pairs of directions, half of them near the mirror direction: how many in each channel
  // have a value below 0, which counts as 0; have a value in which measured neighbours stand in for missing
  // entries; and have no measured neighbour, which counts as 0.
  std::uint64_t pairs = 0;
  std::array<std::uint64_t, 3> clipped{}, bridged{}, dark{};
  // The same in any channel, by the larger of the two elevations: where it matters.
  static constexpr std::array<double, 6> bands_deg{0, 30, 60, 75, 85, 90};
  std::array<std::uint64_t, 5> pairs_in_band{}, touched_in_band{};
};

// The facts of a file's member, as read_brdf() would read it; nullopt where nothing is known of its format.
// Throws Error as it does.
std::optional<MeasuredFacts> measured_facts(ByteView bytes, const std::string& path,
                                            const std::string& member = "");

}  // namespace reflectree
