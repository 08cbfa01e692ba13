// SPDX-License-Identifier: Apache-2.0
// Random words for our samplers from the three random numbers that Mitsuba gives a BSDF for a sample. The standard
// library alone, so that it is tested without Mitsuba.
#pragma once

#include <cstdint>

namespace reflectree {

// The bits of three floats, of which the lowest are few, become as many words as are asked for. SplitMix64 (Steele,
// Lea and Flood 2014) mixes every bit into every other. A generator that takes numbers for state and stream without
// mixing them will not do: nearby states and streams of PCG32 have like words.
struct WordsOfNumbers {
    std::uint64_t state;

    WordsOfNumbers(std::uint32_t a, std::uint32_t b, std::uint32_t c)
        : state(mix(mix(a | std::uint64_t(b) << 32U) ^ c)) {}

    std::uint32_t operator()() { return std::uint32_t(mix(state += 0x9e3779b97f4a7c15U) >> 32U); }

    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
};

}  // namespace reflectree
