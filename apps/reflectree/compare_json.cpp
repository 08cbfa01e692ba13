// SPDX-License-Identifier: Apache-2.0
#include "compare.hpp"

namespace reflectree::study {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StudyCell, target_variance, sum_variance, worst_variance, dead, by_density,
                                   bias, bias_interval, biased, sample_ns, pdf_ns, floor_ns, error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ErrorCurve, n, random, stratified)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SamplerResult, sampler, fault, bytes, build_seconds, cells, curves, slices)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MaterialResult, material, albedo, albedo_error, slices, samplers)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Score, sampler, ours, general, materials, biased_cells, faults,
                                   relative_efficiency)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Loss, material, winner, ratio, theta_o_deg, light, error_ratio, time_ratio)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Verdict, materials, won, scores, losses, best_in_mean, nine_in_ten)

}  // namespace reflectree::study

namespace reflectree::cli {

using Json = nlohmann::ordered_json;
using namespace study;

Json key_of(const StudyOptions& o, std::span<const Illumination> lights,
            std::span<const SamplerInfo* const> samplers) {
  Json key{{"theta_o_deg", o.theta_o_deg},
           {"samples", o.samples},
           {"mean_of", o.mean_of},
           {"curve_repeats", o.curve_repeats},
           {"curve_samples", o.curve_samples},
           {"cubature_evaluations", o.cubature_evaluations},
           {"round_seconds", o.round_seconds},
           {"seed", o.seed}};
  for (const Illumination& light : lights)
    key["lights"].push_back({light.name, light.mean, light.mean_square});
  for (const SamplerInfo* s : samplers) key["samplers"].push_back(s->name);
  return key;
}

Json json_of(const MaterialResult& material) { return Json(nlohmann::json(material)); }
MaterialResult material_from(const Json& json) { return nlohmann::json(json).get<MaterialResult>(); }
Json json_of(const Verdict& verdict) { return Json(nlohmann::json(verdict)); }

std::string csv_of(std::span<const MaterialResult> materials, std::span<const Illumination> lights,
                   const StudyOptions& o) {
  // Quoted: a material's text holds commas.
  const auto quoted = [](const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + "\"";
  };
  std::string out =
      "material,sampler,theta_o_deg,target_variance,sum_variance,worst_variance,by_density,dead,bias,bias_"
      "interval,"
      "biased,"
      "sample_ns,pdf_ns,floor_ns,bytes,build_seconds";
  for (const Illumination& light : lights) out += "," + quoted("error " + light.name);
  out += "\n";
  for (const MaterialResult& m : materials) {
    for (const SamplerResult& s : m.samplers) {
      for (std::size_t i = 0; i < s.cells.size(); ++i) {
        const study::StudyCell& c = s.cells[i];
        out += fmt::format(
            "{},{},{},{:.6g},{:.6g},{:.6g},{},{:.6g},{:.6g},{:.6g},{},{:.4g},{:.4g},{:.4g},{},{:.4g}",
            quoted(m.material), s.sampler, o.theta_o_deg[i], c.target_variance, c.sum_variance,
            c.worst_variance, int(c.by_density), c.dead, c.bias, c.bias_interval, int(c.biased), c.sample_ns,
            c.pdf_ns, c.floor_ns, s.bytes, s.build_seconds);
        for (const double e : c.error) out += fmt::format(",{:.6g}", e);
        out += "\n";
      }
    }
  }
  return out;
}

}  // namespace reflectree::cli
