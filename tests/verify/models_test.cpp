// SPDX-License-Identifier: Apache-2.0
// verify() holds for every registered model with its default parameters, at a fifth of its effort.
#include <gtest/gtest.h>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/verify/verify.hpp"
#include "threads.hpp"

namespace reflectree {
namespace {

TEST(Verify, EveryRegisteredModelHolds) {
  ASSERT_GT(models().size(), 10u);
  VerifyOptions options;
  options.effort = 0.2;
  options.theta_o_deg = {0, 45, 80, 89};
  options.random_elevations = 2;
  for (const ModelInfo& model : models()) {
    const AnyBrdf f = make_brdf(parse_material(std::string(model.name)));
    const VerifyReport report = verify(f, options, {}, two_threads());
    for (const CheckResult& check : report.checks) {
      EXPECT_TRUE(check.passed) << model.name << ", " << check.where << ", " << check.way << ": "
                                << to_line(check);
    }
  }
}

}  // namespace
}  // namespace reflectree
