// SPDX-License-Identifier: Apache-2.0
// How cost grows: with sharpness, with accuracy, with the cost of one evaluation of f, with threads and
// materials, and that of the competitors. Prints Markdown; writes its plots into the folder named first.
#include <chrono>
#include <cstdio>

#include "log_plot.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/study/measure.hpp"
#include "reflectree/study/thread_time.hpp"
#include "scaling_parts.hpp"
#include "study_program.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

struct Row {
  double x = 0, exact_leaves = 0, one_shot_leaves = 0, kib = 0, seconds = 0, exact_ns = 0, one_shot_ns = 0,
         trials = 0, variance = 0;
};

Row measure_build(double x, const AnyBrdf& f, const BuildOptions& options) {
  Row row;
  row.x = x;
  const double start = thread_seconds();
  const SamplerData data = build(f, options);
  row.seconds = thread_seconds() - start;
  for (const MajorantTree& t : data.exact) row.exact_leaves += double(t.mass.size());
  for (const DensityTree& t : data.one_shot) row.one_shot_leaves += double(t.mass.size());
  const auto packed = std::make_shared<const PackedSampler>(pack(data));
  row.kib = double(bytes_of(*packed)) / 1024;
  const ExactSampler<AnyBrdf> exact(f, packed);
  const OneShotSampler<AnyBrdf> one_shot(f, packed);
  Pcg32 u(1, 1);
  std::vector<Direction> wo(512);
  for (Direction& w : wo) w = direction_from_angles(1.5f * to_unit_float(u()), 2 * pi * to_unit_float(u()));
  double sum = 0;
  row.exact_ns = 1e9 * median_seconds(5e-3, [&](std::size_t i) {
                   if (const auto s = exact.sample(wo[i % 512], u)) sum += double(s->pdf);
                 });
  row.one_shot_ns = 1e9 * median_seconds(5e-3, [&](std::size_t i) {
                      if (const auto s = one_shot.sample(wo[i % 512], u)) sum += double(s->pdf);
                    });
  row.trials = double(data.report.expected_trials), row.variance = double(data.report.one_shot_variance);
  if (!(sum >= 0)) row.exact_ns = 0;
  return row;
}

