// SPDX-License-Identifier: Apache-2.0
#include "over_elevation.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "integrals.hpp"
#include "panels.hpp"
#include "reflectree/math/genz_malik.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

namespace {

// The table under construction: panels, the integrals at their nodes, and the error that all are content with.
class TableBuilder {
 public:
  TableBuilder(const Field& field, float phi_o, const Coordinates& at, float relative_error,
               const Jumps& jumps, const Host& host, Effort& effort, std::uint64_t budget)
      : field_(field),
        phi_o_(phi_o),
        at_(at),
        host_(host),
        effort_(effort),
        asked_(double(relative_error)),
        error_(asked_),
        known_(field.f.traits().theta_o_factor),
        told_(field.family ? nullptr : field.f.traits().albedo),
        start_(effort.evaluations),
        budget_(budget),
        max_regions_(std::size_t(clamp(double(budget) / (15 * double(genz_malik_points)), 400., 40000.))),
        apart_{0, effort.limit},
        fine_(field.marks != nullptr),
        rim_(!field.frame.isotropic() || field.family) {
    if (!field.frame.isotropic()) cells_x_ = 12, cells_y_ = 6;
    if (fine_) cells_x_ = 48, cells_y_ = 24;
    std::vector<double> borders = first_borders(field.f.traits());
    for (const ThetaJump& jump : jumps.theta_o) borders.push_back(jump.before), borders.push_back(jump.after);
    std::sort(borders.begin(), borders.end());
    borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
    first_ = borders.front();
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
      const bool jump = std::any_of(jumps.theta_o.begin(), jumps.theta_o.end(), [&](const ThetaJump& j) {
        return borders[i] >= j.before && borders[i + 1] <= j.after;
      });
      open_.push_back({borders[i], borders[i + 1], 0, jump});
    }
  }

  // Refines until every panel is smooth enough.
  void refine() { refine(true); }

  // Integrals at random places inside the panels, by another cubature: panels that miss them are refined, a
  // few times; what is missed in the end, the table states. What f told is checked as a whole, elsewhere.
  void check(std::uint64_t seed) {
    if (told_) return;
    constexpr int rounds = 8;
    Pcg32 u(seed, 19);
    std::vector<Panel> fresh = closed_;
    for (int round = 0; !fresh.empty(); ++round) {
      const AlbedoTable now = table();
      std::vector<float> cosines;
      std::vector<Panel> checked;
      std::set<double> bent_until;
      for (const Panel& panel : fresh)
        if (panel.bend > 2.5) bent_until.insert(panel.hi);
      for (const Panel& panel : fresh) {
        if (panel.jump || panel.hi - panel.lo < 1e-5) continue;
        for (int k = 0; k < (round > 0 || panel.hi > 1.48 ? 3 : 1); ++k) {
          cosines.push_back(cosine_of(linear_mix(to_unit_double(u()), panel.lo, panel.hi)));
          checked.push_back(panel);
        }
        // Where nodes bend more than what lies between them allows, one of them may be wrong: a border
        // bends both panels.
        if (round > 0 || error_ > asked_) continue;
        const bool border = panel.bend > 2.5 && bent_until.contains(panel.lo);
        for (int i = border ? 0 : 1; i < (panel.bend > 4 ? 4 : 1); ++i) {
          cosines.push_back(cosine_of(node_of(panel, i)));
          checked.push_back(panel);
        }
      }
      std::vector<double> misses = misses_at(
          now, cosines, {2 * cubature_error(), fine_ ? 41 : 7, fine_ ? 23 : 5, true, progress, progress});
      // Where they disagree a third and finer cubature decides.
      std::vector<float> doubtful;
      for (std::size_t i = 0; i < cosines.size(); ++i) {
        if (misses[i] > doubted * error_) doubtful.push_back(cosines[i]);
      }
      const std::vector<double> decided =
          misses_at(now, doubtful,
                    {0.4 * cubature_error(), fine_ ? 64 : 24, fine_ ? 32 : 12, true, progress, progress});
      double worst = 0;
      std::vector<Panel> missed;
      for (std::size_t i = 0, d = 0; i < cosines.size(); ++i) {
        const double miss = misses[i] > doubted * error_ ? decided[d++] : misses[i];
        worst = max(worst, miss);
        const Panel& p = checked[i];
        if (miss > accepted * error_ && p.level < deepest && (missed.empty() || missed.back().lo != p.lo))
          missed.push_back(p);
      }
      if (missed.empty() || round == rounds || effort_.evaluations - start_ > budget_) {
        if (worst > error_) missed_ = 2 * worst;
        return;
      }
      // A half that the parabola finds smooth was so before it was halved: trust is what was wrong here.
      // The integrals themselves may be what was wrong: near the rim all are taken again.
      std::vector<Panel> kept;
      const bool first_time = !rim_;
      for (const Panel& p : closed_) {
        const bool again =
            std::any_of(missed.begin(), missed.end(), [&](const Panel& m) { return m.lo == p.lo; });
        if (again) {
          halve(p, open_);
        } else if (first_time && p.hi > 1.4 && !p.jump) {
          open_.push_back(p);
          missed.push_back(p);
        } else {
          kept.push_back(p);
        }
      }
      rim_ = true;
      if (error_ <= asked_ && !fine_)
        cells_x_ = 24, cells_y_ = 12;  // what was deceived once would be so again
      for (const Panel& p : missed) {
        for (int i = 0; i < 5; ++i) nodes_.erase(node_of(p, i));
      }
      closed_ = std::move(kept);
      const std::size_t before_refining = closed_.size();
      refine(false);
      fresh.assign(closed_.begin() + std::ptrdiff_t(before_refining), closed_.end());
    }
  }

