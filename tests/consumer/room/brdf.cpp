// SPDX-License-Identifier: Apache-2.0
// A material's text and its canonical form.
#include <reflectree/brdf/material/material.hpp>

int main() {
  using namespace reflectree;
  return make_brdf(parse_material("lambert:rho=.5")).traits().name == "lambert:rho=0.5" ? 0 : 1;
}
