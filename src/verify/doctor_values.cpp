// SPDX-License-Identifier: Apache-2.0
#include "doctor_values.hpp"

#include <algorithm>
#include <cstdio>

#include "elevations.hpp"
#include "reflectree/math/frame.hpp"

namespace reflectree::detail {
namespace {

Direction tilted(double cos_theta, double phi) { return viewer(cos_theta, phi); }

// Directions where formulas break: the normal itself, grazing, and everything between.
Directions sweep(std::uint64_t seed) {
  Directions w{{0, 0, 1}};
  Pcg32 u = part_generator(seed, 31);
  for (const double cos_theta : {0.9999999, 0.9999, 0.99, 0.8, 0.5, 0.2, 0.05, 0.01, 1e-3, 1e-4}) {
    w.push_back(tilted(cos_theta, 0));
    w.push_back(tilted(cos_theta, pi_v<double> / 2));
    w.push_back(tilted(cos_theta, 2 * pi_v<double> * to_unit_double(u())));
  }
  return w;
}

struct Sweep {
  Directions wo, wi;
};
// Every pair of the sweep, mirror pairs and their neighbours, wi == wo among them.
Sweep sweep_pairs(std::uint64_t seed) {
  Sweep pairs;
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

void judge(Diagnosis& d, const char* who, const char* quantity, const Sweep& pairs,
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

double asymmetry(std::span<const double> a, std::span<const double> b) {
  double difference = 0, total = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!sane(a[i]) || !sane(b[i])) continue;
    difference += std::abs(a[i] - b[i]);
    total += std::max(a[i], b[i]);
  }
  return total > 0 ? difference / total : 0;
}

// Pairs at moderate elevations, half of them near mirror pairs.
Sweep random_pairs(std::size_t count, std::uint64_t seed) {
  Sweep pairs;
  Pcg32 u = part_generator(seed, 33);
  for (std::size_t i = 0; i < count; ++i) {
    const auto any = [&] {
      return tilted(0.1 + 0.9 * to_unit_double(u()), 2 * pi_v<double> * to_unit_double(u()));
    };
    const Direction wo = any();
    Direction wi = any();
    if (i % 2 == 1) {
      const double far = std::pow(10., -2 * to_unit_double(u()));
      Vec3<double> w{-wo.x + far * (wi.x + wo.x), -wo.y + far * (wi.y + wo.y), wo.z + far * (wi.z - wo.z)};
      w = normalize(w);
      wi = {float(w.x), float(w.y), float(w.z)};
    }
    pairs.wo.push_back(wo), pairs.wi.push_back(wi);
  }
  return pairs;
}

// How far eval is from reciprocal, as f and as f cos_theta_i.
struct Reciprocity {
  double f = 0, f_cos = 0;
};
Reciprocity reciprocity_of(const Functions& raw, std::uint64_t seed, std::size_t count) {
  const Sweep pairs = random_pairs(count, seed);
  std::vector<double> a = raw.raw(pairs.wo, pairs.wi), b = raw.raw(pairs.wi, pairs.wo);
  Reciprocity r;
  r.f = asymmetry(a, b);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] /= double(pairs.wi[i / raw.channels()].z);
    b[i] /= double(pairs.wo[i / raw.channels()].z);
  }
  r.f_cos = asymmetry(a, b);
  return r;
}

// The share of draws at which a reading of both functions agrees.
double agreement(const Functions& f, const Pointwise& p) {
  if (p.size() == 0) return 0;
  const std::vector<double> f_cos = f.f_cos(p.wo, p.wi);
  double agree = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    double most = 0, off = 0;
    for (std::size_t c = 0; c < f.channels(); ++c) {
      const double expected = f_cos[i * f.channels() + c];
      const double got =
          f.weight({p.wi[i], p.pdf[i], true}, p.value[i * f.channels() + c], expected) * p.pdf[i];
      most = std::max(most, std::abs(expected));
      off = std::max(off, std::abs(got - expected));
    }
    agree += off <= 0.01 * most;
  }
  return agree / double(p.size());
}

}  // namespace

Finding a_finding(const char* check, std::string cause, std::string words, Evidence evidence, bool fault) {
  Finding finding;
  finding.check = check;
  finding.cause = std::move(cause);
  finding.words = std::move(words);
  finding.evidence = std::move(evidence);
  finding.fault = fault;
  return finding;
}

CheckResult limited(const char* name, double statistic, double threshold, const std::string& detail,
                    const std::string& where) {
  CheckResult r;
  r.name = name;
  r.statistic = statistic;
  r.threshold = threshold;
  r.passed = statistic <= threshold;
  r.detail = detail;
  r.where = where;
  return r;
}

