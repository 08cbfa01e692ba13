// SPDX-License-Identifier: Apache-2.0
#include "verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reflectree/study/measure.hpp"

namespace reflectree::pictures {

namespace {

// figure(cell) of the rival over ours, one ratio per seed.
template <class Figure>
Estimate ratio(const Cells& rival, const Cells& ours, const Figure& figure) {
  std::vector<double> ratios;
  for (const PictureCell* a : rival) {
    for (const PictureCell* b : ours) {
      if (a->round == b->round) ratios.push_back(figure(*a) / figure(*b));
    }
  }
  return geometric_mean_of(ratios);
}

template <class Of>
std::vector<std::string> names(const Results& results, std::string_view method, const Of& of) {
  std::vector<std::string> found;
  for (const PictureCell& c : results.cells) {
    if (c.method == method && std::find(found.begin(), found.end(), of(c)) == found.end())
      found.push_back(of(c));
  }
  return found;
}

// Two standard errors; unknown ones count for nothing.
double noise_of(const Estimate& e) { return std::isnan(e.error) ? 0 : 2 * e.error; }

// The factor of two is out of anyone's reach where even no noise of one's own would not give it.
Half half_of(const Against& a) {
  if (a.one_shot.value >= 2) return Half::reached;
  return a.ideal.value > 0 && a.ideal.value + noise_of(a.ideal) < 2 ? Half::out_of_reach : Half::missed;
}

Mean mean_over_scenes(const std::vector<Against>& against, const std::string& method,
                      const std::string& rival) {
  Mean m{method, rival, 0, {}, {}};
  double sums[4] = {};
  for (const Against& a : against) {
    if (a.method != method || a.rival != rival) continue;
    ++m.scenes;
    sums[0] += std::log(a.one_shot.value), sums[1] += std::pow(a.one_shot.error / a.one_shot.value, 2);
    sums[2] += std::log(a.exact.value), sums[3] += std::pow(a.exact.error / a.exact.value, 2);
  }
  const auto n = double(m.scenes);
  m.one_shot.value = std::exp(sums[0] / n), m.one_shot.error = m.one_shot.value * std::sqrt(sums[1]) / n;
  m.exact.value = std::exp(sums[2] / n), m.exact.error = m.exact.value * std::sqrt(sums[3]) / n;
  return m;
}

}  // namespace

Estimate mean_of(const std::vector<double>& x) {
  const auto n = double(x.size());
  double mean = 0, square = 0;
  for (const double v : x) mean += v / n;
  for (const double v : x) square += (v - mean) * (v - mean);
  return {mean, x.size() > 1 ? std::sqrt(square / (n - 1) / n) : std::numeric_limits<double>::quiet_NaN()};
}

Estimate geometric_mean_of(const std::vector<double>& x) {
  if (x.empty()) return {0, std::numeric_limits<double>::quiet_NaN()};
  std::vector<double> logs;
  for (const double v : x) logs.push_back(std::log(v));
  const Estimate e = mean_of(logs);
  return {std::exp(e.value), std::exp(e.value) * e.error};
}

// The samples that fit are whole: what remains is settled by error times time.
Estimate ratio_at_time(const Cells& rival, const Cells& ours) {
  return ratio(rival, ours, [](const PictureCell& c) { return c.timed.error.trimmed * c.timed.seconds; });
}
Estimate ratio_at_samples(const Cells& rival, const Cells& ours) {
  return ratio(rival, ours, [](const PictureCell& c) { return c.equal.error.trimmed; });
}
Estimate ratio_of_time(const Cells& rival, const Cells& ours) {
  return ratio(rival, ours, [](const PictureCell& c) { return c.equal.seconds; });
}

bool is_demanded(const Against& a) { return a.rival == "cosine" || a.rival == "proxy"; }

bool is_loss(const Estimate& ratio) { return ratio.value + noise_of(ratio) < 1; }

bool demand_holds(const Verdict& v) { return v.half_within_reach && (v.best_in_mean || v.means.empty()); }

Verdict judge(const Results& results, const std::vector<std::string>& methods, const std::string& ours) {
  Verdict v;
  v.ours = ours;
  for (const std::string& method : methods) {
    for (const std::string& scene : names(results, method, [](const PictureCell& c) { return c.scene; })) {
      const Cells one_shot = results.of(scene, method, ours), exact = results.of(scene, method, "exact");
      if (one_shot.empty()) continue;
      for (const SamplerInfo& info : samplers()) {
        if (study::is_ours(info) || info.name == ours) continue;
        const Cells rival = results.of(scene, method, info.name);
        if (rival.empty()) continue;
        Against a{scene, method, std::string(info.name), info.general, {}, {}, {}, {}, Half::missed};
        a.one_shot = ratio_at_time(rival, one_shot), a.exact = ratio_at_time(rival, exact);
        a.samples = ratio_at_samples(rival, one_shot), a.ideal = ratio_at_samples(rival, exact);
        a.half = half_of(a);
        v.against.push_back(a);
      }
    }
    for (const SamplerInfo& info : samplers()) {
      const Mean m = mean_over_scenes(v.against, method, std::string(info.name));
      if (info.general && m.scenes > 0) v.means.push_back(m);
    }
  }
  v.best_in_mean = !v.means.empty();
  for (const Mean& m : v.means) v.best_in_mean = v.best_in_mean && !is_loss(m.one_shot);
  v.half_everywhere = v.half_within_reach = !v.against.empty();
  for (const Against& a : v.against) {
    if (!is_demanded(a)) continue;
    v.half_everywhere = v.half_everywhere && a.half == Half::reached;
    v.half_within_reach = v.half_within_reach && a.half != Half::missed && !is_loss(a.one_shot);
  }
  return v;
}

}  // namespace reflectree::pictures
