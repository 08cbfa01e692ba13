// SPDX-License-Identifier: Apache-2.0
#include "doctor_explanations.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <optional>

#include "doctor_hypotheses.hpp"
#include "reflectree/verify/bin_masses.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree::detail {
namespace {

using Masses = std::vector<double>;

Vec3<double> widen(Direction w) { return {double(w.x), double(w.y), double(w.z)}; }
Direction narrow(Vec3<double> w) { return {float(w.x), float(w.y), float(w.z)}; }

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char buffer[240];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

double sum(const Masses& m) { return std::accumulate(m.begin(), m.end(), 0.); }
double drawn_share(const ExaminedView& v) { return double(v.wi.size()) / v.draws; }

class Search {
 public:
  Search(const Functions& f, std::span<const ExaminedView> views, double level, const Host& host)
      : f_(f), views_(views), level_(level), host_(host) {
    for (const ExaminedView& v : views_) unexplained_ += fit_of(v, v.pdf_mass, true).statistic;
  }

  Explanation run(bool shape_holds) {
    Explanation best = named(shape_holds);
    for (const auto step : {&Search::normalised, &Search::absolute, &Search::cut, &Search::half,
                            &Search::mixture, &Search::clipped, &Search::turned, &Search::shifted}) {
      if (!best.cause.empty()) return best;
      if (shape_holds && step != &Search::normalised) break;  // of these none keeps the shape
      if (host_.cancelled()) throw Cancelled();
      best = (this->*step)();
    }
    return best;
  }

 private:
  bool fits(const Fit& fit) const { return fit.p_value >= level_; }
  bool total_fits(const ExaminedView& v, double total) const {
    return std::abs(total + v.lost / v.draws + v.below / v.draws - 1) <=
           integral_tolerance(v, normal_two_sided_quantile(level_));
  }
  // The masses of pdf, reweighted by the sums over the nodes of a bin: errors of the nodes cancel.
  template <class At>
  Masses reweighted(const ExaminedView& v, const Masses& of, const std::vector<double>& at,
                    const At& changed) const {
    Masses before(of.size()), after(of.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double here = v.nodes.solid_angle[i] * at[i];
      before[v.nodes.bin[i]] += here;
      after[v.nodes.bin[i]] += v.nodes.solid_angle[i] * changed(i);
    }
    for (std::size_t b = 0; b < of.size(); ++b) {
      const double ratio = before[b] > 0 ? of[b] / before[b] : 1;
      if (ratio > 0.8 && ratio < 1.25) after[b] *= ratio;  // beyond, the masses themselves are in doubt
    }
    return after;
  }
  static Masses normalised_to(Masses m, double total) {
    const double scale = sum(m) > 0 ? total / sum(m) : 0;
    for (double& x : m) x *= scale;
    return m;
  }
  // Every view, or nothing. masses(view) as the hypothesis has them; the total counts where `absolute`.
  template <class Of>
  std::optional<double> statistic(const Of& masses, bool absolute) const {
    double total = 0;
    for (const ExaminedView& v : views_) {
      if (v.wi.empty()) continue;
      const Masses m = masses(v);
      const Fit fit = fit_of(v, m, true);
      if (!fits(fit) || (absolute && !total_fits(v, sum(m)))) return std::nullopt;
      total += fit.statistic;
    }
    return total;
  }

