// SPDX-License-Identifier: Apache-2.0
// What was promised of the main job, judged on all measurements of a run.
#pragma once

#include "measurement.hpp"

namespace reflectree::study {

struct Promise {
  std::string text;      // what was promised
  std::string measured;  // what was found
  bool kept = false;
};

// timed: whether to judge the build times, which means something only on a free machine.
std::vector<Promise> judge(const std::vector<Measurement>& all, const StudyOptions& options, bool timed);

// The results as a page of Markdown.
std::string to_markdown(const std::vector<Measurement>& all, const std::vector<Promise>& promises,
                        const StudyOptions& options, const std::string& command);

}  // namespace reflectree::study
