// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include "reflectree/brdf/any_brdf.hpp"

using namespace reflectree;

int main() {
  const AnyBrdf f = [](Direction, Direction) { return 0.5f / pi; };
  const Direction wo{0.6f, 0, 0.8f}, wi{0, 0, 1};
  float value = 0;
  f.eval({&wo, 1}, {&wi, 1}, {&value, 1});
  std::printf("f(wo, wi) = %g\n", double(value));
  return std::abs(value * pi - 0.5f) < 1e-6f ? 0 : 1;
}
