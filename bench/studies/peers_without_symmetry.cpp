// SPDX-License-Identifier: Apache-2.0
// `reflectree compare --quick` on the one function of the anisotropic study that no text names: it has no symmetry at
// all. Prints Markdown.
#include <cstdio>

#include "main_job/without_symmetry.hpp"
#include "reflectree/study/verdict.hpp"
#include "study_program.hpp"

namespace {

using namespace reflectree;

// As it must tell competitors, which look for no symmetries themselves.
struct WithoutSymmetry {
  Rgb operator()(Direction wo, Direction wi) const { return study::without_symmetry(wo, wi); }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.name = "without any symmetry";
    traits.channels = 3;
    traits.isotropic = false;
    return traits;
  }
};

int run(bool all) {
  const study::StudyOptions options = study::quick_study();
  const std::vector<study::Illumination> lights = study::procedural_illuminations();
  std::vector<const SamplerInfo*> wanted;
  for (const SamplerInfo& info : samplers()) {
    // Slow to build, and behind the proxy wherever they were measured.
    const std::string_view name = info.name;
    const bool slow =
        name == "proxy-oracle" || name == "resampling" || name == "factored" || name == "wavelet";
    if (all || !slow) wanted.push_back(&info);
  }
  const study::StudyMaterial material{"without any symmetry", {}, AnyBrdf(WithoutSymmetry{})};
  const std::vector<study::MaterialResult> found{study::measure(material, wanted, lights, options, {})};
  const study::Verdict verdict = study::judge(found, samplers(), lights, options);
  std::printf(
      "| sampler | efficiency | variance at %g° | ns | KiB | build s | biased cells "
      "|\n|---|---:|---:|---:|---:|"
      "---:|---:|\n",
      options.theta_o_deg[1]);
  for (const study::SamplerResult& s : found[0].samplers) {
    for (const study::Score& score : verdict.scores) {
      if (score.sampler != s.sampler || s.cells.size() < 2) continue;
      std::printf("| %s | %.3g | %.3g | %.0f | %.0f | %.2f | %d |\n", s.sampler.c_str(),
                  score.relative_efficiency, s.cells[1].target_variance, s.cells[1].sample_ns,
                  double(s.bytes) / 1024, s.build_seconds, score.biased_cells);
    }
    if (!s.fault.empty()) std::printf("| %s | %s |\n", s.sampler.c_str(), s.fault.c_str());
  }
  for (const study::Loss& loss : verdict.losses)
    std::printf("\nlost to %s: %.3g, most at %g° under %s: %s\n", loss.winner.c_str(), loss.ratio,
                loss.theta_o_deg, loss.light.c_str(), study::cause_of(loss).c_str());
  return verdict.losses.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Every competitor on a function without any symmetry, as Markdown.");
  bool all = false;
  app.add_flag("--all", all, "those, too, that are slow to build and were never near");
  return study::run_program(app, argc, argv, [&] { return run(all); });
}
