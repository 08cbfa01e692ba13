// SPDX-License-Identifier: Apache-2.0
#include "findings.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/text/printf_text.hpp"
#include "refuse.hpp"

namespace reflectree::detail {

namespace {

constexpr double degrees = 180 / pi_v<double>;

float distance(Direction a, Direction b) {
  const Direction d = a - b;
  return sqrt(dot(d, d));
}

// The slab of the largest value of `what`, and it.
template <class What>
std::pair<const Slab*, double> worst_of(const std::vector<Slab>& slabs, const What& what) {
  std::pair<const Slab*, double> worst{nullptr, 0};
  for (const Slab& slab : slabs) {
    const double value = what(slab);
    if (value > worst.second) worst = {&slab, value};
  }
  return worst;
}

// The known coordinates of a slab, in words.
std::string range_of(const Slab& slab, const std::vector<KnownParameter>& parameters) {
  std::string where = text("theta_o %.4g to %.4g degrees", double(slab.box.lo[0]) * degrees,
                           double(slab.box.hi[0]) * degrees);
  for (int axis = 1; axis < slab.box.axes; ++axis) {
    const auto k = std::size_t(slab.box.slot[std::size_t(axis)]);
    if (k == 1) {
      where +=
          text(", phi_o %.4g to %.4g", double(slab.box.lo[1]) * degrees, double(slab.box.hi[1]) * degrees);
      continue;
    }
    const KnownParameter& p = parameters[k - 2];
    where += text(", %s %.4g to %.4g", p.range.name.c_str(), double(value_of(p, slab.box.lo[k])),
                  double(value_of(p, slab.box.hi[k])));
  }
  return where;
}

}  // namespace

bool add_ridges(std::vector<Ridge>& ridges, const Field& field, const CrossExamination& seen) {
  constexpr std::size_t most = 16;
  if (field.whole().axes > 1) return false;  // ridges are followed over theta_o alone
  bool added = false;
  std::vector<Surprise> surprises = seen.surprises;
  for (const FieldPoint& p : seen.towers) surprises.push_back({p.viewer(), field.direction_at(p), 1});
  for (const Surprise& surprise : surprises) {
    if (ridges.size() >= most) break;
    const float theta = theta_of_viewer(surprise.viewer.wo);
    const bool known = std::any_of(ridges.begin(), ridges.end(), [&](const Ridge& ridge) {
      const auto lobe = ridge.at(theta);
      return lobe && distance(lobe->centre, surprise.wi) < 8 * lobe->width;
    });
    if (known) continue;
    ridges.push_back(follow_ridge(field.f, field.target, theta, surprise.wi));
    added = true;
  }
  return added;
}

namespace {

bool mean_disagrees(const CrossExamination& seen, const AlbedoTable& albedo) {
  constexpr double standard_errors = 6, rounding = 1e-3;
  const double allowed = standard_errors * seen.by_bounds_error + double(albedo.relative_error) + rounding;
  return std::abs(seen.by_bounds - 1) > allowed;
}

// More than a table that says what it misses may be wrong by.
bool albedo_disagrees(const CrossExamination& seen, const AlbedoTable& albedo) {
  constexpr double allowed = 0.01;
  return !seen.wrong.empty() && seen.wrong.front().miss > allowed + 3 * double(albedo.relative_error);
}

}  // namespace

bool disagrees(const CrossExamination& seen, const AlbedoTable& albedo) {
  return !seen.surprises.empty() || mean_disagrees(seen, albedo) || albedo_disagrees(seen, albedo);
}

void state_misses(const CrossExamination& seen, AlbedoTable& albedo) {
  if (seen.wrong.empty() || albedo_disagrees(seen, albedo)) return;
  albedo.relative_error = std::max(albedo.relative_error, float(std::min(2 * seen.wrong.front().miss, 1.)));
}

void refuse_disagreement(const CrossExamination& seen, const AlbedoTable& albedo, const Field& field,
                         bool spent) {
  const std::string& name = field.f.traits().name;
  const char* mend = spent ? "the budget is used up: raise max_evaluations, or smooth the function"
                           : "tell of its sharp lobes by traits().sharp, or smooth it";
  if (!seen.surprises.empty()) {
    const Surprise& s = seen.surprises.front();
    const std::string where =
        name + " at " + describe(field.to_caller(s.viewer.wo), field.to_caller(s.wi)) +
        (field.family ? ", " + to_text(field.family->ranges(), values_of(field.parameters, s.viewer.at))
                      : "");
    if (!std::isfinite(s.ratio))
      throw Error("the function is not 0 where its albedo was found to be 0", where, mend);
    throw Error(text("the function is %.3g times its bound: a lobe that no grid resolves", double(s.ratio)),
                where, mend);
  }
  if (albedo_disagrees(seen, albedo)) {
    const WrongAlbedo& w = seen.wrong.front();
    std::string at = text("theta_o = %.4g", double(w.known[0]) * degrees);
    const Viewer viewer = viewer_at(w.known);
    if (!field.frame.isotropic()) {
      const Direction wo = field.to_caller(viewer.wo);
      at += text(", phi_o = %.4g degrees", std::atan2(double(wo.y), double(wo.x)) * degrees);
    } else {
      at += " degrees";
    }
    if (field.family) at += ", " + to_text(field.family->ranges(), values_of(field.parameters, viewer.at));
    throw Error(
        text("the albedo is %.4g at %s, and %.4g beside it: a change too narrow for its table", w.found,
             at.c_str(), w.table),
        name,
        spent ? mend : "smooth the function over the viewers there, or turn it into steps between materials");
  }
  if (mean_disagrees(seen, albedo)) {
    throw Error(
        text("draws from the bounds see %.4f +- %.4f of the albedo", seen.by_bounds, seen.by_bounds_error),
        name, mend);
  }
}

void refuse_hopeless(const std::vector<Slab>& exact, const Field& field, bool spent) {
  // Exact mode gives up after 256 trials: of 20 on average 2 directions in a million would be lost.
  constexpr double most = 20;
  const auto [dear, trials] = worst_of(exact, [](const Slab& s) { return double(total(s, &Leaf::cost)); });
  if (!dear || trials <= most) return;
  throw Error(
      text("exact mode would take %.3g trials on average at %s, and gives up after 256", trials,
           range_of(*dear, field.parameters).c_str()),
      field.f.traits().name,
      spent ? "the budget is used up: sample sharp lobes that move apart as functions of their own, raise "
              "max_evaluations, or smooth the function"
            : "sample sharp lobes that move apart as functions of their own, or smooth the function");
}

bool much_more(double variance, const BuildOptions& options) {
  return variance > 10 * double(options.one_shot_variance);
}

std::vector<std::string> notes_on(const std::vector<Slab>& exact, const std::vector<Slab>& one_shot,
                                  const AlbedoTable& albedo, const DensityJudgement& density,
                                  const std::vector<KnownParameter>& parameters, const BuildOptions& options,
                                  double overshoot, bool spent) {
  std::vector<std::string> notes;
  const bool black = std::all_of(albedo.albedo.begin(), albedo.albedo.end(), [](float a) { return a == 0; });
  if (black) notes.push_back("the function is 0 wherever it was looked at: there is no sample for any wo");
  const std::string end = spent ? text("the budget of %.3g evaluations is used up: raise max_evaluations",
                                       double(options.max_evaluations))
                                : "leaves cannot get smaller: the function is too steep there";
  const auto [dear, trials] = worst_of(exact, [](const Slab& s) { return double(total(s, &Leaf::cost)); });
  if (dear && trials > 1.0002 * double(options.expected_trials)) {
    notes.push_back(text("exact mode takes %.3g trials on average at %s, where %.3g were asked for; ", trials,
                         range_of(*dear, parameters).c_str(), double(options.expected_trials)) +
                    end);
  }
  const bool anisotropic = exact.front().box.axes > 1 && exact.front().box.slot[1] == 1;
  if ((spent || anisotropic) && overshoot > 1e-6) {
    notes.push_back(text("bounds of exact mode miss %.2g of the function in the worst slab, as their attack "
                         "estimates it, and bend its density by as much; one-shot mode is unbiased; ",
                         overshoot) +
                    end);
  }
  // As the trees have it, or as draws from the exact ones show it.
  auto [noisy, variance] = worst_of(one_shot, [](const Slab& slab) { return total_of(slab).variance(); });
  if (density.variance > variance) noisy = density.worst, variance = density.variance;
  if (noisy && much_more(variance, options)) {
    notes.push_back(
        text("one-shot weights have a relative variance of %.2g at %s, where %.2g was asked for; ", variance,
             range_of(*noisy, parameters).c_str(), double(options.one_shot_variance)) +
        end);
  }
  if (albedo.relative_error > 1.001f * options.albedo_error) {
    notes.push_back(
        text("the albedo, and with it pdf and weight of exact mode, is known to %.2g, where %.2g was asked "
             "for; steps or rounding in the function hide the rest",
             double(albedo.relative_error), double(options.albedo_error)));
  }
  return notes;
}

}  // namespace reflectree::detail
