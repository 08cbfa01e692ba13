// SPDX-License-Identifier: Apache-2.0
#include "values.hpp"

#include <algorithm>
#include <cstdio>

#include "elevations.hpp"
#include "findings.hpp"
#include "parallel.hpp"
#include "physics.hpp"
#include "reflectree/math/frame.hpp"

namespace reflectree::detail {
namespace {

// Directions where formulas break: the normal itself, grazing, and everything between.
Directions sweep(std::uint64_t seed) {
  Directions w{{0, 0, 1}};
  Pcg32 u = part_generator(seed, 31);
  for (const double cos_theta : {0.9999999, 0.9999, 0.99, 0.8, 0.5, 0.2, 0.05, 0.01, 1e-3, 1e-4}) {
    w.push_back(viewer(cos_theta, 0));
    w.push_back(viewer(cos_theta, pi_v<double> / 2));
    w.push_back(viewer(cos_theta, 2 * pi_v<double> * to_unit_double(u())));
  }
  return w;
}

// Every pair of the sweep, mirror pairs and their neighbours, wi == wo among them.
Pairs sweep_pairs(std::uint64_t seed) {
  Pairs pairs;
  const Directions all = sweep(seed);
  Pcg32 u = part_generator(seed, 32);
  for (const Direction wo : all) {
    const auto add = [&](Direction wi) { pairs.wo.push_back(wo), pairs.wi.push_back(wi); };
    for (const Direction wi : all) add(wi);
    add(mirror_direction(wo));
    const LocalFrame<double> frame = frame_from_normal(Vec3<double>{-wo.x, -wo.y, wo.z});
    for (int i = 0; i < 8; ++i) {
      const double angle = std::pow(10., -4 * to_unit_double(u())),
                   phi = 2 * pi_v<double> * to_unit_double(u());
      Vec3<double> w = to_world(frame, direction_from_angles(angle, phi));
      w.z = std::max(std::abs(w.z), 1e-4);
      w = normalize(w);
      add({float(w.x), float(w.y), float(w.z)});
    }
  }
  return pairs;
}

// Pairs at which something was wrong: how many, one of them, and what they have in common.
struct Wrong {
  std::size_t count = 0, of = 0, at_normal = 0, at_grazing = 0;
  Evidence evidence;
  void add(Direction wo, Direction wi, const char* quantity, double value, double expected) {
    // Among many, the one that is simplest to type.
    const auto digits = [](Direction w) { return (w.x != 0) + (w.y != 0) + (w.z != 1); };
    if (count == 0 || digits(wo) + digits(wi) < digits(evidence.wo) + digits(evidence.wi)) {
      evidence = {wo, wi, quantity, value, expected};
    }
    ++count;
    at_normal += wo.z >= 1 || wi.z >= 1;
    at_grazing += wo.z < 0.02f || wi.z < 0.02f;
  }
  std::string place() const {
    return at_normal == count ? " at the normal" : at_grazing == count ? " towards grazing" : "";
  }
  const char* key(const char* normal, const char* grazing, const char* anywhere) const {
    return at_normal == count ? normal : at_grazing == count ? grazing : anywhere;
  }
};

void report(Diagnosis& d, const char* check, const Wrong& wrong, const char* who, const std::string& what,
            const std::string& cause) {
  char detail[96];
  std::snprintf(detail, sizeof detail, "%s: %zu of %zu values", who, wrong.count, wrong.of);
  d.checks.push_back(limited(check, double(wrong.count), 0, detail));
  if (wrong.count == 0) return;
  d.findings.push_back(
      a_finding(check, cause, std::string(who) + " is " + what + wrong.place(), wrong.evidence));
  d.findings.back().figures = {{"share", "of the sweep", double(wrong.count) / double(wrong.of)}};
}

void judge(Diagnosis& d, const char* who, const char* quantity, const Pairs& pairs,
           std::span<const double> values, std::size_t stride) {
  Wrong infinite, negative;
  infinite.of = negative.of = values.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Direction wo = pairs.wo[i / stride], wi = pairs.wi[i / stride];
    if (!std::isfinite(values[i])) infinite.add(wo, wi, quantity, values[i], 0);
    if (values[i] < 0) negative.add(wo, wi, quantity, values[i], 0);
  }
  report(d, "finite", infinite, who, "NaN or infinite",
         infinite.key("not_finite_at_normal", "not_finite_at_grazing", "not_finite"));
  report(d, "not_negative", negative, who, "negative", "negative");
}

}  // namespace

