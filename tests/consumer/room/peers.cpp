// SPDX-License-Identifier: Apache-2.0
// The registry knows our own sampler and at least one other.
#include <reflectree/peers/registry.hpp>

int main() { return reflectree::find_sampler("exact") && reflectree::find_sampler("cosine") ? 0 : 1; }
