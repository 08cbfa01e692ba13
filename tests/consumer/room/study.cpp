// SPDX-License-Identifier: Apache-2.0
// A verdict over nothing.
#include <reflectree/study/verdict.hpp>

int main() {
  const reflectree::study::Verdict verdict = reflectree::study::judge({}, {}, {}, {});
  return verdict.materials == 0 ? 0 : 1;
}
