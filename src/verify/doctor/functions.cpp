// SPDX-License-Identifier: Apache-2.0
#include "functions.hpp"

#include <algorithm>
#include <cstdio>

#include "elevations.hpp"
#include "parallel.hpp"

namespace reflectree::detail {
namespace {

// values(wo, wi) above the surface, without the cosine that they may have.
template <class ValuesAt>
TargetFunction function_to_integrate(const Patient& patient, bool with_cosine, const ValuesAt& values_at) {
  TargetFunction t;
  t.concurrent = patient.concurrent;
  t.eval = [values_at, with_cosine](Vec3<double> wo, std::span<const Vec3<double>> wi,
                                    std::span<double> out) {
    Directions w;
    for (const auto& x : wi) w.push_back(narrow(x));
    const Directions known(wi.size(), narrow(wo));
    const std::vector<double> values =
        values_at(std::span<const Direction>(known), std::span<const Direction>(w));
    for (std::size_t i = 0; i < wi.size(); ++i) {
      out[i] = !(w[i].z > 0) ? 0 : with_cosine ? values[i] / wi[i].z : values[i];
    }
  };
  return t;
}

}  // namespace

std::vector<double> Functions::raw(std::span<const Direction> wo, std::span<const Direction> wi) const {
  std::vector<double> out(wi.size() * channels());
  for (std::size_t i = 0; i < wi.size(); i += batch) {
    const std::size_t n = std::min(batch, wi.size() - i);
    p_.eval(wo.subspan(i, n), wi.subspan(i, n), std::span(out).subspan(i * channels(), n * channels()));
  }
  return out;
}

std::vector<double> Functions::pdf(std::span<const Direction> wo, std::span<const Direction> wi) const {
  std::vector<double> out(wi.size());
  for (std::size_t i = 0; i < wi.size(); i += batch) {
    const std::size_t n = std::min(batch, wi.size() - i);
    p_.pdf(wo.subspan(i, n), wi.subspan(i, n), std::span(out).subspan(i, n));
  }
  return out;
}

std::vector<double> Functions::f_cos(std::span<const Direction> wo, std::span<const Direction> wi) const {
  std::vector<double> out = raw(wo, wi);
  if (eval_kind_ == EvalKind::f_cos) return out;
  for (std::size_t i = 0; i < wi.size(); ++i) {
    for (std::size_t c = 0; c < channels(); ++c) out[i * channels() + c] *= std::max(double(wi[i].z), 0.);
  }
  return out;
}

Functions::Draws Functions::draw(std::span<const Direction> wo, std::uint64_t seed) const {
  Draws draws{std::vector<PatientDraw>(wo.size()), std::vector<double>(wo.size() * channels())};
  for (std::size_t i = 0; i < wo.size(); i += batch) {
    const std::size_t n = std::min(batch, wo.size() - i);
    p_.sample(wo.subspan(i, n), i == 0 ? seed : mixed_seed(seed, i), std::span(draws.draw).subspan(i, n),
              std::span(draws.value).subspan(i * channels(), n * channels()));
  }
  return draws;
}

double Functions::weight(const PatientDraw& d, double value, double f_cos) const {
  if (!d.drawn) return 0;
  if (value_kind_ == ValueKind::weight) return value;
  const double numerator = value_kind_ == ValueKind::f_cos ? value
                           : value_kind_ == ValueKind::f   ? value * double(d.wi.z)
                                                           : f_cos;
  return d.pdf > 0 ? numerator / d.pdf : 0;
}

double Functions::target(std::span<const double> channels) const {
  double squares = 0;
  for (const double x : channels) squares += sqr(sane_or_zero(x));
  return std::sqrt(squares);
}

TargetFunction Functions::target_function() const {
  return function_to_integrate(p_, eval_kind_ == EvalKind::f_cos, [f = *this](auto wo, auto wi) {
    const std::vector<double> values = f.raw(wo, wi);
    std::vector<double> targets(wi.size());
    for (std::size_t i = 0; i < wi.size(); ++i) {
      targets[i] = f.target(std::span(values).subspan(i * f.channels(), f.channels()));
    }
    return targets;
  });
}

TargetFunction Functions::density_function() const {
  return function_to_integrate(p_, true, [f = *this](auto wo, auto wi) {
    std::vector<double> pdf = f.pdf(wo, wi);
    for (double& p : pdf) p = sane_or_zero(p);
    return pdf;
  });
}

bool is_lost(const PatientDraw& d, std::span<const double> values, bool has_pdf) {
  if (!d.drawn) return true;
  const bool dark = std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
  return dark && ((has_pdf && !(d.pdf > 0)) || !(d.wi.z > 0));
}

Pointwise draw_pointwise(const Functions& f, int viewers, int draws, std::uint64_t seed) {
  Pcg32 u = part_generator(seed, 23);
  Directions wo;
  for (const Direction w : stratified_viewers(std::size_t(viewers), u))
    wo.insert(wo.end(), std::size_t(draws), w);
  const Functions::Draws all = f.draw(wo, mixed_seed(seed, 24));
  Pointwise p;
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto values = std::span(all.value).subspan(i * f.channels(), f.channels());
    if (is_lost(all.draw[i], values, f.has_pdf()) || !is_finite(all.draw[i].wi) || !(all.draw[i].wi.z > 0))
      continue;
    p.wo.push_back(wo[i]);
    p.wi.push_back(all.draw[i].wi);
    p.pdf.push_back(all.draw[i].pdf);
    p.value.insert(p.value.end(), values.begin(), values.end());
  }
  return p;
}

std::string in_words(Direction w) {
  char buffer[64];
  // Plus 0, for -0.
  std::snprintf(buffer, sizeof buffer, "(%.6g, %.6g, %.6g)", w.x + 0., w.y + 0., w.z + 0.);
  return buffer;
}

double degrees(double radians) { return radians * 180 / pi_v<double>; }

}  // namespace reflectree::detail