void check_values(const Functions& f, std::uint64_t seed, Diagnosis& d) {
  const Pairs pairs = sweep_pairs(seed);
  judge(d, "eval", "eval(wo, wi)", pairs, f.raw(pairs.wo, pairs.wi), f.channels());
  if (f.has_pdf()) judge(d, "pdf", "pdf(wo, wi)", pairs, f.pdf(pairs.wo, pairs.wi), 1);

  Directions wo;
  for (const Direction w : sweep(seed)) wo.insert(wo.end(), 64, w);
  const Functions::Draws draws = f.draw(wo, mixed_seed(seed, 34));
  Wrong infinite, negative, length;
  infinite.of = negative.of = length.of = wo.size();
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const PatientDraw& drawn = draws.draw[i];
    if (!drawn.drawn) continue;
    const double length2 = double(dot(drawn.wi, drawn.wi));
    bool finite = is_finite(drawn.wi) && std::isfinite(drawn.pdf);
    // Below the horizon, without a weight, a pdf means nothing: half vectors that look away from wo have a Jacobian
    // below 0.
    const auto values = std::span(draws.value).subspan(i * f.channels(), f.channels());
    bool sign = drawn.pdf >= 0 || (drawn.wi.z < 0 && is_lost(drawn, values, f.has_pdf()));
    // The pdf is shown, or the value where the pdf is right.
    const char* what = "sample(wo).pdf";
    double shown = drawn.pdf;
    const auto show = [&](double v, bool& right) {
      if (finite && sign) what = "a value of sample(wo)", shown = v;
      right = false;
    };
    for (const double v : values) {
      if (!std::isfinite(v)) show(v, finite);
      if (v < 0) show(v, sign);
    }
    if (!finite) infinite.add(wo[i], drawn.wi, what, shown, 0);
    if (finite && !sign) negative.add(wo[i], drawn.wi, what, shown, 0);
    if (finite && std::abs(length2 - 1) > 1e-3 && length2 > 0) {
      length.add(wo[i], drawn.wi, "|wi|^2", length2, 1);
    }
  }
  report(d, "finite", infinite, "what sample returns", "NaN or infinite",
         infinite.key("not_finite_at_normal", "not_finite_at_grazing", "not_finite"));
  report(d, "not_negative", negative, "what sample returns", "negative", "negative");
  report(d, "unit_length", length, "sample's direction", "not of unit length", "not_unit");
}

void check_repeatable(const Functions& f, std::uint64_t seed, Diagnosis& d) {
  const Pairs pairs = random_pairs(1000, mixed_seed(seed, 35));
  const auto same = [&](const char* who, const std::vector<double>& a, const std::vector<double>& b,
                        std::size_t stride) {
    std::size_t differ = 0;
    Evidence evidence;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) continue;
      if (differ++ == 0) {
        evidence = {pairs.wo[i / stride], pairs.wi[i / stride], std::string(who) + ", asked again", b[i],
                    a[i]};
      }
    }
    d.checks.push_back(limited("repeatable", double(differ), 0, std::string(who) + ": values that differ"));
    if (differ == 0) return;
    d.findings.push_back(
        a_finding("repeatable", std::string(who) + "_stochastic",
                  std::string(who) + " is random: the same pair of directions gets another value", evidence));
    d.findings.back().figures = {{"share", "of pairs", double(differ) / double(a.size())}};
  };
  same("eval", f.raw(pairs.wo, pairs.wi), f.raw(pairs.wo, pairs.wi), f.channels());
  if (f.has_pdf()) same("pdf", f.pdf(pairs.wo, pairs.wi), f.pdf(pairs.wo, pairs.wi), 1);

  const Directions wo(256, viewer(0.7, 0.3));
  const auto a = f.draw(wo, 11), b = f.draw(wo, 11), c = f.draw(wo, 12);
  const auto equal = [&](const Functions::Draws& x, const Functions::Draws& y) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < wo.size(); ++i) n += x.draw[i].wi == y.draw[i].wi;
    return n;
  };
  if (equal(a, b) < wo.size()) {
    d.findings.push_back(a_finding("repeatable", "seed_without_effect",
                                   "the same seed gives other directions: a finding cannot be repeated", {},
                                   false));
  }
  const std::size_t unchanged = equal(a, c);
  d.checks.push_back(limited("seeds", double(unchanged), 0.5 * double(wo.size()),
                             "draws that another seed leaves as they were"));
  if (unchanged > wo.size() / 2) {
    d.findings.push_back(a_finding("seeds", "seed_ignored",
                                   "another seed gives the same directions: the seed is ignored",
                                   {wo[0], a.draw[0].wi, {}, 0, 0}));
  }
}

}  // namespace reflectree::detail
