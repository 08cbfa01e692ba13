// SPDX-License-Identifier: Apache-2.0
// The integral of x^2 over [-1, 1]^2 is 4/3.
#include <cmath>
#include <reflectree/math/direction.hpp>
#include <reflectree/math/low_discrepancy.hpp>

int main() {
  using namespace reflectree;
  const Direction w = normalize(Direction{1, 2, 2});
  return std::abs(w.z - 2.f / 3) < 1e-6f ? 0 : 1;
}
