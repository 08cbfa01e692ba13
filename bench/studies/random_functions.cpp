// SPDX-License-Identifier: Apache-2.0
// Builds samplers of functions by seeds and judges them by what is known of those in closed form: the albedo at
// every node of its table and between, and what each lobe has of the directions of both modes. Prints a Markdown
// table; exit code 1 if an answer is wrong without a word.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "random_function.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "study_program.hpp"
#include "threads.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

struct Row {
  std::string verdict, words;
  double seconds = 0, trials = 0, stated = 0, miss = 0, z = 0, overshoot = 0;
  bool wrong = false;
};

void add(Row& row, const char* format, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  row.words += text;
}

// The table at its nodes and in their middles, up to 89.9 degrees.
void judge_albedo(const RandomFunction& f, const AlbedoTable& table, Row& row) {
  double at = 0;
  for (std::size_t i = 0; i + 1 < table.cos_theta_o.size(); ++i) {
    const float a = table.cos_theta_o[i], b = table.cos_theta_o[i + 1];
    for (const float c : {a, 0.5f * (a + b)}) {
      if (c < 1.8e-3f) continue;
      const double truth = f.albedo({std::sqrt((1 - c) * (1 + c)), 0, c});
      const double miss = std::abs(double(albedo_at(table, c)) / truth - 1);
      if (miss > row.miss) row.miss = miss, at = std::acos(double(c)) * 180 / pi_v<double>;
    }
  }
  row.stated = double(table.relative_error);
  if (row.miss <= row.stated) return;
  row.wrong = true;
  add(row, "albedo wrong by %.2g at %.3f degrees; ", row.miss, at);
}

struct Mean {
  double sum = 0, square = 0;
  void add(double x) { sum += x, square += x * x; }
  // From the truth, in standard errors, beyond rounding.
  double z(double truth, double n) const {
    constexpr double rounding = 2e-6;
    const double mean = sum / n, error = std::sqrt(std::max(square / n - mean * mean, 0.) / n) + 1e-9;
    return std::max(std::abs(mean - truth) - rounding * truth, 0.) / error;
  }
};

// What each lobe has of f, for directions of both modes: of the exact ones its part of the albedo, relatively,
// and times the weights of one-shot its part itself.
void judge_lobes(const RandomFunction& f, const Sampler<RandomFunction>& s, int samples, std::uint64_t seed,
                 Row& row) {
  constexpr double improbable = 6;
  Pcg32 u(seed, 43);
  SampleStatistics statistics;
  double worst_trials = 0;
  for (int viewer = 0; viewer < 6; ++viewer) {
    const float z = max(to_unit_float(u()), 0.01f), phi = 2 * pi * to_unit_float(u()),
                r = sqrt((1 - z) * (1 + z));
    const Direction wo{r * std::cos(phi), r * std::sin(phi), z};
    const double albedo = f.albedo(wo), degrees = std::acos(double(z)) * 180 / pi_v<double>;
    std::vector<Mean> exact(f.lobes.size()), one_shot(f.lobes.size());
    SampleStatistics here;
    for (int i = 0; i < samples; ++i) {
      const auto e = s.exact.sample(wo, u, here);
      const auto o = s.one_shot.sample(wo, u);
      for (std::size_t k = 0; k < f.lobes.size(); ++k) {
        exact[k].add(e ? double(f.lobes[k](wo, e->wi)) / double(f(wo, e->wi)) : 0);
        one_shot[k].add(o && o->weight > 0
                            ? double(f.lobes[k](wo, o->wi)) / double(f(wo, o->wi)) * double(o->weight)
                            : 0);
      }
    }
    for (std::size_t k = 0; k < f.lobes.size(); ++k) {
      const double part = f.lobes[k].albedo(wo);
      if (part * samples < 100 * albedo) continue;  // too few directions to tell
      const double ze = exact[k].z(part / albedo, samples), zo = one_shot[k].z(part, samples);
      row.z = std::max({row.z, ze, zo});
      if (ze > improbable)
        row.wrong = true, add(row, "exact: a lobe is %.1f errors off at %.2f degrees; ", ze, degrees);
      if (zo > improbable)
        row.wrong = true, add(row, "one-shot: a lobe is %.1f errors off at %.2f degrees; ", zo, degrees);
    }
    statistics.trials += here.trials, statistics.overshoot_sum += here.overshoot_sum;
    const double trials = double(here.trials) / double(samples);
    worst_trials =
        std::max(worst_trials, trials - 6 * std::sqrt(trials * std::max(trials - 1, 0.) / samples));
  }
  row.overshoot = statistics.overshoot_sum / double(statistics.trials);
  if (worst_trials > std::max(row.trials, 1.) * 1.001)
    row.wrong = true, add(row, "%.3f trials, %.3f stated; ", worst_trials, row.trials);
}

