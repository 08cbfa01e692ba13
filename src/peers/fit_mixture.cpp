// SPDX-License-Identifier: Apache-2.0
// The quadrature points come from all candidate lobes at once (balance heuristic, Veach 1997), so that no
// candidate has a peak that another's points miss.
#include "reflectree/peers/fit_mixture.hpp"

#include <cmath>

namespace reflectree {

namespace {

struct Candidates {
  std::vector<ProposalLobe> lobes;
  std::vector<double> cosine_weights;
};

Candidates candidates(const FitOptions& o) {
  Candidates c;
  for (int i = 0; i < o.widths; ++i) {
    const double alpha = 0.002 * std::pow(500.0, double(i) / (o.widths - 1));
    const double a = o.lobe == LobeKind::power ? 2 / (alpha * alpha) - 2 : alpha;
    c.lobes.push_back({o.lobe, float(a), float(a)});
  }
  for (int i = 0; i < o.weights; ++i) {
    const double s = std::sin(pi_v<double> / 2 * double(i) / (o.weights - 1));
    c.cosine_weights.push_back(0.005 + 0.99 * s * s);
  }
  return c;
}

// log(1 + relVar) for each width and weight at one elevation; empty where the target is zero.
std::vector<double> losses(const AnyBrdf& f, Target target, const FitOptions& o, const Candidates& c,
                           std::size_t row) {
  const double theta = row_theta_o(row, std::size_t(o.thetas));
  const Direction wo{float(std::sin(theta)), 0, float(std::cos(theta))};
  const ProposalLobe cosine;
  UniformBits u(Pcg32(o.seed, row));
  const std::size_t n = c.lobes.size();
  std::vector<Direction> wi;
  for (std::size_t i = 0; i <= n; ++i) {
    for (int k = 0; k < o.points_a_width; ++k) {
      if (const auto w = (i < n ? c.lobes[i] : cosine).sample(wo, u)) wi.push_back(*w);
    }
  }
  const std::vector<Direction> wos(wi.size(), wo);
  const auto channels = std::size_t(f.channels());
  std::vector<float> values(wi.size() * channels), pdfs(wi.size() * n);
  f.eval(wos, wi, values);
  std::vector<double> square(wi.size());  // T^2 over the density of the points
  double total = 0;
  for (std::size_t k = 0; k < wi.size(); ++k) {
    double q = double(cosine.pdf(wo, wi[k]));
    for (std::size_t i = 0; i < n; ++i) q += double(pdfs[k * n + i] = c.lobes[i].pdf(wo, wi[k]));
    q *= o.points_a_width;
    const double t = double(target(&values[k * channels], int(channels))) * double(wi[k].z);
    if (!(q > 0 && std::isfinite(q) && std::isfinite(t))) continue;
    square[k] = t * t / q, total += t / q;
  }
  if (!(total > 0)) return {};
  std::vector<double> loss;
  for (std::size_t i = 0; i < n; ++i) {
    for (const double w : c.cosine_weights) {
      double moment = 0;
      for (std::size_t k = 0; k < wi.size(); ++k) {
        if (square[k] > 0)
          moment += square[k] / (w * double(wi[k].z) / pi_v<double> + (1 - w) * double(pdfs[k * n + i]));
      }
      loss.push_back(std::log(moment / (total * total)));
    }
  }
  return loss;
}

std::vector<WeightedLobe> best(const std::vector<double>& loss, const Candidates& c) {
  if (loss.empty()) return {{1, ProposalLobe{}}};
  const auto at = std::size_t(std::min_element(loss.begin(), loss.end()) - loss.begin());
  const auto w = float(c.cosine_weights[at % c.cosine_weights.size()]);
  return {{w, ProposalLobe{}}, {1 - w, c.lobes[at / c.cosine_weights.size()]}};
}

}  // namespace

LobeMixture fit_mixture(const AnyBrdf& f, Target target, const FitOptions& o, const Host& host) {
  const Candidates c = candidates(o);
  std::vector<std::vector<double>> loss(std::size_t(o.thetas));
  const auto work = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) loss[i] = losses(f, target, o, c, i);
  };
  if (f.traits().concurrent) {
    host.parallel_for(loss.size(), work);
  } else {
    work(0, loss.size());
  }
  LobeMixture mixture;
  if (o.each_theta) {
    for (const auto& l : loss) mixture.rows.push_back(best(l, c));
    return mixture;
  }
  std::vector<double> sum;
  for (const auto& l : loss) {
    sum.resize(std::max(sum.size(), l.size()));
    for (std::size_t i = 0; i < l.size(); ++i) sum[i] += l[i];
  }
  mixture.rows.push_back(best(sum, c));
  return mixture;
}

}  // namespace reflectree
