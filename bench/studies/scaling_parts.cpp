// SPDX-License-Identifier: Apache-2.0
#include "scaling_parts.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include "judged.hpp"
#include "log_plot.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/formats/file.hpp"

namespace reflectree::study {

namespace {

AnyBrdf ggx(float alpha) {
  Ggx f;
  f.alpha = alpha;
  return AnyBrdf(f);
}

// CPU seconds of all threads together.
struct Worked {
  double wall = 0, cpu = 0;
};
Worked on_threads(int count, const std::function<void(int)>& body) {
  std::atomic<double> cpu{0};
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::thread> threads;
  for (int t = 0; t < count; ++t) {
    threads.emplace_back([&, t] {
      const double from = thread_seconds();
      body(t);
      cpu += thread_seconds() - from;
    });
  }
  for (std::thread& t : threads) t.join();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), cpu};
}

Worked build_on(int count, const AnyBrdf& f) {
  Worked sum;
  Host host;
  host.parallel_for = [&](std::size_t n, const auto& body) {
    std::atomic<std::size_t> next{0};
    const Worked w = on_threads(count, [&](int) {
      for (std::size_t i = next++; i < n; i = next++) body(i, i + 1);
    });
    sum.cpu += w.cpu;
  };
  const double from = thread_seconds();
  const auto start = std::chrono::steady_clock::now();
  (void)build(f, {}, host);
  sum.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  sum.cpu += thread_seconds() - from;
  return sum;
}

}  // namespace

void show_threads() {
  std::printf(
      "\n## Threads\n\n    build/bin/study_scaling docs/results\n\nggx:alpha=0.1, one sampler shared by all "
      "threads; "
      "CPU seconds are sums over them and grow only by what threads cost each other. The wall clock tells of "
      "the "
      "machine, too: more threads than cores gain nothing.\n\n| threads | build CPU s (*) | build wall s (*) "
      "| "
      "exact CPU ns per sample (*) | one-shot CPU ns (*) |\n|---|---|---|---|---|\n");
  const AnyBrdf f = ggx(0.1f);
  const auto packed = std::make_shared<const PackedSampler>(pack(build(f)));
  const ExactSampler<AnyBrdf> exact(f, packed);
  const OneShotSampler<AnyBrdf> one_shot(f, packed);
  const Direction wo = wo_at_deg(45);
  for (const int count : {1, 2, 4}) {
    const Worked built = build_on(count, f);
    constexpr int n = 2'000'000;
    const auto ns = [&](const auto& sampler) {
      std::atomic<double> kept{0};
      const Worked w = on_threads(count, [&](int t) {
        Pcg32 u(1, std::uint64_t(t));
        double sum = 0;
        for (int i = 0; i < n; ++i) {
          if (const auto s = sampler.sample(wo, u)) sum += double(s->pdf);
        }
        kept += sum;
      });
      return kept > 0 ? 1e9 * w.cpu / (double(count) * n) : 0;
    };
    std::printf("| %d | %.3g | %.3g | %.0f | %.0f |\n", count, built.cpu, built.wall, ns(exact),
                ns(one_shot));
  }
}

