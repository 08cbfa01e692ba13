// SPDX-License-Identifier: Apache-2.0
// Builds a sampler of every hard function and judges it by cubature and chi-square, which share no code with
// the builder. Prints a Markdown table; exit code 1 if an answer is wrong without a word.
#include <chrono>
#include <cstdio>
#include <ctime>

#include "hard_functions_list.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "study_program.hpp"
#include "threads.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

struct Row {
  std::string verdict, words;
  double seconds = 0, cpu = 0, trials = 0, variance = 0, p = 1;
  std::size_t leaves = 0, slabs = 0;
  std::string domain;
  bool wrong = false;
};

std::size_t leaves_of(const SamplerData& data) {
  std::size_t count = 0;
  for (const auto& tree : data.exact) count += tree.mass.size();
  for (const auto& tree : data.one_shot) count += tree.mass.size();
  return count;
}

// Both modes at one wo: counts, weights and mean weights.
void judge_viewer(const HardFunction& hard, const AnyBrdf& f, const Sampler<AnyBrdf>& s,
                  const SamplerData& data, float theta, float phi, Row& row, const Host& host) {
  const Direction flat = direction_from_angles(theta, 0.f), wo = direction_from_angles(theta, phi);
  const TargetFunction target = target_function(f, data.target);
  BinOptions bin_options;
  if (hard.centre) {
    const Direction c = hard.centre(flat);
    bin_options.centre = Vec3<double>{double(c.x * std::cos(phi) - c.y * std::sin(phi)),
                                      double(c.x * std::sin(phi) + c.y * std::cos(phi)), double(c.z)};
  }
  const Bins bins = equal_mass_bins(target, wo, bin_options, host);
  ChiSquareOptions chi;
  chi.tests = 1000;
  // A bin's own error is a bias: no more samples than hide it.
  const double error = bins.worst_error;
  chi.samples = std::uint64_t(std::clamp(0.5 / (error * error + 1e-12), 20'000., 300'000.));
  const ErasedSampler exact = erase(s.exact, data.target, "exact"),
                      one_shot = erase(s.one_shot, data.target, "one-shot");
  if (!(bins.total > 0)) {
    const Tally tally = tally_of(exact, bins, chi, host);
    if (tally.none != tally.samples) row.wrong = true, row.words += "directions where f is 0; ";
    return;
  }
  const Tally e = tally_of(exact, bins, chi, host);
  chi.seed = 2;
  const Tally o = tally_of(one_shot, bins, chi, host);
  const double stated = std::max(double(data.albedo.relative_error), 1e-6);
  for (const CheckResult& r :
       {check_counts(e, bins, chi), check_weights(o, bins, chi),
        check_mean_weight(e, bins, chi, stated + error), check_mean_weight(o, bins, chi, stated + error)}) {
    row.p = std::min(row.p, r.p_value);
    if (r.passed) continue;
    row.wrong = true;
    char where[64];
    std::snprintf(where, sizeof where, "at %.1f deg ", double(theta) * 180 / pi_v<double>);
    row.words += where + to_line(r) + "; ";
  }
  row.variance = std::max(row.variance, relative_variance(o));
}

Row judge(const HardFunction& hard, double limit, bool stages, const Host& threads) {
  using Clock = std::chrono::steady_clock;
  Row row;
  const auto start = Clock::now();
  const std::clock_t cpu = std::clock();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  Host host = threads;
  host.cancelled = [&] { return seconds() > limit; };
  if (stages)
    host.stage = [&](const char* words) { std::fprintf(stderr, "%6.2f s  %s\n", seconds(), words); };
  try {
    const AnyBrdf f = hard.make();
    const SamplerData data = build(f, {}, host);
    row.seconds = seconds(), row.cpu = double(std::clock() - cpu) / CLOCKS_PER_SEC;
    row.trials = double(data.report.expected_trials);
    row.leaves = leaves_of(data), row.slabs = data.exact.size() + data.one_shot.size();
    row.domain = name_of(data.domain.kind);
    for (const std::string& note : data.report.notes) row.words += note + "; ";
    const bool told = !data.report.notes.empty();
    const auto s = make_sampler(f, data);
    for (const auto& [theta, phi] : {std::pair{0.14f, 1.f}, {0.71f, 2.f}, {0.95f, 0.3f}, {1.35f, 4.f}}) {
      judge_viewer(hard, f, s, data, theta, phi, row, threads);
    }
    if (row.trials > 1.2501 && !told) row.wrong = true, row.words += "more trials than promised, no word; ";
    row.verdict = hard.refused ? "NOT REFUSED" : row.wrong ? "WRONG" : told ? "right, told" : "right";
    row.wrong = row.wrong || hard.refused;
  } catch (const Cancelled&) {
    row.seconds = seconds(), row.verdict = "TOO LONG", row.wrong = true;
  } catch (const std::exception& e) {
    row.seconds = seconds(), row.words = e.what();
    row.wrong = !hard.refused && !hard.may_be_refused;
    row.verdict = row.wrong ? "REFUSED" : "refused";
  }
  return row;
}

// A cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? std::string("\\|") : std::string(1, c);
  return safe;
}

constexpr const char* preface = R"(# Functions that tempt a builder

Made by `build/bin/study_hard_functions > docs/results/hard-functions.md`, on two cores. Each function is built with the
default options and judged at 8, 41, 54 and 77 degrees by chi-square, weights and mean weights against cubature, which
share no code with the builder; *least p* is the smallest of 16 (the level of one test is 1e-7). *Right, told*: right, and
the build says which promise it does not keep. *Refused*: no sampler, and a sentence that says why. *Seconds* of the wall
clock; *of a core*: of the processor, while building. *Variance*: relative, of one-shot weights, at the worst of the four.

)";

int run(int argc, char** argv) {
  CLI::App app{"Functions that tempt a builder to be wrong: built, judged, and printed as a table"};
  std::string only;
  double limit = 60;
  bool list = false, stages = false;
  int threads = 2;
  app.add_option("--only", only, "only functions whose name contains this");
  app.add_option("--limit", limit, "seconds after which a build is given up");
  app.add_option("--threads", threads)->check(CLI::Range(1, 256));
  app.add_flag("--stages", stages, "print what each build does, and when, to stderr");
  app.add_flag("--list", list, "list the functions");
  return run_program(app, argc, argv, [&] {
    const Host host = host_with_threads(threads);
    bool wrong = false;
    if (!list) std::printf("%s", preface);
    std::printf(
        "| function | what | verdict | seconds | of a core | domain | slabs | leaves | trials | variance | "
        "least p | words |\n");
    std::printf("|---|---|---|---:|---:|---|---:|---:|---:|---:|---:|---|\n");
    for (const HardFunction& hard : hard_functions()) {
      if (hard.name.find(only) == std::string::npos) continue;
      if (list) {
        std::printf("%s: %s\n", hard.name.c_str(), hard.what.c_str());
        continue;
      }
      const Row r = judge(hard, limit, stages, host);
      std::printf("| %s | %s | %s | %.2f | %.2f | %s | %zu | %zu | %.3f | %.4f | %.2g | %s |\n",
                  hard.name.c_str(), cell(hard.what).c_str(), r.verdict.c_str(), r.seconds, r.cpu,
                  r.domain.c_str(), r.slabs, r.leaves, r.trials, r.variance, r.p, cell(r.words).c_str());
      std::fflush(stdout);
      wrong = wrong || r.wrong;
    }
    return wrong ? 1 : 0;
  });
}

}  // namespace

int main(int argc, char** argv) { return run(argc, argv); }
