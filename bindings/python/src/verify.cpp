// SPDX-License-Identifier: Apache-2.0
// verify: the ways into a sampler that Python has, before the judges of the verify room.
#include "reflectree/verify/verify.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "host.hpp"
#include "judges.hpp"
#include "rounds.hpp"

namespace reflectree::python {

namespace {

// Into every array that is drawn go other viewers, too, the horizon and what lies below among them: a place
// that computes with its neighbour's numbers is seen.
constexpr std::size_t a_stranger_in = 5;

void take(const DrawnRows& drawn, std::size_t from, DrawnAt& out, float* weights) {
  out = {drawn.wi[from], drawn.pdf[from], drawn.valid[from] != 0, no_lane};
  std::copy_n(drawn.weight.begin() + std::ptrdiff_t(from * drawn.channels), drawn.channels, weights);
}

WayIn singly(const PySampler& s, Mode mode, const char* name) {
  WayIn way;
  way.name = name;
  way.exact = mode == Mode::exact;
  way.draw = [&s, mode](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    std::vector<Direction> wos = detail::strangers(out.size() + (out.size() + 3) / (a_stranger_in - 1), u);
    for (std::size_t k = 0; k < wos.size(); ++k) {
      if (k % a_stranger_in != 0) wos[k] = wo;
    }
    const DrawnRows drawn = draw(s, mode, wos, u);
    for (std::size_t k = 0, i = 0; i < out.size(); ++k) {
      if (k % a_stranger_in == 0) continue;
      take(drawn, k, out[i], weights.data() + i * drawn.channels);
      ++i;
    }
  };
  if (mode != Mode::exact) return way;
  way.watch = [&s](Direction wo, Pcg32& u, std::size_t n, TrialLog& log) {
    detail::LaneWatcher watcher(log, false);
    DrawnRows drawn(s, n);
    sample_rounds(s.sampler.exact, std::vector<Direction>(n, wo), {}, u, drawn.rows(), s.brdf.batch(),
                  watcher, s.brdf.lanes.get());
  };
  way.give_up = [&s](Direction wo) {
    return detail::trials_until_given_up([&](auto& bits, auto& count) {
      DrawnRows drawn(s, 1);
      sample_rounds(s.sampler.exact, {&wo, 1}, {}, bits, drawn.rows(), s.brdf.batch(), count,
                    s.brdf.lanes.get());
    });
  };
  return way;
}

// Calls of 1 to 48 directions, as a renderer makes them; a function of Python is asked for more at once.
std::size_t many_at_once(const PySampler& s, Pcg32& u) { return 1 + u() % (s.brdf.function ? 1024 : 48); }

WayIn many(const PySampler& s, bool exact, const char* name) {
  const auto draw_n = [&s, exact](Direction wo, auto& u, DrawnRows& drawn, auto& stats) {
    if (exact) {
      sample_n_rounds(s.sampler.exact, wo, u, drawn.rows(), s.brdf.batch(), stats, s.brdf.lanes.get());
    } else {
      sample_n_rounds(s.sampler.one_shot, wo, u, drawn.rows(), s.brdf.batch(), s.brdf.lanes.get());
    }
  };
  WayIn way;
  way.name = name;
  way.exact = exact;
  way.draw = [&s, draw_n](Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights) {
    for (std::size_t i = 0; i < out.size();) {
      DrawnRows drawn(s, std::min(many_at_once(s, u), out.size() - i));
      NoStatistics none;
      draw_n(wo, u, drawn, none);
      for (std::size_t k = 0; k < drawn.wi.size(); ++k, ++i)
        take(drawn, k, out[i], weights.data() + i * drawn.channels);
    }
  };
  if (!exact) return way;
  way.watch = [&s, draw_n](Direction wo, Pcg32& u, std::size_t n, TrialLog& log) {
    detail::LaneWatcher watcher(log, false);
    DrawnRows drawn(s, n);
    draw_n(wo, u, drawn, watcher);
  };
  way.give_up = [&s, draw_n](Direction wo) {
    return detail::trials_until_given_up([&](auto& bits, auto& count) {
      DrawnRows drawn(s, 1);
      draw_n(wo, bits, drawn, count);
    });
  };
  return way;
}

// Borrows the sampler.
Suspect suspect_of(const PySampler& s) {
  Suspect suspect = reflectree::suspect(s.sampler, s.brdf.f, &s.data);
  suspect.ways = {singly(s, Mode::exact, "sample"), many(s, true, "sample_n"),
                  singly(s, Mode::one_shot, "sample_one_shot"), singly(s, Mode::points, "sample_one_shot(u)"),
                  many(s, false, "sample_n(mode='one-shot')")};
  suspect.once = nullptr;  // Python has no such way
  return suspect;
}

nb::dict dict_of(const CheckResult& c) {
  nb::dict d;
  d["name"] = c.name;
  d["way"] = c.way;
  d["where"] = c.where;
  d["passed"] = c.passed;
  d["decided"] = c.decided;
  d["statistic"] = c.statistic;
  d["threshold"] = c.threshold;
  d["p_value"] = c.p_value;
  d["sentence"] = c.detail;
  return d;
}

nb::dict verify_sampler(const PySampler& s, double effort, std::uint64_t seed, unsigned threads,
                        nb::object progress) {
  if (!(effort >= 0.01 && effort <= 1000))
    throw Error(std::to_string(effort) + " is no effort", "effort", "give a factor from 0.01 to 1000");
  VerifyOptions options;
  options.effort = effort;
  options.seed = seed;
  // A function of Python is called by the thread that called us.
  const Host host = make_host(s.brdf.function ? 1 : threads, std::move(progress));
  const VerifyReport report = [&] {
    const nb::gil_scoped_release no_gil;
    host.stage("checking");
    const VerifyReport done = verify(suspect_of(s), options, host);
    host.progress(1);
    return done;
  }();
  nb::list checks, figures;
  for (const CheckResult& c : report.checks) checks.append(dict_of(c));
  for (const VerifyFigure& f : report.figures) figures.append(nb::make_tuple(f.name, f.where, f.value));
  nb::dict result;
  result["checks"] = checks;
  result["figures"] = figures;
  result["notes"] = report.notes;
  return result;
}

}  // namespace

void bind_verify(nb::module_& m) {
  m.def("verify", &verify_sampler, nb::arg("sampler"), nb::kw_only(), nb::arg("effort"), nb::arg("seed"),
        nb::arg("threads"), nb::arg("progress").none());
}

}  // namespace reflectree::python
