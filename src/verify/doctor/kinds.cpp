// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"

#include <algorithm>

#include "physics.hpp"

namespace reflectree::detail {
namespace {

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

}  // namespace reflectree::detail
