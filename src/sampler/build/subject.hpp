// SPDX-License-Identifier: Apache-2.0
// What a sampler is built of: a function, or a family with one of its members.
#pragma once

#include <optional>

#include "examine.hpp"

namespace reflectree::detail {

struct Subject {
  AnyBrdf f;  // of a family: the member in the middle
  std::optional<AnyFamily> family = {};
  std::vector<KnownParameter> parameters = {};
};
Subject subject_of(const AnyFamily& family);

// A function by examine(); of a family members all over its ranges, and what they have in common.
Examination examine(const Subject& subject, const BuildOptions& options,
                    const std::vector<Ridge>& ridges = {});

struct DomainChoice {
  Domain domain;
  ScaleLaw law = {};
};
Field field_of(const Subject& subject, const Examination& seen, const DomainChoice& choice,
               const std::vector<Ridge>& ridges);

// The domain with the fewest leaves in trial trees over thin slabs from the normal to grazing.
DomainChoice choose_domain(const Subject& subject, const BuildOptions& options, const Examination& seen,
                           const std::vector<Ridge>& ridges, const Host& host);

}  // namespace reflectree::detail
