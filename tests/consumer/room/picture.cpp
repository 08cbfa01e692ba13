// SPDX-License-Identifier: Apache-2.0
// The pictures' libraries come along.
#include <reflectree/error.hpp>
#include <reflectree/picture/image.hpp>

int main() {
  using namespace reflectree;
  try {
    read_png({}, "nothing");
  } catch (const Error&) {
    return 0;
  }
  return 1;
}
