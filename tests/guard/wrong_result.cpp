// SPDX-License-Identifier: Apache-2.0
// Must not compile, and must say why in one line.
#include "reflectree/brdf/any_brdf.hpp"

using reflectree::Direction;

reflectree::AnyBrdf wrong() {
  return [](Direction, Direction) { return "a word is no reflectance"; };
}
