// SPDX-License-Identifier: Apache-2.0
// Must not compile, and must say why in one line.
#include "reflectree/sampler/sampler.hpp"

using reflectree::Direction;

void wrong() {
  reflectree::make_sampler([](Direction, Direction) { return "a word is no reflectance"; });
}
