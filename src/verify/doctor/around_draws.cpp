// SPDX-License-Identifier: Apache-2.0
#include "around_draws.hpp"

#include <algorithm>

namespace reflectree::detail {
namespace {

Ranges ranges(const Values& v, std::size_t channels) {
  constexpr std::size_t n = std::tuple_size_v<decltype(neighbours({}))>;
  Ranges r(v.size() / n);
  for (std::size_t k = 0; k < v.size(); ++k) r[k / (n * channels) * channels + k % channels].add(v[k]);
  return r;
}

}  // namespace

double relative_error(const Range& r, double x) {
  if (!std::isfinite(x)) return 1e9;
  const double lo = r.lo, hi = r.hi;
  return x < lo ? (lo - x) / std::max(lo, 1e-30) : x > hi ? (x - hi) / std::max(hi, 1e-30) : 0;
}

AroundDraws::AroundDraws(const Functions& functions, const Pointwise& drawn)
    : f(functions), draws(drawn), channels(functions.channels()) {
  for (std::size_t i = 0; i < draws.size(); ++i) {
    for (const Vec3<double>& w : neighbours(draws.wi[i])) {
      wo.push_back(draws.wo[i]);
      wi.push_back(narrow(w));
    }
  }
  f_cos = ranges(f.f_cos(wo, wi), channels);
}

DirectionPair AroundDraws::pair(std::size_t i) const { return {widen(draws.wo[i]), widen(draws.wi[i])}; }

Ranges AroundDraws::pdf_ranges(const DensityHypothesis* h, bool inverse) const {
  Directions a = wo, b = wi;
  for (std::size_t k = 0; h && h->turn && k < a.size(); ++k) {
    const DirectionPair t = h->turn({widen(a[k]), widen(b[k])});
    a[k] = narrow(t.wo), b[k] = narrow(t.wi);
  }
  Values pdf = f.pdf(a, b);
  for (std::size_t k = 0; h && h->factor && k < pdf.size(); ++k) {
    const double g = h->factor({widen(wo[k]), widen(wi[k])});
    pdf[k] *= inverse ? 1 / g : g;
  }
  return ranges(pdf, 1);
}

Ranges AroundDraws::truth_ranges(const DensityVerdict& density) const {
  return ranges(density.truth(wo, wi), 1);
}

Values AroundDraws::claimed(const Values& density) const {
  const Values expected =
      f.value_kind() == ValueKind::none ? f.f_cos(draws.wo, draws.wi) : Values(draws.value.size());
  Values claimed(draws.value.size());
  for (std::size_t i = 0; i < draws.size(); ++i) {
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t k = i * channels + c;
      claimed[k] = f.weight({draws.wi[i], draws.pdf[i], true}, draws.value[k], expected[k]) * density[i];
    }
  }
  return claimed;
}

double AroundDraws::weight_share(const Values& claimed, const Values& factor,
                                 const std::vector<std::size_t>& from, const Ranges& expected,
                                 double tolerance, std::size_t* worst) const {
  double agree = 0, most = 0;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    double brightest = 0, off = 0;
    for (std::size_t c = 0; c < channels; ++c) brightest = std::max(brightest, expected[i * channels + c].hi);
    for (std::size_t c = 0; c < channels; ++c) {
      const Range& r = expected[i * channels + from[c]];
      const double x = claimed[i * channels + c] / factor[i];
      if (std::abs(x - r.hi) <= dim * brightest || std::abs(x - r.lo) <= dim * brightest) continue;
      off = std::max(off, relative_error(r, x));
    }
    agree += off <= tolerance;
    if (off > most && off < 1e6 && worst) most = off, *worst = i;
  }
  return draws.size() == 0 ? 1 : agree / double(draws.size());
}

Ranges AroundDraws::f_cos_at(const Directions& a, const Directions& b) const {
  Values v = f.f_cos(a, b);
  for (std::size_t k = 0; k < b.size(); ++k) {
    const double scale = std::max(double(wi[k].z), 0.) / std::max(double(b[k].z), 1e-9);
    for (std::size_t c = 0; c < channels; ++c) v[k * channels + c] *= scale;
  }
  return ranges(v, channels);
}

double share(const Ranges& r, const Values& x, double tolerance) {
  double agree = 0;
  for (std::size_t i = 0; i < x.size(); ++i) agree += relative_error(r[i], x[i]) <= tolerance;
  return x.empty() ? 1 : agree / double(x.size());
}

}  // namespace reflectree::detail