  // 1. Transformations with a name. Of directions: undone on what was drawn, whose bins are then pdf's.
  Masses masses_of(const DensityHypothesis& h, const ExaminedView& v) const {
    TargetFunction density;
    density.concurrent = f_.patient().concurrent;
    density.eval = [&](Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> out) {
      Directions a, b;
      for (const auto& w : wi) {
        const DirectionPair p = h.turn ? h.turn({wo, w}) : DirectionPair{wo, w};
        a.push_back(narrow(p.wo)), b.push_back(narrow(p.wi));
      }
      const std::vector<double> pdf = f_.pdf(a, b);
      for (std::size_t i = 0; i < wi.size(); ++i) {
        const double factor = h.factor ? h.factor({wo, wi[i]}) : 1;
        out[i] = wi[i].z > 0 ? sane_or_zero(pdf[i] * factor) / wi[i].z : 0;
      }
    };
    return function_masses(density, v.bins, 1e-3, host_).mass;
  }
  template <class Turn>
  ExaminedView recounted(const ExaminedView& v, const Turn& turn) const {
    ExaminedView r = v;
    std::fill(r.count.begin(), r.count.end(), 0.);
    const Vec3<double> wo = widen(v.wo);
    for (const Direction w : v.wi) ++r.count[v.bins.find(narrow(turn({wo, widen(w)}).wi))];
    return r;
  }
  std::optional<double> judge(const DensityHypothesis& h) const {
    double total = 0;
    for (const ExaminedView& v : views_) {
      if (v.wi.empty()) continue;
      Fit fit;
      double integral = v.pdf_integral;
      const Vec3<double> wo = widen(v.wo);
      const bool turns_wi = h.turn && h.turn({wo, {0, 0, 1}}).wo == wo;
      if (turns_wi) {
        fit = fit_of(recounted(v, h.turn), v.pdf_mass, true);
      } else {
        Masses m;
        if (!h.turn) {
          m = reweighted(v, v.pdf_mass, v.pdf_at, [&](std::size_t i) {
            return v.pdf_at[i] * h.factor({wo, widen(v.nodes.wi[i])});
          });
          fit = fit_of(v, m, true);
          if (fit.statistic > 30 * fit.dof) return std::nullopt;
        }
        // The nodes are rough; what they do not rule out is integrated well.
        if (h.turn || !fits(fit) || !total_fits(v, sum(m))) m = masses_of(h, v);
        fit = fit_of(v, m, true);
        integral = sum(m);
      }
      if (!fits(fit) || !total_fits(v, integral)) return std::nullopt;
      total += fit.statistic;
    }
    return total;
  }
  Explanation named(bool shape_holds) const {
    const DensityHypothesis* best = nullptr;
    double least = 0;
    for (const DensityHypothesis& h : density_hypotheses()) {
      if (shape_holds && h.turn) continue;
      const auto s = judge(h);
      // Clearly better than pdf itself, and a later one than those before.
      if (!s || (!shape_holds && *s > unexplained_ - 30)) continue;
      if (!best || *s < least - 30) best = &h, least = *s;
    }
    if (!best) return {};
    Explanation e{best->cause, best->words, {}};
    if (best->turn && std::string_view(best->cause).starts_with("pdf") == false) e.words += blame(*best);
    e.truth = [f = f_, h = *best](std::span<const Direction> wo, std::span<const Direction> wi) {
      Directions a(wo.begin(), wo.end()), b(wi.begin(), wi.end());
      for (std::size_t i = 0; h.turn && i < a.size(); ++i) {
        const DirectionPair p = h.turn({widen(wo[i]), widen(wi[i])});
        a[i] = narrow(p.wo), b[i] = narrow(p.wi);
      }
      std::vector<double> pdf = f.pdf(a, b);
      for (std::size_t i = 0; h.factor && i < a.size(); ++i) pdf[i] *= h.factor({widen(wo[i]), widen(wi[i])});
      return pdf;
    };
    return e;
  }
  // Which of the two is off, by which of them is more like f.
  std::string blame(const DensityHypothesis&) const {
    double of_pdf = 0, of_draws = 0;
    for (const ExaminedView& v : views_) {
      for (std::size_t b = 0; b < v.count.size(); ++b) {
        const double like_f = v.albedo > 0 ? v.f_mass[b] / v.albedo : 0;
        of_pdf += std::min(like_f, v.pdf_mass[b]);
        of_draws += std::min(like_f, v.count[b] / v.draws);
      }
    }
    if (std::abs(of_pdf - of_draws) < 0.02 * double(views_.size())) return "";
    return of_pdf > of_draws ? "; f is like pdf, so the directions are off"
                             : "; f is like the directions, so pdf is off";
  }