// Least squares in log-log.
double exponent(const std::vector<Row>& rows, double Row::*y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Row& r : rows) {
    const double lx = std::log(r.x), ly = std::log(r.*y);
    n += 1, sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

constexpr double Row::*columns[] = {&Row::exact_leaves, &Row::one_shot_leaves, &Row::kib,    &Row::seconds,
                                    &Row::exact_ns,     &Row::one_shot_ns,     &Row::trials, &Row::variance};

void print(const char* title, const char* x, const std::vector<Row>& rows) {
  std::printf("## %s\n\n    build/bin/study_scaling docs/results\n\n", title);
  std::printf(
      "| %s | exact leaves | one-shot leaves | KiB | build s (*) | exact ns (*) | one-shot ns (*) | "
      "trials | variance |\n|---|---|---|---|---|---|---|---|---|\n",
      x);
  for (const Row& r : rows) {
    std::printf("| %g", r.x);
    for (const auto c : columns) std::printf(" | %.3g", r.*c);
    std::printf(" |\n");
  }
  std::printf("| exponent");
  for (const auto c : columns) std::printf(" | %.2f", exponent(rows, c));
  std::printf(" |\n\n");
  std::fflush(stdout);
}

// Both modes' columns over x.
void save_plot(const std::string& folder, const char* file, const char* title, const char* x, const char* y,
               const std::vector<Row>& rows, double Row::*exact, double Row::*one_shot) {
  LogCurve a{"exact", "curve", {}, {}}, b{"one-shot", "curve-2", {}, {}};
  for (const Row& r : rows) {
    if (exact) a.x.push_back(r.x), a.y.push_back(r.*exact);
    if (one_shot) b.x.push_back(r.x), b.y.push_back(r.*one_shot);
  }
  std::vector<LogCurve> curves;
  if (exact) curves.push_back(std::move(a));
  if (one_shot) curves.push_back(std::move(b));
  std::printf("![%s](%s.svg)\n\n", title, file);
  if (!folder.empty())
    write_file_atomically(folder + "/" + file + ".svg", draw::to_svg(log_plot(title, x, y, curves)));
}

// GGX that burns a chosen time besides.
struct Slow {
  Ggx f;
  double ns = 0;
  Rgb operator()(Direction wo, Direction wi) const {
    using Clock = std::chrono::steady_clock;
    const auto until = Clock::now() + std::chrono::duration<double, std::nano>(ns);
    const Rgb value = reflectree::eval(f, wo, wi);
    while (ns > 0 && Clock::now() < until) {
    }
    return value;
  }
};

int run(const std::string& folder) {
  std::printf(
      "# How cost grows\n\nLeaves, KiB, trials and variance depend on nothing but the code. Columns with (*) "
      "are "
      "timings.\n\n");
  std::vector<Row> rows;
  for (const float alpha : {1.f, 0.5f, 0.2f, 0.1f, 0.05f, 0.02f, 0.01f, 0.005f, 0.002f, 0.001f}) {
    Ggx f;
    f.alpha = alpha;
    rows.push_back(measure_build(double(alpha), AnyBrdf(f), {}));
  }
  print("Sharpness", "alpha of GGX", rows);
  save_plot(folder, "scaling-sharpness", "Leaves against sharpness", "alpha of GGX", "leaves of all slabs",
            rows, &Row::exact_leaves, &Row::one_shot_leaves);
  Ggx f;
  f.alpha = 0.1f;
  rows.clear();
  for (const float trials : {2.f, 1.5f, 1.25f, 1.12f, 1.06f, 1.03f}) {
    BuildOptions o;
    o.expected_trials = trials;
    rows.push_back(measure_build(double(trials) - 1, AnyBrdf(f), o));
  }
  print("Accuracy of exact mode", "expected trials - 1", rows);
  save_plot(folder, "scaling-exact", "Leaves against rejection", "expected trials − 1", "leaves of all slabs",
            rows, &Row::exact_leaves, nullptr);
  rows.clear();
  for (const float variance : {0.1f, 0.03f, 0.01f, 0.003f, 0.001f, 0.0003f}) {
    BuildOptions o;
    o.one_shot_variance = variance;
    rows.push_back(measure_build(double(variance), AnyBrdf(f), o));
  }
  print("Accuracy of one-shot mode", "relative variance", rows);
  save_plot(folder, "scaling-one-shot", "Leaves against variance", "relative variance", "leaves of all slabs",
            rows, nullptr, &Row::one_shot_leaves);
  rows.clear();
  for (const double ns : {1., 10., 100., 1000., 10000.}) {
    Slow slow{f, ns};
    // Built with the quick function: what is asked here is the time of a sample.
    const auto packed = std::make_shared<const PackedSampler>(pack(build(AnyBrdf(f))));
    const ExactSampler<AnyBrdf> exact(AnyBrdf(slow), packed);
    const OneShotSampler<AnyBrdf> one_shot(AnyBrdf(slow), packed);
    Pcg32 u(1, 1);
    const Direction wo = direction_from_angles(0.8f, 0.f);
    Row row;
    row.x = ns;
    row.exact_ns = 1e9 * median_seconds(1e-2, [&](std::size_t) { (void)exact.sample(wo, u); });
    row.one_shot_ns = 1e9 * median_seconds(1e-2, [&](std::size_t) { (void)one_shot.sample(wo, u); });
    rows.push_back(row);
  }
  std::printf(
      "## Cost of one evaluation\n\n    build/bin/study_scaling docs/results\n\n"
      "| ns burnt beside f | exact ns (*) | one-shot ns (*) |\n|---|---|---|\n");
  for (const Row& r : rows) std::printf("| %g | %.0f | %.0f |\n", r.x, r.exact_ns, r.one_shot_ns);
  std::printf("\n");
  save_plot(folder, "scaling-evaluation", "Time of a sample against that of f", "ns burnt beside f",
            "ns per sample", rows, &Row::exact_ns, &Row::one_shot_ns);
  show_threads();
  show_materials(folder);
  show_competitors(folder);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "How cost grows, as Markdown: with sharpness, accuracy, the cost of f, threads and materials.");
  std::string folder;
  app.add_option("FOLDER", folder, "where the plots go; none are drawn without it")
      ->check(CLI::ExistingDirectory);
  return run_program(app, argc, argv, [&] { return run(folder); });
}