  AlbedoTable table() const {
    std::map<float, double> entries{{1.f, nodes_.at(first_) * factor(first_)}};
    const Factor by = [this](double theta_o) { return factor(theta_o); };
    for (const Panel& panel : closed_) {
      const std::array<double, 5> v = values_of(panel);
      if (panel.jump)
        entries[cosine_of(panel.hi)] = max(v[4] * factor(panel.hi), 0.);
      else
        tabulate(panel, v, by, interpolation_error(), entries);
    }
    AlbedoTable table;
    for (const auto& [c, a] : entries) table.cos_theta_o.push_back(c), table.albedo.push_back(float(a));
    table.relative_error = worst_ > 1.001 * cubature_error() ? float(min(4 * worst_, 1.)) : float(error_);
    table.relative_error = max(table.relative_error, float(min(max(missed_, 2 * noise_), 1.)));
    return table;
  }

 private:
  static constexpr int deepest = 10;
  // Shares of the error by which table and check may differ. The check may be off by half of the error, the one
  // that decides by a tenth: with these shares what is accepted is within the error.
  static constexpr double doubted = 0.5, accepted = 0.7;
  static constexpr float progress = 0.1f, progress_end = 0.4f;

  double cubature_error() const { return 0.25 * error_; }
  double interpolation_error() const { return 0.15 * error_; }
  // The nodes hold the albedo without the factor that the function knows of.
  double factor(double theta_o) const { return known_ ? known_(theta_o) : 1.; }