  // 2. The shape is right and the total is not, by a factor that is always the same, or not.
  Explanation normalised() const {
    std::vector<double> factor;
    double least_integral = 1e9, most_integral = 0;
    for (const ExaminedView& v : views_) {
      if (v.wi.empty()) continue;
      if (!fits(fit_of(v, v.pdf_mass, true))) return {};
      factor.push_back(v.pdf_integral / (1 - (v.lost + v.below) / v.draws));
      least_integral = std::min(least_integral, v.pdf_integral),
      most_integral = std::max(most_integral, v.pdf_integral);
    }
    if (factor.empty()) return {};
    const auto [least, most] = std::minmax_element(factor.begin(), factor.end());
    const double middle = 0.5 * (*least + *most);
    Explanation e;
    if (*most - *least < 0.008 * middle) {
      const std::string name = name_of_factor(middle, 2e-3);
      e.cause = "pdf_scaled";
      e.words = name.empty() ? text("the pdf is the density times %.4g: it does not integrate to 1", middle)
                             : "the pdf is the density times " + name + ": it does not integrate to 1";
      e.truth = [f = f_, middle](std::span<const Direction> wo, std::span<const Direction> wi) {
        std::vector<double> pdf = f.pdf(wo, wi);
        for (double& p : pdf) p /= middle;
        return pdf;
      };
      return e;
    }
    if (*most < 1.003) {
      const double missing = 1 - *least, below = most_below(*least);
      e.cause = "below_horizon";
      e.words = text(
          "up to %.2g %% of the density lies below the horizon: directions there are drawn again, and the "
          "pdf does not know",
          100 * missing);
      if (below > 0) e.words += text(" (where pdf gives %.2g %%)", 100 * below);
      return e;
    }
    e.cause = "pdf_normalisation";
    e.words = text("the pdf has the shape of the density and integrates to %.4g to %.4g, depending on wo",
                   least_integral, most_integral);
    return e;
  }
  // The integral of pdf below the horizon for the viewer whose integral above is least.
  double most_below(double) const {
    const ExaminedView* at = nullptr;
    for (const ExaminedView& v : views_) {
      if (!v.wi.empty() && (!at || v.pdf_integral < at->pdf_integral)) at = &v;
    }
    constexpr int nz = 200, nphi = 300;
    Directions wi;
    for (int i = 0; i < nz; ++i) {
      const double z = -(i + 0.5) / nz, r = std::sqrt(1 - z * z);
      for (int k = 0; k < nphi; ++k) {
        const double phi = 2 * pi_v<double> * (k + 0.5) / nphi;
        wi.push_back({float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)});
      }
    }
    double total = 0;
    for (const double p : f_.pdf(Directions(wi.size(), at->wo), wi)) total += sane_or_zero(p);
    return total * 2 * pi_v<double> / double(wi.size());
  }

  // 3. Densities of their own: that of f, with and without cosine, a cosine lobe, uniform.
  Masses known(const ExaminedView& v, bool cosine) const {
    TargetFunction t;
    t.eval = [cosine](Vec3<double>, std::span<const Vec3<double>> wi, std::span<double> out) {
      for (std::size_t i = 0; i < wi.size(); ++i) {
        out[i] = cosine ? 1 / pi_v<double> : 0.5 / pi_v<double> / std::max(wi[i].z, 1e-12);
      }
    };
    return function_masses(t, v.bins, 1e-3, host_).mass;
  }
  Explanation absolute() const {
    const auto like_f = [&](const ExaminedView& v) { return normalised_to(v.f_mass, drawn_share(v)); };
    if (statistic(like_f, false)) {
      return {"draws_f_cos", "directions follow f cos_theta_i exactly, and pdf says something else", nullptr};
    }
    const auto without = [&](const ExaminedView& v) {
      return normalised_to(
          reweighted(v, v.f_mass, v.f_cos_at,
                     [&](std::size_t i) { return v.f_cos_at[i] / std::max(double(v.nodes.wi[i].z), 1e-9); }),
          drawn_share(v));
    };
    if (statistic(without, false)) {
      return {"draws_f", "directions follow f without its cosine, and pdf says something else", nullptr};
    }
    for (const bool cosine : {true, false}) {
      if (!statistic([&](const ExaminedView& v) { return normalised_to(known(v, cosine), drawn_share(v)); },
                     false))
        continue;
      return {cosine ? "draws_cosine" : "draws_uniform",
              cosine ? "directions follow a cosine lobe whatever pdf says: its other lobes are never drawn"
                     : "directions are uniform whatever pdf says: its lobes are never drawn",
              [cosine](std::span<const Direction> wo, std::span<const Direction> wi) {
                std::vector<double> p(wo.size());
                for (std::size_t i = 0; i < p.size(); ++i)
                  p[i] = cosine ? double(wi[i].z) / pi_v<double> : 0.5 / pi_v<double>;
                return p;
              }};
    }
    return {};
  }

