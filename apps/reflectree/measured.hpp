// SPDX-License-Identifier: Apache-2.0
// What is doubtful in the measured files of a material, in words and as JSON.
#pragma once

#include "reflectree/formats/measured_facts.hpp"
#include "subject.hpp"

namespace reflectree::cli {

struct MeasuredFile {
  std::string text;  // path and member, as the material names them
  MeasuredFacts facts;
};

// One for each file that the material names and of whose format something is known.
std::vector<MeasuredFile> measured_files(const std::string& material, const FilePlaces& places);

Json measured_json(const std::vector<MeasuredFile>& files);

struct NamedLine {
  const char* name;
  std::string value;
};
std::vector<NamedLine> measured_lines(const MeasuredFile& file);

}  // namespace reflectree::cli