  std::vector<Viewer> viewers_at(const std::vector<float>& cosines) const {
    std::vector<Viewer> viewers;
    for (const float c : cosines) viewers.push_back({turned_to(wo_from_cosine(c), phi_o_), at_});
    return viewers;
  }
  std::array<double, 5> values_of(const Panel& panel) const {
    std::array<double, 5> v;
    for (int i = 0; i < 5; ++i) v[std::size_t(i)] = nodes_.at(node_of(panel, i));
    return v;
  }
  // By how much the table misses integrals, relatively; near grazing ten times as much is a miss of one.
  std::vector<double> misses_at(const AlbedoTable& table, const std::vector<float>& cosines,
                                const IntegralOptions& options) {
    const Integrals seen = integrate(field_, viewers_at(cosines), options, host_, apart_);
    std::vector<double> misses;
    for (std::size_t i = 0; i < cosines.size(); ++i) {
      const double a = double(albedo_at(table, cosines[i])), b = seen.values[i];
      misses.push_back(max(a, b) > 0 ? std::abs(a - b) / max(a, b) / times_allowed(cosines[i]) : 0);
    }
    return misses;
  }
  // What the parabola misses at the odd nodes; the polynomial of degree 4 misses far less. What the parent's
  // polynomial of degree 4 missed there is known, too, and this half misses less.
  struct Miss {
    double by_parabola = 0, by_parent = 0, scale = 0;
  };
  Miss miss_of(const Panel& panel) const {
    const std::array<double, 5> v = values_of(panel);
    Miss miss;
    for (const int i : {1, 3}) {
      const auto k = std::size_t(i);
      miss.by_parabola = max(miss.by_parabola, std::abs(interpolate(v, 2, i) - v[k]));
      miss.by_parent = max(miss.by_parent, std::abs(panel.predicted[k / 2] - v[k]));
      miss.scale = max(miss.scale, v[k]);
    }
    return miss;
  }
  // Beside the horizon anisotropic functions are allowed ten times as much here, too, as where misses are judged.
  double times(const Panel& panel) const {
    return field_.frame.isotropic() ? 1 : times_allowed(cosine_of(panel.lo));
  }
  bool is_rough(const Panel& panel, const Miss& miss) const {
    const double allowed = interpolation_error() * times(panel) * miss.scale;
    return miss.by_parabola > 4 * allowed && miss.by_parent > 3 * allowed && !panel.jump;
  }
  // A node whose integral stepped over something leaves the panels beside it rough, however often they are
  // halved. Of anisotropic functions the nodes of panels that stay rough are integrated again, from finer cells.
  void review() {
    constexpr int suspicious = 2;
    if (field_.frame.isotropic() || told_ || fine_ || error_ > asked_ ||
        effort_.evaluations - start_ > budget_)
      return;
    std::vector<double> doubtful;
    for (const Panel& panel : open_) {
      if (panel.level < suspicious || !is_rough(panel, miss_of(panel))) continue;
      for (int i = 0; i < 5; ++i) {
        if (reviewed_.insert(node_of(panel, i)).second) doubtful.push_back(node_of(panel, i));
      }
    }
    integrate_nodes(doubtful, 2);
  }
  void refine(bool with_pilots) {
    for (; !open_.empty(); with_pilots = false) {
      integrate_open(with_pilots);
      review();
      std::vector<Panel> next;
      const bool spent = effort_.evaluations - start_ > budget_;
      for (const Panel& panel : open_) {
        const Miss miss = miss_of(panel);
        const double allowed = interpolation_error() * miss.scale;
        const bool rough = is_rough(panel, miss);
        if (rough && spent && miss.scale > 0)
          noise_ = max(noise_, miss.by_parabola / (miss.scale * times(panel)));
        if (rough && !spent && panel.level < deepest) {
          halve(panel, next);
        } else {
          closed_.push_back(panel);
          closed_.back().bend = allowed > 0 && !panel.jump ? miss.by_parabola / allowed : 0;
        }
      }
      open_ = std::move(next);
    }
  }
  void halve(const Panel& p, std::vector<Panel>& halves) const {
    const std::array<double, 5> v = values_of(p);
    const double mid = node_of(p, 2);
    halves.push_back({p.lo, mid, p.level + 1, false, {interpolate(v, 1, 0.5), interpolate(v, 1, 1.5)}});
    halves.push_back({mid, p.hi, p.level + 1, false, {interpolate(v, 1, 2.5), interpolate(v, 1, 3.5)}});
  }
  void integrate_nodes(const std::vector<double>& thetas, int finer = 1) {
    std::vector<float> cosines;
    for (const double theta : thetas) cosines.push_back(cosine_of(theta));
    Integrals a;
    if (told_) {
      for (const Viewer& viewer : viewers_at(cosines))
        a.values.push_back(double(field_.target.scale) * told_(field_.to_caller(viewer.wo)));
    } else {
      a = integrate(
          field_, viewers_at(cosines),
          {cubature_error(), finer * cells_x_, finer * cells_y_, rim_, progress, progress_end, max_regions_},
          host_, effort_);
    }
    for (std::size_t i = 0; i < thetas.size(); ++i) nodes_[thetas[i]] = a.values[i] / factor(thetas[i]);
    worst_ = max(worst_, a.error);
  }
  // The nodes of the open panels that are not known yet; at first one in eight ahead of the others.
  void integrate_open(bool with_pilots) {
    std::vector<double> pilots, fresh;
    for (const Panel& panel : open_) {
      for (int i = 0; i < 5; ++i) {
        if (!nodes_.emplace(node_of(panel, i), 0.).second) continue;
        const bool pilot = with_pilots && (pilots.size() + fresh.size()) % 8 == 0;
        (pilot ? pilots : fresh).push_back(node_of(panel, i));
      }
    }
    // A function with steps, or with the noise of floats, has no albedo to four digits for any decent number
    // of evaluations: where the first few integrals do not get there, or are too dear, all are content with
    // what is easily had, and the table says so.
    const std::uint64_t before_pilots = effort_.evaluations;
    integrate_nodes(pilots);
    if (worst_ > cubature_error()) error_ = min(8 * worst_, 1.);
    if (with_pilots && !pilots.empty()) {
      const double each = double(effort_.evaluations - before_pilots) / double(pilots.size());
      const double dear = 2 * each * double(fresh.size()) / double(budget_);
      if (dear > 1) error_ = min(error_ * 2 * std::sqrt(dear), 1.);
    }
    integrate_nodes(fresh);
  }

  const Field& field_;
  const float phi_o_;
  const Coordinates at_;
  const Host& host_;
  Effort& effort_;
  const double asked_;
  double error_;  // what all are content with: more than was asked for where that is too dear
  const Factor known_;
  const std::function<double(Direction)> told_;  // the albedo, where f knows it
  std::uint64_t start_, budget_;
  // Of one integral: where a row has little effort to spend, steps take no more than their share of it.
  std::size_t max_regions_;
  Effort apart_;  // of the checks: evaluations count what the sampler is made of
  // Lobes that lie askew hide better: anisotropic functions begin with more cells.
  int cells_x_ = 8, cells_y_ = 4;
  const bool fine_;  // trees were grown, and their judge found integrals that stepped over something
  bool rim_;         // close in on the rim: the first integrals were found wrong, or rows must agree
  double first_ = 0, worst_ = 0, missed_ = 0, noise_ = 0;  // worst: of the integrals, as they estimate it
  std::vector<Panel> open_, closed_;
  std::map<double, double> nodes_;
  std::set<double> reviewed_;
};

}  // namespace

AlbedoTable albedo_over_elevation(const Field& field, float phi_o, const Coordinates& at,
                                  float relative_error, const Jumps& jumps, std::uint64_t seed,
                                  const Host& host, Effort& effort, std::uint64_t budget, bool checked) {
  TableBuilder builder(field, phi_o, at, relative_error, jumps, host, effort, budget);
  builder.refine();
  if (checked) builder.check(seed);
  return builder.table();
}

}  // namespace reflectree::detail