  // 4. Directions next to the horizon are never drawn.
  Explanation cut() const {
    double lowest = 1;
    for (const ExaminedView& v : views_) {
      for (const Direction w : v.wi) lowest = std::min(lowest, double(w.z));
    }
    double most = 0;
    const auto above = [&](const ExaminedView& v) {
      Masses m = reweighted(v, v.pdf_mass, v.pdf_at, [&](std::size_t i) {
        return double(v.nodes.wi[i].z) >= lowest ? v.pdf_at[i] : 0;
      });
      most = std::max(most, v.pdf_integral - sum(m));
      return normalised_to(std::move(m), drawn_share(v));
    };
    // Bins that straddle the border are known to a node's width only.
    double worst = 0;
    for (const ExaminedView& v : views_) {
      if (v.wi.empty()) continue;
      const Fit fit = fit_of(v, merged_at(v, above(v), lowest), true);
      worst = std::max(worst, fit.p_value >= level_ ? 0. : 1.);
    }
    if (worst > 0 || !(most > 3e-4)) return {};
    return {"grazing_never",
            text("directions with cos_theta_i below %.3g are never drawn, where pdf has up to %.2g %%",
                 lowest, 100 * most),
            nullptr};
  }
  // The masses with straddling bins set to what was counted, so that they decide nothing.
  Masses merged_at(const ExaminedView& v, Masses m, double z) const {
    std::vector<double> lo(m.size(), 2), hi(m.size(), -1);
    for (std::size_t i = 0; i < v.nodes.wi.size(); ++i) {
      const std::size_t b = v.nodes.bin[i];
      lo[b] = std::min(lo[b], double(v.nodes.wi[i].z)), hi[b] = std::max(hi[b], double(v.nodes.wi[i].z));
    }
    for (std::size_t b = 0; b < m.size(); ++b) {
      const double slack = 0.1 * (hi[b] - lo[b]) + 1e-6;
      if (lo[b] - slack < z && z < hi[b] + slack) m[b] = v.count[b] / v.draws;
    }
    return m;
  }

  // 5. One half of the half vectors is missing, as where atan loses the quadrant.
  Explanation half() const {
    constexpr const char* sides[] = {"x > 0", "x < 0", "y > 0", "y < 0"};
    for (int side = 0; side < 4; ++side) {
      const auto on = [&](Vec3<double> wo, Direction d) {
        const Vec3<double> h = wo + widen(d);
        return side == 0 ? h.x > 0 : side == 1 ? h.x < 0 : side == 2 ? h.y > 0 : h.y < 0;
      };
      double off = 0, expected_off = 0, all = 0;
      for (const ExaminedView& v : views_) {
        const Vec3<double> wo = widen(v.wo);
        for (const Direction w : v.wi) off += !on(wo, w), ++all;
        for (std::size_t i = 0; i < v.pdf_at.size(); ++i) {
          if (!on(wo, v.nodes.wi[i])) expected_off += v.pdf_at[i] * v.nodes.solid_angle[i] * v.draws;
        }
      }
      if (off > 0.002 * all || expected_off < 0.1 * all) continue;
      return {"half_lobe",
              std::string("only half vectors with ") + sides[side] +
                  " are drawn: half of the lobe is lost, as where atan forgets the quadrant of phi",
              nullptr};
    }
    return {};
  }

