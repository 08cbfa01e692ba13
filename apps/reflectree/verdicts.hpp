// SPDX-License-Identifier: Apache-2.0
// Collects verify's results: lines as they come, or JSON at the end.
#pragma once

#include <span>

#include "context.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree::cli {

class Verdicts {
 public:
  Verdicts(const Context& context, std::string planted_fault)
      : context_(context), fault_(std::move(planted_fault)) {}

  void heading(const std::string& words);
  void add(const CheckResult& result);
  // Many at once: a line for each that fails and one for those that hold (-v: one for each).
  void add_group(const std::string& name, std::span<const CheckResult> results);
  // A figure that is no check.
  void inform(const std::string& name, double value);

  // The verdict; returns the exit code.
  int finish(const std::string& material) const;

 private:
  void record(const CheckResult& result);
  void line(const std::string& text) const;

  const Context& context_;
  std::string fault_, group_;
  Json checks_ = Json::array(), figures_ = Json::array();
  int held_ = 0, failed_ = 0;
};

}  // namespace reflectree::cli
