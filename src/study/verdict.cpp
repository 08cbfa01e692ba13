// SPDX-License-Identifier: Apache-2.0
#include "reflectree/study/verdict.hpp"

#include <algorithm>

namespace reflectree::study {

namespace {

double cost(const StudyCell& c, std::size_t light) { return c.error[light] * c.sample_ns / c.floor_ns; }

const SamplerResult* find(const MaterialResult& m, std::string_view name) {
  for (const SamplerResult& s : m.samplers) {
    if (s.sampler == name) return &s;
  }
  return nullptr;
}

// The most efficient of those that `wanted` lets pass.
template <class Wanted>
const SamplerResult* best(const MaterialResult& m, std::span<const SamplerInfo> samplers,
                          const Wanted& wanted) {
  const SamplerResult* found = nullptr;
  for (const SamplerInfo& info : samplers) {
    if (!wanted(info)) continue;
    const SamplerResult* s = find(m, info.name);
    if (s && efficiency(*s) > (found ? efficiency(*found) : 0)) found = s;
  }
  return found;
}

Loss loss_of(const MaterialResult& m, const SamplerResult& ours, const SamplerResult& winner,
             std::span<const Illumination> lights, const StudyOptions& o) {
  Loss loss{m.material, winner.sampler, efficiency(ours) / efficiency(winner), 0, "", 0, 0};
  double worst = 1e300;
  for (std::size_t i = 0; i < ours.cells.size(); ++i) {
    for (std::size_t e = 0; e < lights.size(); ++e) {
      const StudyCell &a = ours.cells[i], &b = winner.cells[i];
      const double ratio = cost(b, e) / cost(a, e);
      if (!(ratio < worst)) continue;
      worst = ratio;
      loss.theta_o_deg = o.theta_o_deg[i], loss.light = lights[e].name;
      loss.error_ratio = b.error[e] / a.error[e];
      loss.time_ratio = b.sample_ns / b.floor_ns / (a.sample_ns / a.floor_ns);
    }
  }
  return loss;
}

}  // namespace

std::string cause_of(const Loss& loss) {
  if (loss.error_ratio > 0.95) return "quicker samples";
  if (loss.time_ratio > 0.95) return "samples that vary less";
  return "samples that are quicker and vary less";
}

double efficiency(const SamplerResult& sampler) {
  double sum = 0, n = 0;
  for (const StudyCell& c : sampler.cells) {
    for (std::size_t e = 0; e < c.error.size(); ++e) {
      const double x = cost(c, e);
      if (!(x > 0) || !isfinite(x)) return 0;
      sum -= std::log(x), n += 1;
    }
  }
  return n > 0 ? std::exp(sum / n) : 0;
}

Verdict judge(std::span<const MaterialResult> materials, std::span<const SamplerInfo> samplers,
              std::span<const Illumination> lights, const StudyOptions& options) {
  Verdict verdict;
  std::vector<double> logs(samplers.size(), 0);
  for (const SamplerInfo& info : samplers) {
    verdict.scores.push_back({std::string(info.name), is_ours(info), info.general, 0, 0, 0, 0});
  }
  for (const MaterialResult& m : materials) {
    const SamplerResult* ours = best(m, samplers, is_ours);
    const SamplerResult* other =
        best(m, samplers, [](const SamplerInfo& info) { return info.general && !is_ours(info); });
    if (!ours || !other) continue;
    ++verdict.materials;
    const double reference = efficiency(*ours);
    for (std::size_t k = 0; k < samplers.size(); ++k) {
      const SamplerResult* s = find(m, samplers[k].name);
      if (!s) continue;
      Score& score = verdict.scores[k];
      score.faults += !s->fault.empty();
      for (const StudyCell& c : s->cells) score.biased_cells += c.biased;
      const double e = efficiency(*s);
      if (!(e > 0)) continue;
      ++score.materials;
      logs[k] += std::log(e / reference);
    }
    if (efficiency(*other) <= reference) {
      ++verdict.won;
    } else {
      verdict.losses.push_back(loss_of(m, *ours, *other, lights, options));
    }
  }
  verdict.best_in_mean = verdict.materials > 0;
  for (std::size_t k = 0; k < samplers.size(); ++k) {
    Score& s = verdict.scores[k];
    if (s.materials > 0) s.relative_efficiency = std::exp(logs[k] / s.materials);
    if (s.general && !s.ours && s.relative_efficiency > 1) verdict.best_in_mean = false;
  }
  std::sort(verdict.losses.begin(), verdict.losses.end(),
            [](const Loss& a, const Loss& b) { return a.ratio < b.ratio; });
  verdict.nine_in_ten = verdict.materials > 0 && 10 * verdict.won >= 9 * verdict.materials;
  return verdict;
}

}  // namespace reflectree::study
