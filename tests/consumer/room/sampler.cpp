// SPDX-License-Identifier: Apache-2.0
// A sampler of a material chosen at run time.
#include <reflectree/brdf/material/material.hpp>
#include <reflectree/sampler/sampler.hpp>

int main() {
  using namespace reflectree;
  const auto sampler = make_sampler(make_brdf(parse_material("lambert:rho=.5")));
  Pcg32 random(1);
  return sampler.one_shot.sample(Direction{0, 0, 1}, random) ? 0 : 1;
}
