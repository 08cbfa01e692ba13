// SPDX-License-Identifier: Apache-2.0
// Is the sampler of a function of one's own right? Every way into it is judged; what fails is told in a line.
#include <cstdio>
#include <reflectree/verify/verify.hpp>

using namespace reflectree;

int main() {
  const auto f = [](Direction wo, Direction wi) { return 0.1f + 0.2f * wo.z * wi.z * wi.z; };
  VerifyOptions options;
  options.effort = 0.05;  // 1 sees more, and takes some 20 s of two cores
  const VerifyReport report = verify(f, options);
  int failed = 0;
  for (const CheckResult& check : report.checks) {
    if (check.passed) continue;
    ++failed;
    std::printf("%s, %s\n", check.where.c_str(), to_line(check).c_str());
  }
  std::printf("%d of %zu checks fail\n", failed, report.checks.size());
  return report.all_passed() ? 0 : 1;
}