Row judge(std::uint64_t seed, double limit, int samples, double planted, const Host& threads) {
  using Clock = std::chrono::steady_clock;
  Row row;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  Host host = threads;
  host.cancelled = [&] { return seconds() > limit; };
  const RandomFunction f = random_function(seed);
  try {
    SamplerData data = build(AnyBrdf(f), {}, host);
    row.seconds = seconds(), row.trials = double(data.report.expected_trials);
    for (std::size_t i = 0; i < (data.albedo.albedo.size() + 7) / 8; ++i)
      data.albedo.albedo[i] *= float(1 + planted);
    for (const std::string& note : data.report.notes) row.words += note + "; ";
    const bool told = !data.report.notes.empty();
    judge_albedo(f, data.albedo, row);
    judge_lobes(f, make_sampler(f, data), samples, seed, row);
    if (row.trials > 1.2501 && !told) row.wrong = true, row.words += "more trials than promised, no word; ";
    row.verdict = row.wrong ? "WRONG" : told ? "right, told" : "right";
  } catch (const Cancelled&) {
    row.seconds = seconds(), row.verdict = "TOO LONG", row.wrong = true;
  } catch (const Error& e) {
    row.seconds = seconds(), row.words = e.what(), row.verdict = "refused";
  }
  return row;
}

constexpr const char* preface = R"(# Functions by seeds

Made by `study_random_functions`. Each function is a matt ground with one to four lobes, bumps and discs of 0.004 to 0.6
radians, which stand still (two mirror images) or go with the mirror direction or with the viewer; each has 0.1 % to 6
times the ground's albedo. That albedo is known to six digits. Each function is built with the default options. Judged are
the table of the albedo at every node and between, and, for six viewers, what each lobe has of the directions of both
modes (*largest z*: in standard errors, 6 are allowed). *Stated*: the relative error that the table states, *albedo's
miss*: the true one. Functions that are right without a word have no row unless `--all` is given.

)";

std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? std::string("\\|") : std::string(1, c);
  return safe;
}

int run(int argc, char** argv) {
  CLI::App app{"Functions by seeds, whose albedo is known: built, judged, and printed as a table"};
  std::uint64_t from = 1, count = 100;
  double limit = 60, planted = 0;
  int threads = 2, samples = 50'000;
  bool all = false;
  app.add_option("--from", from, "the first seed");
  app.add_option("--count", count, "how many");
  app.add_option("--limit", limit, "seconds after which a build is given up");
  app.add_option("--samples", samples, "of each mode, for each of six viewers")
      ->check(CLI::Range(1000, 100'000'000));
  app.add_option("--threads", threads)->check(CLI::Range(1, 256));
  app.add_option("--plant", planted,
                 "makes an eighth of each table of the albedo brighter by this share: must be noticed");
  app.add_flag("--all", all,
               "a row for every function, not only for those that are told of, refused or wrong");
  return run_program(app, argc, argv, [&] {
    const Host host = host_with_threads(threads);
    std::printf("%s", preface);
    std::printf(
        "| seed | function | verdict | seconds | trials | stated | albedo's miss | largest z | overshoot | "
        "words |\n");
    std::printf("|---:|---|---|---:|---:|---:|---:|---:|---:|---|\n");
    std::uint64_t right = 0, told = 0, refused = 0, wrong = 0;
    double slowest = 0, total = 0;
    for (std::uint64_t seed = from; seed < from + count; ++seed) {
      const Row r = judge(seed, limit, samples, planted, host);
      (r.verdict == "right"         ? right
       : r.verdict == "right, told" ? told
       : r.verdict == "refused"     ? refused
                                    : wrong) += 1;
      slowest = std::max(slowest, r.seconds), total += r.seconds;
      if (r.verdict == "right" && !all) continue;
      std::printf("| %llu | %s | %s | %.2f | %.3f | %.2g | %.2g | %.1f | %.1e | %s |\n",
                  static_cast<unsigned long long>(seed), random_function(seed).words().c_str(),
                  r.verdict.c_str(), r.seconds, r.trials, r.stated, r.miss, r.z, r.overshoot,
                  cell(r.words).c_str());
      std::fflush(stdout);
    }
    std::printf(
        "\n%llu functions: %llu right, %llu right and told of, %llu refused, %llu wrong; a build took %.2f s "
        "on "
        "average, %.1f s at most.\n",
        static_cast<unsigned long long>(count), static_cast<unsigned long long>(right),
        static_cast<unsigned long long>(told), static_cast<unsigned long long>(refused),
        static_cast<unsigned long long>(wrong), total / double(std::max<std::uint64_t>(count, 1)), slowest);
    return wrong > 0 ? 1 : 0;
  });
}

}  // namespace

int main(int argc, char** argv) { return run(argc, argv); }
