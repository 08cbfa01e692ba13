// SPDX-License-Identifier: Apache-2.0
// verify() at its default effort on a small material, as a program: exit code 0 if nothing fails, 1 with a
// line for each check that fails. A test by itself, and the judge that tools/mutate.py runs on every mutant.
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
    Plastic material;
    material.kd = {0.5f, 0.2f, 0.1f};
    material.alpha = 0.3f;
    VerifyOptions options;
    if (argc > 1) options.seed = std::strtoull(argv[1], nullptr, 10);
    if (argc > 2) options.effort = std::strtod(argv[2], nullptr);
    options.on_check = [](const CheckResult& check) {
      if (!check.passed)
        std::printf("%s, %s: %s\n", check.where.c_str(), check.way.c_str(), to_line(check).c_str());
    };
    const VerifyReport report = verify(material, options, {}, two_threads());
    std::printf("%zu checks, %s\n", report.checks.size(), report.all_passed() ? "all passed" : "some failed");
    return report.all_passed() ? 0 : 1;
  } catch (const std::exception& error) {
    std::printf("FAIL  build  %s\n", error.what());
    return 1;
  }
}
