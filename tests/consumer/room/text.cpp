// SPDX-License-Identifier: Apache-2.0
#include <reflectree/text/number_text.hpp>

int main() { return reflectree::shortest_text(.1f) == "0.1" ? 0 : 1; }
