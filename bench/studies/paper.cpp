// SPDX-License-Identifier: Apache-2.0
// The paper's results again: pictures, error against samples and time, the law of the error against N, which
// is a check that can fail (exit code 1), and the cost of precomputation. Prints Markdown; writes its
// pictures into the folder named first. Measured materials are those of REFLECTREE_DATA, a few, or all after
// --all; and every .binary file of the folder after --merl. After --only-measured nothing else is done.
#include <cstdio>

#include "judged.hpp"
#include "log_plot.hpp"
#include "paper_parts.hpp"
#include "study_program.hpp"

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/peers/paper_sampler.hpp"
#include "reflectree/study/measure.hpp"
#include "reflectree/study/thread_time.hpp"
#include "reflectree/verify/reference.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

constexpr const char* text = "ggx:alpha=0.3";
const Direction curve_wo = direction_from_angles(pi / 4, 0.f);

struct Law {
  std::string name;
  std::vector<double> n, rmse;
  double slope = 0;
};

Law law(std::string name, const ErrorCurve& curve, const std::vector<double>& square) {
  Law l{std::move(name), {}, {}, 0};
  for (std::size_t i = 0; i < curve.n.size(); ++i) {
    l.n.push_back(curve.n[i]), l.rmse.push_back(std::sqrt(square[i]));
  }
  l.slope = log_slope(l.n, l.rmse);
  return l;
}

draw::Figure plot(const std::vector<Law>& laws) {
  constexpr const char* css[] = {"curve-3", "curve-4", "curve", "curve-2"};
  std::vector<LogCurve> curves;
  for (std::size_t i = 0; i < laws.size(); ++i)
    curves.push_back({laws[i].name, css[i % 4], laws[i].n, laws[i].rmse});
  return log_plot("Error against samples", "*N*", "relative RMSE", curves);
}

bool show_law(const AnyBrdf& f, const std::string& folder) {
  const std::vector<Illumination> lights{procedural_illuminations()[1]};
  const double albedo = reference_albedo(target_function(f), curve_wo).value;
  StudyOptions o;
  o.curve_repeats = 512, o.curve_samples = 4096;
  const PeerSubject subject{f, parse_material(text), {}, nullptr};
  std::vector<Law> laws;
  for (const char* name : {"paper", "exact", "one-shot-monotone"}) {
    const auto sampler = find_sampler(name)->make(subject, {});
    const ErrorCurve c = measure_curves(*sampler, curve_wo, albedo, lights, o, 21)[0];
    laws.push_back(law(name, c, c.random));
    // A point enters rejection through its first two words alone: stratified points help one-shot mode.
    if (std::string(name) == "one-shot-monotone")
      laws.push_back(law("one-shot, Owen-Sobol'", c, c.stratified));
  }
  std::printf(
      "## The law of the error\n\n    build/bin/study_paper docs/results\n\n%s, theta_o = 45 deg, under the "
      "sky, 512 runs per point, N = 1, 4, ..., 4096.\n\n| sampler | slope | promised | "
      "|\n|---|---|---|---|\n",
      text);
  bool all = true;
  for (const Law& l : laws) {
    const bool qmc = l.name.ends_with("Sobol'");
    const bool holds = qmc ? l.slope < -0.6 : std::abs(l.slope + 0.5) <= 0.02;
    all = all && holds;
    std::printf("| %s | %.3f | %s | %s |\n", l.name.c_str(), l.slope, qmc ? "below -0.6" : "-0.5 ± 0.02",
                holds ? "holds" : "fails");
  }
  std::printf("\n![RMSE against N](paper-law.svg)\n\n");
  if (!folder.empty()) write_file_atomically(folder + "/paper-law.svg", draw::to_svg(plot(laws)));
  return all;
}

// Between two tabulated angles: 45 deg is the middle of a range where `thetas` is odd, an edge
// where it is even.
void show_precomputation(const AnyBrdf& f) {
  std::printf(
      "## The cost of precomputation\n\n    build/bin/study_paper docs/results\n\n%s. Bias: of the mean "
      "weight "
      "against cubature, the worst of 64 theta_o from 1 to 85 deg; variance: relative, likewise.\n\n"
      "| n_max | theta_u | build s (*) | MB | ns (*) | worst bias | worst variance "
      "|\n|---|---|---|---|---|---|---|\n",
      text);
  const TargetFunction target = target_function(f);
  constexpr int angles = 64;
  std::vector<Direction> wos;
  std::vector<double> albedo;
  for (int i = 0; i < angles; ++i) {
    wos.push_back(direction_from_angles(float((1 + 84 * (i + 0.5) / angles) * pi_v<double> / 180), 0.f));
    albedo.push_back(reference_albedo(target, wos.back()).value);
  }
  StudyOptions o;
  o.samples = 1U << 14U;
  for (const auto& [n_max, thetas] :
       {std::pair{1.5, 90}, {2., 90}, {4., 90}, {8., 90}, {16., 90}, {4., 9}, {4., 30}, {4., 270}}) {
    PaperOptions options;
    options.n_max = n_max, options.thetas = thetas;
    const double start = thread_seconds();
    const PaperSampler paper(f, {}, options);
    const double seconds = thread_seconds() - start;
    const AnySampler<Spectrum> any("paper", paper, paper.bytes());
    double bias = 0, variance = 0;
    for (std::size_t i = 0; i < wos.size(); ++i) {
      const study::StudyCell c = measure_cell(any, {}, wos[i], albedo[i], 0, {}, o, 7);
      bias = max(bias, std::abs(c.bias)), variance = max(variance, c.target_variance);
    }
    UniformBits u{Pcg32(3)};
    const double ns =
        1e9 * median_seconds(3e-3, [&](std::size_t i) { (void)any.sample(wos[i % angles], u); });
    std::printf("| %g | %d | %.3g | %.3g | %.0f | %.1e | %.1e |\n", n_max, thetas, seconds,
                double(any.bytes()) / 1e6, ns, bias, variance);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "The paper's results again, as Markdown. Columns with (*) are timings, on one thread. Ends with exit "
      "code 1 if "
      "a slope of error against samples fails.");
  std::string folder;
  Measured measured;
  bool only_measured = false;
  app.add_option("FOLDER", folder, "where the pictures go; none are drawn without it")
      ->check(CLI::ExistingDirectory);
  app.add_flag("--all", measured.all, "all measured materials of REFLECTREE_DATA, not every twelfth");
  app.add_flag("--only-measured", only_measured, "only memory and precomputation of measured materials");
  app.add_option("--merl", measured.merl, "a folder with .binary files of the MERL database")
      ->check(CLI::ExistingDirectory);
  return run_program(app, argc, argv, [&] {
    if (only_measured) {
      show_measured(measured);
      return 0;
    }
    const AnyBrdf f = make_brdf(parse_material(text));
    std::printf(
        "# The paper's results again\n\nColumns with (*) are timings, on one thread. The rest depends on "
        "nothing "
        "but the code and the seed. The slopes are a check: the program ends with exit code 1 if one "
        "fails.\n\n");
    show_pictures(folder);
    show_few_against_many();
    const bool holds = show_law(f, folder);
    show_time();
    show_precomputation(f);
    show_measured(measured);
    return holds ? 0 : 1;
  });
}