  // 6. pdf is a lobe s and a cosine lobe c, p = w c + (1 - w) s; drawn with another weight it is a p + b c.
  Explanation mixture() const {
    for (const bool cosine : {true, false}) {
      std::vector<std::array<double, 3>> found;  // a, b, least ratio of the truth to pdf
      bool all = true;
      for (const ExaminedView& v : views_) {
        if (v.wi.empty()) continue;
        const Masses c = known(v, cosine);
        double pp = 0, pc = 0, cc = 0, py = 0, cy = 0;
        for (int round = 0, rounds = 4; round < rounds; ++round) {
          const double a0 = round ? found.back()[0] : 1, b0 = round ? found.back()[1] : 0;
          pp = pc = cc = py = cy = 0;
          for (std::size_t i = 0; i < c.size(); ++i) {
            const double p = v.pdf_mass[i], y = v.count[i] / v.draws;
            const double variance = std::max({a0 * p + b0 * c[i], 0.02 * p, 5 / v.draws});
            pp += p * p / variance, pc += p * c[i] / variance, cc += c[i] * c[i] / variance;
            py += p * y / variance, cy += c[i] * y / variance;
          }
          const double determinant = pp * cc - pc * pc;
          if (!(determinant > 1e-12 * pp * cc)) break;
          if (round) found.pop_back();
          found.push_back({(py * cc - cy * pc) / determinant, (cy * pp - py * pc) / determinant, 0});
        }
        if (!(pp * cc - pc * pc > 1e-12 * pp * cc)) {
          all = false;
          break;
        }
        Masses m(c.size());
        double least = 1e9;
        for (std::size_t i = 0; i < c.size(); ++i) {
          m[i] = std::max(found.back()[0] * v.pdf_mass[i] + found.back()[1] * c[i], 0.);
          if (v.pdf_mass[i] * v.draws > 50) least = std::min(least, m[i] / v.pdf_mass[i]);
          if (m[i] < 0.01 * v.pdf_mass[i])
            m[i] = std::max(m[i], v.count[i] / v.draws < 0.03 * v.pdf_mass[i] ? v.count[i] / v.draws : m[i]);
        }
        found.back()[2] = least;
        if (!fits(fit_of(v, m, true))) {
          all = false;
          break;
        }
      }
      if (!all || found.empty()) continue;
      const char* lobe = cosine ? "cosine lobe" : "uniform lobe";
      double a = 0, b = 0, ratio = 1e9;
      for (const auto& x : found)
        a += x[0] / double(found.size()), b += x[1] / double(found.size()), ratio = std::min(ratio, x[2]);
      double integral = 0;
      for (const ExaminedView& v : views_) integral += v.pdf_integral / double(views_.size());
      if (b > 0 && integral < 0.99 && std::abs(a - 1) < 0.03) {
        return {"pdf_drops_lobe",
                std::string("the pdf leaves out a ") + lobe +
                    text(", to which %.3g %% of the directions belong", 100 * b),
                mix(a, b, cosine, found)};
      }
      if (b > 0 && a < 1 && integral > 0.99 && std::abs(a + b - 1) > 0.03) continue;
      if (b < 0 && ratio < 0.25) {
        return {"dropped_lobe",
                std::string("the ") + lobe +
                    text(" that pdf counts with %.3g %% is never drawn, or hardly ever", 100 * -b / a),
                mix(a, b, cosine, found)};
      }
      return {"mixture_weight",
              std::string("a mixture is drawn with other weights than pdf has: ") +
                  (b < 0 ? std::string("the ") + lobe + text(" %.3g times as often", ratio)
                         : std::string("lobes other than the ") + lobe + text(" %.3g times as often", a)),
              mix(a, b, cosine, found)};
    }
    return {};
  }
  // The truth as a formula, where the weights are the same for all viewers.
  std::function<std::vector<double>(std::span<const Direction>, std::span<const Direction>)> mix(
      double a, double b, bool cosine, const std::vector<std::array<double, 3>>& found) const {
    for (const auto& x : found) {
      if (std::abs(x[0] - a) > 0.02 * std::abs(a)) return nullptr;
    }
    return [f = f_, a, b, cosine](std::span<const Direction> wo, std::span<const Direction> wi) {
      std::vector<double> p = f.pdf(wo, wi);
      for (std::size_t i = 0; i < p.size(); ++i) {
        p[i] = std::max(a * p[i] + b * (cosine ? double(wi[i].z) / pi_v<double> : 0.5 / pi_v<double>), 0.);
      }
      return p;
    };
  }

