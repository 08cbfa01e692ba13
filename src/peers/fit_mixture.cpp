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

std::vector<double> cosine_weights(const FitOptions& o) {
  std::vector<double> weights;
  for (int i = 0; i < o.weights; ++i) {
    const double s = std::sin(pi_v<double> / 2 * double(i) / (o.weights - 1));
    weights.push_back(0.005 + 0.99 * s * s);
  }
  return weights;
}

Candidates round_candidates(const FitOptions& o) {
  Candidates c{{}, cosine_weights(o)};
  for (int i = 0; i < o.widths; ++i) {
    const double alpha = 0.002 * std::pow(500.0, double(i) / (o.widths - 1));
    const double a = o.lobe == LobeKind::power ? 2 / (alpha * alpha) - 2 : alpha;
    c.lobes.push_back({o.lobe, float(a), float(a)});
  }
  return c;
}

// About a lobe, `side` widths along either axis, each `ratio` times the one before.
Candidates elliptic_candidates(const FitOptions& o, const ProposalLobe& centre, int side, double ratio) {
  Candidates c{{}, cosine_weights(o)};
  const auto width = [&](float middle, int i) {
    return float(std::clamp(double(middle) * std::pow(ratio, i - 0.5 * (side - 1)), 0.002, 1.0));
  };
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      ProposalLobe lobe = centre;
      lobe.a = width(centre.a, i), lobe.b = width(centre.b, k);
      c.lobes.push_back(lobe);
    }
  }
  return c;
}

// The directions wo that are looked at, by elevation, then azimuth.
Direction viewer(const FitOptions& o, std::size_t row, std::size_t azimuths, float axis) {
  const double theta = row_theta_o(row / azimuths, std::size_t(o.thetas));
  const Direction wo{float(std::sin(theta)), 0, float(std::cos(theta))};
  if (azimuths == 1) return wo;
  const double phi = double(axis) + (double(row % azimuths) + 0.5) / double(azimuths) * pi_v<double>;
  return {float(std::cos(phi)) * wo.x, float(std::sin(phi)) * wo.x, wo.z};
}

// log(1 + relVar) for each width and weight at one wo; empty where the target is zero.
std::vector<double> losses(const AnyBrdf& f, Target target, const FitOptions& o, const Candidates& c,
                           std::size_t row, Direction wo) {
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
  const bool isotropic = f.traits().isotropic, elliptic = !isotropic && o.lobe != LobeKind::power;
  const float axis = f.traits().axis.value_or(0.f);
  const std::size_t azimuths = isotropic ? 1 : std::size_t(o.azimuths);
  // The mixture for elevations [first, last): the sum of the losses decides.
  const auto fit = [&](std::size_t first, std::size_t last, const Candidates& c, const Host& threads) {
    std::vector<std::vector<double>> loss((last - first) * azimuths);
    threads.parallel_for(loss.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t row = first * azimuths + i;
        loss[i] = losses(f, target, o, c, row, viewer(o, row, azimuths, axis));
      }
    });
    std::vector<double> sum;
    for (const auto& l : loss) {
      sum.resize(std::max(sum.size(), l.size()));
      for (std::size_t i = 0; i < l.size(); ++i) sum[i] += l[i];
    }
    return best(sum, c);
  };
  const auto fit_row = [&](std::size_t first, std::size_t last, const Host& threads) {
    if (!elliptic) return fit(first, last, round_candidates(o), threads);
    // 10 x 10 widths from 0.004 to 1, then 5 x 5 between the neighbours of the best.
    const ProposalLobe middle{o.lobe, 0.063f, 0.063f, {}, Azimuth(axis * 180 / pi)};
    const auto coarse = fit(first, last, elliptic_candidates(o, middle, 10, 1.85), threads);
    if (coarse.size() < 2) return coarse;
    return fit(first, last, elliptic_candidates(o, coarse[1].lobe, 5, 1.36), threads);
  };
  const Host serial;
  const Host& threads = f.traits().concurrent ? host : serial;
  LobeMixture mixture;
  const auto rows = std::size_t(o.thetas);
  if (!o.each_theta) {
    mixture.rows.push_back(fit_row(0, rows, threads));
    return mixture;
  }
  mixture.rows.resize(rows);
  threads.parallel_for(rows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mixture.rows[i] = fit_row(i, i + 1, serial);
  });
  return mixture;
}

}  // namespace reflectree
