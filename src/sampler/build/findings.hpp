// SPDX-License-Identifier: Apache-2.0
// What follows from a cross-examination, and what a build has to say of itself in the end.
#pragma once

#include <string>

#include "cross_examine.hpp"
#include "judge_density.hpp"
#include "reflectree/sampler/build.hpp"

namespace reflectree::detail {

// Follows the lobes at which f surprised; false if none is new.
bool add_ridges(std::vector<Ridge>& ridges, const Field& field, const CrossExamination& seen);
// Whether trees and albedo contradict what was seen of f.
bool disagrees(const CrossExamination& seen, const AlbedoTable& albedo);
// Lets the table state what was found to be missed, where that is little.
void state_misses(const CrossExamination& seen, AlbedoTable& albedo);
// Throws Error where trees and albedo contradict what was seen of f: a sampler of them would be wrong.
void refuse_disagreement(const CrossExamination& seen, const AlbedoTable& albedo, const Field& field,
                         bool spent);
// Ten times the variance of one-shot weights that was asked for.
bool much_more(double variance, const BuildOptions& options);
// Throws Error where the bounds are so loose that directions would be lost.
void refuse_hopeless(const std::vector<Slab>& exact, const Field& field, bool spent);
// What was promised and is not kept.
std::vector<std::string> notes_on(const std::vector<Slab>& exact, const std::vector<Slab>& one_shot,
                                  const AlbedoTable& albedo, const DensityJudgement& density,
                                  const std::vector<KnownParameter>& parameters, const BuildOptions& options,
                                  double overshoot, bool spent);

}  // namespace reflectree::detail
