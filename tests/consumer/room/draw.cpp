// SPDX-License-Identifier: Apache-2.0
// A colour of the maps, and the writer of pictures.
#include <reflectree/draw/colour_map.hpp>
#include <reflectree/picture/png.hpp>

int main() {
  const auto& palette = reflectree::draw::palette();
  return palette.front() == palette.back() ? 1 : 0;
}
