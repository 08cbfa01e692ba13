// SPDX-License-Identifier: Apache-2.0
// Compiled with -fno-exceptions -fno-rtti: drawing directions needs neither.
#include "reflectree/sampler/exact_sampler.hpp"
#include "reflectree/sampler/one_shot_sampler.hpp"
