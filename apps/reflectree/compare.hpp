// SPDX-License-Identifier: Apache-2.0
// The parts of compare: what is asked, the results as JSON, both ways, as CSV and as a table.
#pragma once

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "context.hpp"
#include "reflectree/study/report.hpp"

namespace reflectree::cli {

struct CompareOptions {
  std::vector<std::string> materials;
  std::string samplers, theta_o_deg, csv, html, resume;
  std::vector<std::string> envmaps;
  bool quick = false;
};

// The names of the materials: those given, a folder's files in its place; or those of the data folder.
std::vector<std::string> material_names(const Context& context, const CompareOptions& given);
std::vector<const SamplerInfo*> chosen_samplers(const std::string& list);
// The procedural lights; then those named, or those of the data folder.
std::vector<study::Illumination> read_lights(const Context& context, const CompareOptions& given);

// Of the sources, at the time of the build.
const char* source_commit();

// What a kept result must agree with to be taken up again.
nlohmann::ordered_json key_of(const study::StudyOptions& options, std::span<const study::Illumination> lights,
                              std::span<const SamplerInfo* const> samplers);

nlohmann::ordered_json json_of(const study::MaterialResult& material);
study::MaterialResult material_from(const nlohmann::ordered_json& json);
nlohmann::ordered_json json_of(const study::Verdict& verdict);

// A line per material, sampler and theta_o.
std::string csv_of(std::span<const study::MaterialResult> materials,
                   std::span<const study::Illumination> lights, const study::StudyOptions& options);

void show(const Context& context, const std::vector<study::MaterialResult>& all, const study::Verdict& v,
          std::span<const study::Illumination> lights, const study::StudyOptions& o);

}  // namespace reflectree::cli
