// SPDX-License-Identifier: Apache-2.0
// verify() at its default effort on a small material, matt, then glossy (another domain), as a program: exit
// code 0 if nothing fails, 1 with a line for each check that fails; it ends with the first material of which
// one does. A test by itself, and the judge that tools/mutate.py runs on every mutant.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "reflectree/brdf/models/plastic.hpp"
#include "reflectree/verify/verify.hpp"
#include "threads.hpp"

int main(int argc, char** argv) {
  using namespace reflectree;
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  try {
    VerifyOptions options;
    if (argc > 1) options.seed = std::strtoull(argv[1], nullptr, 10);
    if (argc > 2) options.effort = std::strtod(argv[2], nullptr);
    options.on_check = [](const CheckResult& check) {
      if (!check.passed)
        std::printf("%s, %s: %s\n", check.where.c_str(), check.way.c_str(), to_line(check).c_str());
    };
    for (const float alpha : {0.3f, 0.1f}) {
      Plastic material;
      material.kd = {0.5f, 0.2f, 0.1f};
      material.alpha = alpha;
      const VerifyReport report = verify(material, options, {}, two_threads());
      std::printf("alpha %g: %zu checks, %s\n", double(alpha), report.checks.size(),
                  report.all_passed() ? "all passed" : "some failed");
      if (!report.all_passed()) return 1;
    }
    return 0;
  } catch (const std::exception& error) {
    std::printf("FAIL  build  %s\n", error.what());
    return 1;
  }
}
