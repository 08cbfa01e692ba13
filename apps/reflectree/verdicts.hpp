// SPDX-License-Identifier: Apache-2.0
// Shows verify's results: lines as they come, or JSON at the end.
#pragma once

#include "context.hpp"
#include "reflectree/verify/verify.hpp"

namespace reflectree::cli {

class Verdicts {
 public:
  Verdicts(const Context& context, std::string planted_fault)
      : context_(context), fault_(std::move(planted_fault)) {}

  // A line for each that fails or stays open; those that hold are summed up, a line for each way into the
  // sampler (-v: a line for each).
  void add(const CheckResult& result);
  void add(const VerifyFigure& figure);

  // The verdict; returns the exit code.
  int finish(const std::string& material, const VerifyReport& report);

 private:
  void heading(const std::string& where);
  void flush();
  void line(const std::string& text) const;

  const Context& context_;
  std::string fault_, where_, way_, held_names_;
  std::vector<VerifyFigure> figures_;  // of this heading
};

}  // namespace reflectree::cli
