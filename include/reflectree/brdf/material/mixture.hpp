// SPDX-License-Identifier: Apache-2.0
// Weighted sums of BRDFs, known at compile time (BrdfSum) or at run time (mixture).
#pragma once

#include "reflectree/brdf/any_brdf.hpp"

namespace reflectree {

// weight_a a + weight_b b for two RGB models that take the shading geometry; nests.
template <class A, class B>
struct BrdfSum {
  float weight_a = 1;
  A a;
  float weight_b = 1;
  B b;

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    return T(weight_a) * a(g) + T(weight_b) * b(g);
  }
  BrdfTraits traits() const;
};

struct MixtureTerm {
  float weight = 1;
  AnyBrdf f;
};

// The sum of the terms. Each batch makes one call per term and some hundred values; nothing is allocated.
// Channels agree, or are 1 and are spread over the others'. Isotropic and concurrent if all terms are;
// knots are united. name: default "0.3*A + B". Throws Error: no terms, a weight that is negative or
// not finite, channels that disagree.
AnyBrdf mixture(std::vector<MixtureTerm> terms, std::string name = "");

// What is known about the sum of two functions of known traits.
BrdfTraits combined(const BrdfTraits& a, const BrdfTraits& b);

template <class A, class B>
BrdfTraits BrdfSum<A, B>::traits() const {
  return combined(traits_of(a), traits_of(b));
}

}  // namespace reflectree