  // 7. Rejection from a cosine lobe, or uniform, under a bound that is too low: min(p, bound * q).
  Explanation clipped() const {
    for (const bool cosine : {false, true}) {
      double most_lost = 0;
      bool all = true, any = false;
      for (const ExaminedView& v : views_) {
        if (v.wi.empty()) continue;
        const auto q = [&](std::size_t i) { return cosine ? double(v.nodes.wi[i].z) : 1.; };
        double highest = 0;
        for (std::size_t i = 0; i < v.pdf_at.size(); ++i)
          highest = std::max(highest, v.pdf_at[i] / std::max(q(i), 1e-6));
        const auto masses = [&](double bound) {
          return normalised_to(reweighted(v, v.pdf_mass, v.pdf_at,
                                          [&](std::size_t i) { return std::min(v.pdf_at[i], bound * q(i)); }),
                               drawn_share(v));
        };
        double best = highest, least = fit_of(v, v.pdf_mass, true).statistic;
        for (double bound = highest, step = 1.25; step > 1.002; step = std::sqrt(step)) {
          for (int k = -12; k <= 12; ++k) {
            const double here = bound * std::pow(step, k);
            const double s = fit_of(v, masses(here), true).statistic;
            if (s < least) least = s, best = here;
          }
          bound = best;
        }
        if (!fits(fit_of(v, masses(best), true))) {
          all = false;
          break;
        }
        if (best < 0.95 * highest) any = true;
        double cut = 0;
        for (std::size_t i = 0; i < v.pdf_at.size(); ++i)
          cut += v.nodes.solid_angle[i] * std::max(v.pdf_at[i] - best * q(i), 0.);
        most_lost = std::max(most_lost, cut);
      }
      if (!all || !any) continue;
      return {"bound_too_low",
              text("the density is cut off where pdf is highest: a bound of rejection is too low, up to %.2g "
                   "%% of pdf lie above it",
                   100 * most_lost),
              nullptr};
    }
    return {};
  }

