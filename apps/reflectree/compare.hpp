// SPDX-License-Identifier: Apache-2.0
// The results of compare as JSON, both ways, and as CSV.
#pragma once

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "reflectree/study/report.hpp"

namespace reflectree::cli {

// What a kept result must agree with to be taken up again.
nlohmann::ordered_json key_of(const study::StudyOptions& options, std::span<const study::Environment> lights,
                              std::span<const SamplerInfo* const> samplers);

nlohmann::ordered_json json_of(const study::MaterialResult& material);
study::MaterialResult material_from(const nlohmann::ordered_json& json);
nlohmann::ordered_json json_of(const study::Verdict& verdict);

// A line a material, sampler and theta_o.
std::string csv_of(std::span<const study::MaterialResult> materials,
                   std::span<const study::Environment> lights, const study::StudyOptions& options);

}  // namespace reflectree::cli
