// SPDX-License-Identifier: Apache-2.0
#include "verdicts.hpp"

#include <cstdio>

namespace reflectree::cli {

void Verdicts::line(const std::string& text) const {
  if (context_.json) return;
  context_.print(coloured_verdicts(text) + "\n");
  std::fflush(stdout);  // a check may take seconds
}

void Verdicts::heading(const std::string& words) {
  group_ = words;
  line(words);
}

void Verdicts::record(const CheckResult& result) {
  ++(result.passed ? held_ : failed_);
  checks_.push_back({{"group", group_},
                     {"name", result.name},
                     {"passed", result.passed},
                     {"statistic", result.statistic},
                     {"threshold", result.threshold},
                     {"p_value", result.p_value},
                     {"detail", result.detail}});
}

void Verdicts::add(const CheckResult& result) {
  record(result);
  line("  " + to_line(result));
}

void Verdicts::add_group(const std::string& name, std::span<const CheckResult> results) {
  std::string held;
  for (const CheckResult& result : results) {
    record(result);
    if (!result.passed || context_.verbose) line("  " + to_line(result));
    if (result.passed) held += (held.empty() ? "" : ", ") + result.name;
  }
  if (!held.empty() && !context_.verbose) line(fmt::format("  pass  {}: {}", name, held));
}

void Verdicts::inform(const std::string& name, double value) {
  figures_.push_back({{"group", group_}, {"name", name}, {"value", value}});
  line(fmt::format("        {:<26} {:.4g}", name, value));
}

int Verdicts::finish(const std::string& material) const {
  const bool passed = failed_ == 0;
  if (context_.json) {
    context_.print_json("verify", {{"material", material},
                                   {"planted_fault", fault_},
                                   {"passed", passed},
                                   {"checks", checks_},
                                   {"figures", figures_}});
  }
  const std::string planted = fault_ == "none" ? "" : ", with the planted fault '" + fault_ + "'";
  line(fmt::format("{}  {} checks hold, {} fail{}", passed ? "pass" : "FAIL", held_, failed_, planted));
  return passed ? exit_success : exit_check_failed;
}

}  // namespace reflectree::cli