  // 8. pdf turned about the normal by any angle; 9. shifted along an elevation. Angle or shift by maximum
  // likelihood over some draws, then judged by all of them.
  template <class Move>
  double likelihood(const Move& move, double x, std::size_t most, bool of_disk) const {
    Directions wo, wi;
    for (const ExaminedView& v : views_) {
      for (std::size_t i = 0; i < std::min(most, v.wi.size()); ++i) {
        wo.push_back(v.wo), wi.push_back(narrow(move(widen(v.wi[i]), x)));
      }
    }
    const std::vector<double> pdf = f_.pdf(wo, wi);
    double total = 0;
    for (std::size_t i = 0; i < pdf.size(); ++i) {
      const double measure = of_disk ? std::max(double(wi[i].z), 1e-4) : 1;
      total += std::log(std::max(sane_or_zero(pdf[i]) / measure, 1e-6));
    }
    return total;
  }
  template <class Move>
  std::optional<double> moved_by(const Move& move, double from, double to, int steps,
                                 bool of_disk = false) const {
    double best = 0, most = -1e300, width = (to - from) / steps;
    for (int k = 0; k < steps; ++k) {
      const double x = from + width * (k + 0.5), l = likelihood(move, x, 200, of_disk);
      if (l > most) most = l, best = x;
    }
    for (const std::size_t draws : {400, 4000, 20'000}) {
      most = -1e300;
      const double centre = best;
      for (int k = -8; k <= 8; ++k) {
        const double x = centre + width * k / 8, l = likelihood(move, x, draws, of_disk);
        if (l > most) most = l, best = x;
      }
      width *= draws == 400 ? 0.3 : 0.2;
    }
    for (const ExaminedView& v : views_) {
      if (v.wi.empty()) continue;
      const ExaminedView r = recounted(v, [&](DirectionPair p) {
        return DirectionPair{p.wo, move(p.wi, best)};
      });
      if (!fits(fit_of(r, v.pdf_mass, true)) || !total_fits(v, v.pdf_integral)) return std::nullopt;
    }
    return best;
  }
  static Vec3<double> turn_by(Vec3<double> w, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
  }
  Explanation turned() const {
    const auto angle = moved_by(turn_by, -pi_v<double>, pi_v<double>, 360);
    if (!angle || std::abs(*angle) < 1e-3) return {};
    // Directions were turned by -angle.
    double off = std::remainder(-*angle, 2 * pi_v<double>);
    for (int a = -180; a <= 180; a += 5) {
      const double confused = std::remainder(double(a) - a * pi_v<double> / 180, 2 * pi_v<double>);
      if (a != 0 && std::abs(std::remainder(confused - off, 2 * pi_v<double>)) < 0.004) {
        return {"degrees_for_radians",
                text("directions are turned by %.4g degrees against pdf, which is %.0f radians in the place "
                     "of %.0f degrees",
                     degrees(off), a, a),
                nullptr};
      }
    }
    std::string words = text("directions are turned by %.4g degrees against pdf", degrees(off));
    const double cells = 2 * pi_v<double> / std::abs(off);
    if (cells > 7.5 && std::abs(cells - std::round(cells)) < 0.02 * cells) {
      words +=
          text(": 1/%.0f of a turn, an index off by one in a table of as many cells?", std::round(cells));
      return {"table_off_by_one", words, nullptr};
    }
    return {"azimuth_turned", words, nullptr};
  }
  Explanation shifted() const {
    // r^2 + s and z + s, both modulo 1.
    const auto squared = [](Vec3<double> w, double s) {
      const double r2 = sqr(w.x) + sqr(w.y), to = r2 + s - std::floor(r2 + s),
                   scale = std::sqrt(to / std::max(r2, 1e-12));
      return Vec3<double>{scale * w.x, scale * w.y, std::sqrt(std::max(1 - to, 0.))};
    };
    const auto cosine = [](Vec3<double> w, double s) {
      const double z = w.z + s - std::floor(w.z + s),
                   scale = std::sqrt((1 - z * z) / std::max(1 - w.z * w.z, 1e-12));
      return Vec3<double>{scale * w.x, scale * w.y, z};
    };
    // The first keeps areas of the disk, the second solid angles; densities are compared in the same measure.
    const auto a = moved_by(squared, -0.25, 0.25, 400, true);
    const auto b = a ? std::nullopt : moved_by(cosine, -0.25, 0.25, 400);
    if (!a && !b) return {};
    const double s = a ? *a : *b;
    return {"table_off_by_one",
            text(a ? "directions and pdf differ by %.4g in sin^2 theta_i, 1/%.0f of its range: an index off "
                     "by one in a table?"
                   : "directions and pdf differ by %.4g in cos_theta_i, 1/%.0f of its range: an index off by "
                     "one in a table?",
                 s, std::round(1 / std::abs(s))),
            nullptr};
  }

  const Functions& f_;
  std::span<const ExaminedView> views_;
  double level_;
  const Host& host_;
  double unexplained_ = 0;  // chi-square of pdf as it is
};

}  // namespace

Explanation explain_density(const Functions& f, std::span<const ExaminedView> views, bool shape_holds,
                            double level, const Host& host) {
  return Search(f, views, level, host).run(shape_holds);
}

}  // namespace reflectree::detail
