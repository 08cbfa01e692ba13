// SPDX-License-Identifier: Apache-2.0
// Lanes of floats.
#include <reflectree/simd/sample_batch.hpp>

int main() { return 0; }
