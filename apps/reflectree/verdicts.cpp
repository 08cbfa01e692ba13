// SPDX-License-Identifier: Apache-2.0
#include "verdicts.hpp"

#include <algorithm>
#include <cstdio>

namespace reflectree::cli {

void Verdicts::line(const std::string& text) const {
  if (context_.json) return;
  context_.print(coloured_verdicts(text) + "\n");
  std::fflush(stdout);  // a check may take seconds
}

void Verdicts::flush() {
  if (!held_names_.empty()) line(fmt::format("  pass  {}: {}", way_, held_names_));
  held_names_.clear();
}

void Verdicts::heading(const std::string& where) {
  if (where == where_) return;
  flush();
  for (const VerifyFigure& f : figures_) line(fmt::format("        {:<26} {:.4g}", f.name, f.value));
  figures_.clear();
  where_ = where;
  if (!where.empty()) line(where);
}

void Verdicts::add(const CheckResult& result) {
  heading(result.where);
  if (result.way != way_) flush();
  way_ = result.way;
  if (way_.empty() || !result.passed || !result.decided || context_.verbose) {
    line("  " + to_line(result));
  } else {
    held_names_ += (held_names_.empty() ? "" : ", ") + result.name;
  }
}

void Verdicts::add(const VerifyFigure& figure) {
  heading(figure.where);
  figures_.push_back(figure);
}

int Verdicts::finish(const std::string& material, const VerifyReport& report) {
  heading("");
  int held = 0, failed = 0, open = 0;
  Json checks = Json::array(), figures = Json::array(), notes = Json::array();
  for (const CheckResult& c : report.checks) {
    ++(!c.passed ? failed : c.decided ? held : open);
    checks.push_back({{"group", c.where},
                      {"way", c.way},
                      {"name", c.name},
                      {"passed", c.passed},
                      {"decided", c.decided},
                      {"statistic", c.statistic},
                      {"threshold", c.threshold},
                      {"p_value", c.p_value},
                      {"detail", c.detail}});
  }
  for (const VerifyFigure& f : report.figures) {
    figures.push_back({{"group", f.where}, {"name", f.name}, {"value", f.value}});
  }
  for (const std::string& note : report.notes) {
    notes.push_back(note);
    line("note  " + note);
  }
  const bool passed = failed == 0;
  if (context_.json) {
    context_.print_json("verify", {{"material", material},
                                   {"planted_fault", fault_},
                                   {"passed", passed},
                                   {"checks", checks},
                                   {"figures", figures},
                                   {"notes", notes}});
  }
  const std::string planted = fault_ == "none" ? "" : ", with the planted fault '" + fault_ + "'";
  const std::string undecided = open > 0 ? fmt::format(", {} cannot be told", open) : "";
  line(fmt::format("{}  {} checks hold, {} fail{}{}", passed ? "pass" : "FAIL", held, failed, undecided,
                   planted));
  return passed ? exit_success : exit_check_failed;
}

}  // namespace reflectree::cli