void show_materials(const std::string& folder) {
  std::printf(
      "\n## Materials\n\n    build/bin/study_scaling docs/results\n\nN samplers of GGX, alpha from 0.02 to "
      "0.5; each "
      "sample asks another at random, as rays do.\n\n| materials | KiB | build s (*) | exact ns (*) | "
      "one-shot ns (*) "
      "|\n|---|---|---|---|---|\n");
  std::vector<ExactSampler<AnyBrdf>> exact;
  std::vector<OneShotSampler<AnyBrdf>> one_shot;
  double kib = 0, seconds = 0;
  std::vector<double> n, bytes, time, exact_ns, one_shot_ns;
  const Direction wo = wo_at_deg(45);
  for (const std::size_t count : {1U, 4U, 16U, 64U, 256U}) {
    while (exact.size() < count) {
      const double place = double(exact.size() * 101 % 256) / 256;
      const AnyBrdf f = ggx(float(0.02 * std::pow(25, place)));
      const double from = thread_seconds();
      const auto packed = std::make_shared<const PackedSampler>(pack(build(f)));
      seconds += thread_seconds() - from, kib += double(bytes_of(*packed)) / 1024;
      exact.emplace_back(f, packed), one_shot.emplace_back(f, packed);
    }
    Pcg32 u(1, 1);
    double sum = 0;
    const auto ns = [&](const auto& all) {
      return 1e9 * median_seconds(1e-2, [&](std::size_t) {
               const std::size_t which = std::size_t(u()) * all.size() >> 32U;
               if (const auto s = all[which].sample(wo, u)) sum += double(s->pdf);
             });
    };
    n.push_back(double(count)), bytes.push_back(kib), time.push_back(seconds);
    exact_ns.push_back(ns(exact)), one_shot_ns.push_back(ns(one_shot));
    volatile double used = sum;
    (void)used;
    std::printf("| %zu | %.0f | %.3g | %.0f | %.0f |\n", count, kib, seconds, exact_ns.back(),
                one_shot_ns.back());
  }
  std::printf("| exponent | %.2f | %.2f | %.2f | %.2f |\n", log_slope(n, bytes), log_slope(n, time),
              log_slope(n, exact_ns), log_slope(n, one_shot_ns));
  std::printf("\n![Time of a sample against materials](scaling-materials.svg)\n");
  if (!folder.empty()) {
    const draw::Figure figure =
        log_plot("Time of a sample against materials", "samplers asked in turn", "ns per sample",
                 {{"exact", "curve", n, exact_ns}, {"one-shot", "curve-2", n, one_shot_ns}});
    write_file_atomically(folder + "/scaling-materials.svg", draw::to_svg(figure));
  }
}

void show_competitors(const std::string& folder) {
  constexpr float alphas[] = {0.5f, 0.2f, 0.1f, 0.05f, 0.02f, 0.01f};
  std::printf(
      "\n## Competitors against sharpness\n\n    build/bin/study_scaling docs/results\n\nGGX, alpha from 0.5 "
      "to 0.01; "
      "the fitted exponent of alpha, and in brackets the value at 0.01. Variance: relative, of the weight, "
      "the worst "
      "of 10, 45, 75, 85°.\n\n| sampler | KiB | build s (*) | × floor (*) | variance "
      "|\n|---|---|---|---|---|\n");
  StudyOptions o;
  o.samples = 1U << 14U;
  std::vector<JudgedSubject> subjects;
  for (const float alpha : alphas) subjects.push_back(subject_of("", ggx(alpha), {10, 45, 75, 85}, {}, o));
  const std::vector<double> x(std::begin(alphas), std::end(alphas));
  std::vector<LogCurve> curves;
  std::size_t ours = 0, others = 0;
  for (const SamplerInfo& info : samplers()) {
    if (!info.general) {
      ++others;
      continue;
    }
    std::vector<double> kib, seconds, floor, variance;
    for (const JudgedSubject& s : subjects) {
      const double from = thread_seconds();
      const auto sampler = info.make({s.f, {}, {}, nullptr}, {});
      seconds.push_back(thread_seconds() - from);
      const Judged j = judged(*sampler, s, {}, o);
      kib.push_back(double(sampler->bytes()) / 1024), floor.push_back(j.x_floor);
      variance.push_back(max(j.worst_variance, 1e-6));  // below it is rounding
    }
    std::printf("| %s", std::string(info.name).c_str());
    for (const auto* column : {&kib, &seconds, &floor, &variance})
      std::printf(" | %.2f (%.3g)", log_slope(x, *column), column->back());
    std::printf(" |\n");
    std::fflush(stdout);
    std::size_t& place = is_ours(info) ? ours : others;  // colours as on the page of compare
    const std::string css =
        is_ours(info) ? "ours dash-" + std::to_string(place % 3)
                      : "hue-" + std::to_string(place % 6) + " dash-" + std::to_string(place / 6 % 3);
    curves.push_back({std::string(info.name), css, x, variance});
    ++place;
  }
  std::printf("\n![Variance against sharpness](scaling-competitors.svg)\n");
  std::sort(curves.begin(), curves.end(),
            [](const LogCurve& a, const LogCurve& b) { return a.y.back() > b.y.back(); });
  if (folder.empty()) return;
  const draw::Figure figure =
      log_plot("Variance against sharpness", "alpha of GGX",
               "relative variance of the weight, worst elevation; the worst at 0.01 first", curves);
  write_file_atomically(folder + "/scaling-competitors.svg", draw::to_svg(figure));
}

}  // namespace reflectree::study