Kinds settle_kinds(const Patient& patient, std::uint64_t seed) {
  Kinds kinds{patient.eval_kind, patient.value_kind, {}};
  const Functions raw(patient, EvalKind::f, ValueKind::weight);
  const Pointwise draws = draw_pointwise(raw, 16, 60, seed);
  const auto share = [&](EvalKind e, ValueKind v) { return agreement(Functions(patient, e, v), draws); };
  const char* how = "as declared";
  if (kinds.eval == EvalKind::detect) {
    const Reciprocity r = reciprocity_of(raw, seed, 2000);
    const double as_f = share(EvalKind::f, ValueKind::weight),
                 as_f_cos = share(EvalKind::f_cos, ValueKind::weight);
    if (r.f < 0.01 && r.f_cos > 0.03) {
      kinds.eval = EvalKind::f, how = "detected: only so it is reciprocal";
    } else if (r.f_cos < 0.01 && r.f > 0.03) {
      kinds.eval = EvalKind::f_cos, how = "detected: only so it is reciprocal";
    } else if (as_f_cos > 0.9 && as_f < 0.5) {
      kinds.eval = EvalKind::f_cos, how = "detected: sample's weights say so";
    } else {
      kinds.eval = EvalKind::f, how = as_f > 0.9 ? "detected: sample's weights say so" : "assumed";
    }
  }
  kinds.sentences.push_back(std::string("eval returns ") +
                            (kinds.eval == EvalKind::f ? "f, without cosine" : "f cos_theta_i") + " (" + how +
                            ")");
  how = "as declared";
  if (kinds.value == ValueKind::detect) {
    kinds.value = ValueKind::weight, how = "assumed";
    const bool nothing =
        std::all_of(draws.value.begin(), draws.value.end(), [](double v) { return !(v > 0); });
    if (nothing) {
      kinds.value = ValueKind::none, how = "detected";
    } else {
      for (const ValueKind v : {ValueKind::weight, ValueKind::f_cos, ValueKind::f}) {
        if (share(kinds.eval, v) < 0.9) continue;
        kinds.value = v, how = "detected";
        break;
      }
    }
  }
  const char* names[] = {"", "the weight f cos_theta_i / pdf", "f cos_theta_i", "f, without cosine",
                         "no value"};
  kinds.sentences.push_back(std::string("sample returns ") + names[std::size_t(kinds.value)] + " (" + how +
                            ")");
  kinds.sentences.push_back(patient.pdf ? "pdf is per solid angle" : "there is no pdf");
  return kinds;
}

void check_values(const Functions& f, std::uint64_t seed, Diagnosis& d) {
  const Sweep pairs = sweep_pairs(seed);
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
    bool finite = is_finite(drawn.wi) && std::isfinite(drawn.pdf), sign = drawn.pdf >= 0;
    for (std::size_t c = 0; c < f.channels(); ++c) {
      const double v = draws.value[i * f.channels() + c];
      finite = finite && std::isfinite(v);
      sign = sign && !(v < 0);
    }
    if (!finite) infinite.add(wo[i], drawn.wi, "sample(wo).pdf", drawn.pdf, 0);
    if (finite && !sign) negative.add(wo[i], drawn.wi, "sample(wo).pdf", drawn.pdf, 0);
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
  const Sweep pairs = random_pairs(1000, mixed_seed(seed, 35));
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

  const Directions wo(256, tilted(0.7, 0.3));
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

void remark_on_physics(const Functions& f, std::span<const ExaminedView> views, std::uint64_t seed,
                       Diagnosis& d) {
  const Reciprocity r = reciprocity_of(f, mixed_seed(seed, 36), 4000);
  const double off = f.eval_kind() == EvalKind::f ? r.f : r.f_cos;
  d.figures.push_back({"mean_miss_of_reciprocity", "", off});
  char buffer[160];
  if (off > 0.01) {
    std::snprintf(buffer, sizeof buffer,
                  "f is not reciprocal: f(wi, wo) differs from f(wo, wi) by %.2g %% in the mean", 100 * off);
    d.findings.push_back(a_finding("reciprocity", "not_reciprocal", buffer, {}, false));
  }
  double most = 0;
  const ExaminedView* where = nullptr;
  for (const ExaminedView& view : views) {
    for (const double a : view.channel_albedo) {
      if (a > most) most = a, where = &view;
    }
  }
  d.figures.push_back({"largest_albedo", where ? where->where : "", most});
  if (most > 1.01) {
    std::snprintf(buffer, sizeof buffer, "f reflects more light than it receives: albedo %.4g at %s", most,
                  where->where.c_str());
    d.findings.push_back(a_finding("energy", "gains_energy", buffer, {}, false));
  }
}

}  // namespace reflectree::detail
