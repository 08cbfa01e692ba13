// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/mixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {
namespace {

class Mixture {
 public:
  Mixture(std::vector<MixtureTerm> terms, BrdfTraits traits)
      : terms_(std::move(terms)), traits_(std::move(traits)) {}

  const BrdfTraits& traits() const { return traits_; }

  Spectrum operator()(const ShadingGeometry<float>& g) const {
    Spectrum value(traits_.channels);
    eval({&g, 1}, {value.data(), std::size_t(traits_.channels)});
    return value;
  }
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const {
    accumulate(wo.size(), out,
               [&](const AnyBrdf& f, std::size_t first, std::size_t count, std::span<float> values) {
                 f.eval(wo.subspan(first, count), wi.subspan(first, count), values);
               });
  }
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
    accumulate(geometry.size(), out,
               [&](const AnyBrdf& f, std::size_t first, std::size_t count, std::span<float> values) {
                 f.eval(geometry.subspan(first, count), values);
               });
  }

 private:
  // Calls evaluate(term, first, count, values) for every term and block of the batch, and sums.
  template <class Evaluate>
  void accumulate(std::size_t size, std::span<float> out, const Evaluate& evaluate) const {
    std::array<float, 1024> values;
    const auto stride = std::size_t(traits_.channels);
    const std::size_t block = values.size() / stride;
    for (std::size_t first = 0; first < size; first += block) {
      const std::size_t count = std::min(block, size - first);
      const std::span<float> sum = out.subspan(first * stride, count * stride);
      std::fill(sum.begin(), sum.end(), 0.f);
      for (const MixtureTerm& term : terms_) {
        const auto term_stride = std::size_t(term.f.channels());
        evaluate(term.f, first, count, std::span(values).first(count * term_stride));
        add(term.weight, values.data(), term_stride, sum);
      }
    }
  }
  void add(float weight, const float* values, std::size_t term_stride, std::span<float> sum) const {
    if (term_stride == std::size_t(traits_.channels)) {
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * values[i];
    } else {  // grey: one value for all channels
      const auto stride = std::size_t(traits_.channels);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * values[i / stride];
    }
  }

  std::vector<MixtureTerm> terms_;
  BrdfTraits traits_;
};

// The sum as accumulate() forms it, term after term.
class SumEnclosure final : public BrdfEnclosure {
 public:
  explicit SumEnclosure(const std::vector<MixtureTerm>& terms) {
    for (const MixtureTerm& term : terms) parts_.push_back({term.weight, term.f.traits().enclosure});
  }
  bool whole() const {
    return std::all_of(parts_.begin(), parts_.end(), [](const Part& part) { return bool(part.enclosure); });
  }
  bool is_mirror_symmetric() const override { return all(&BrdfEnclosure::is_mirror_symmetric); }
  bool keeps_half_turns() const override { return all(&BrdfEnclosure::keeps_half_turns); }
  bool keeps_mirrored_axes() const override { return all(&BrdfEnclosure::keeps_mirrored_axes); }
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    RgbT<AffineForm> sum;
    for (const Part& part : parts_) sum = sum + AffineForm(part.weight) * (*part.enclosure)(g);
    return sum;
  }
  // Where a term tells it. Terms are not negative, so that roundings stay relative.
  std::optional<RgbT<AffineForm>> times_cosine(const ShadingGeometry<AffineForm>& g) const override {
    std::vector<std::optional<RgbT<AffineForm>>> told;
    for (const Part& part : parts_) told.push_back(part.enclosure->times_cosine(g));
    if (std::none_of(told.begin(), told.end(), [](const auto& f_cos) { return bool(f_cos); }))
      return std::nullopt;
    RgbT<AffineForm> sum;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i];
      sum = sum + AffineForm(part.weight) * (told[i] ? *told[i] : g.cos_theta_i * (*part.enclosure)(g));
    }
    const auto rounded = [this](const AffineForm& v) { return widened(v, double(parts_.size()) * 0x1p-24); };
    return RgbT<AffineForm>{rounded(sum.r), rounded(sum.g), rounded(sum.b)};
  }

 private:
  struct Part {
    float weight;
    std::shared_ptr<const BrdfEnclosure> enclosure;
  };
  bool all(bool (BrdfEnclosure::*keeps)() const) const {
    return std::all_of(parts_.begin(), parts_.end(),
                       [&](const Part& part) { return ((*part.enclosure).*keeps)(); });
  }
  std::vector<Part> parts_;
};

std::string term_text(const MixtureTerm& term) {
  const std::string& name = term.f.traits().name;
  if (term.weight == 1) return name;
  const bool is_sum = name.find(" + ") != std::string::npos;
  return shortest_text(term.weight) + "*" + (is_sum ? "(" + name + ")" : name);
}

std::vector<float> united(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> sum;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(sum));
  return sum;
}

// Bands of elevations with the azimuths that either tells there; what an isotropic term tells is no border.
std::vector<AzimuthKnots> united_azimuths(const BrdfTraits& a, const BrdfTraits& b) {
  std::vector<AzimuthKnots> sum;
  std::vector<float> ends;
  for (const BrdfTraits* traits : {&a, &b}) {
    for (const AzimuthKnots& band : traits->phi_o_knots) {
      if (!traits->isotropic) ends.push_back(band.theta_o_end);
    }
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  for (const float end : ends) {
    AzimuthKnots& united = sum.emplace_back(AzimuthKnots{end, {}});
    for (const BrdfTraits* traits : {&a, &b}) {
      const auto& bands = traits->phi_o_knots;
      const auto band = std::find_if(bands.begin(), bands.end(),
                                     [end](const AzimuthKnots& k) { return k.theta_o_end >= end; });
      if (!traits->isotropic && band != bands.end())
        united.phi_o.insert(united.phi_o.end(), band->phi_o.begin(), band->phi_o.end());
    }
  }
  return sum;
}

}  // namespace

BrdfTraits combined(const BrdfTraits& a, const BrdfTraits& b) {
  if (a.channels != b.channels && a.channels != 1 && b.channels != 1) {
    throw Error("sums " + std::to_string(a.channels) + " and " + std::to_string(b.channels) + " channels",
                "mixture", "terms must have as many channels as each other, or one");
  }
  BrdfTraits sum;
  sum.name = a.name + " + " + b.name;
  sum.channels = std::max(a.channels, b.channels);
  sum.isotropic = a.isotropic && b.isotropic;
  sum.isotropic_by_formula = a.isotropic_by_formula && b.isotropic_by_formula;
  sum.concurrent = a.concurrent && b.concurrent;
  sum.theta_o_knots = united(a.theta_o_knots, b.theta_o_knots);
  sum.theta_d_knots = united(a.theta_d_knots, b.theta_d_knots);
  sum.phi_o_knots = united_azimuths(a, b);
  if (a.sharp || b.sharp) {
    sum.sharp = [a = a.sharp, b = b.sharp](Direction wo) {
      std::vector<SharpLobe> lobes = a ? a(wo) : std::vector<SharpLobe>();
      for (const SharpLobe& lobe : b ? b(wo) : std::vector<SharpLobe>()) lobes.push_back(lobe);
      return lobes;
    };
  }
  return sum;
}

AnyBrdf mixture(std::vector<MixtureTerm> terms, std::string name) {
  if (terms.empty()) throw Error("has no terms", "mixture", "give at least one");
  BrdfTraits traits = terms.front().f.traits();
  traits.name = term_text(terms.front());
  if (traits.albedo) {
    traits.albedo = [albedo = traits.albedo, weight = double(terms.front().weight)](Direction wo) {
      return weight * albedo(wo);
    };
  }
  for (std::size_t i = 1; i < terms.size(); ++i) {
    BrdfTraits next = terms[i].f.traits();
    next.name = term_text(terms[i]);
    traits = combined(traits, next);
  }
  for (const MixtureTerm& term : terms) {
    if (!(term.weight >= 0) || !std::isfinite(term.weight)) {
      throw Error("weight of " + term.f.traits().name + " is negative or not finite", "mixture",
                  "give a finite weight of 0 or more");
    }
  }
  if (!name.empty()) traits.name = std::move(name);
  const auto enclosure = std::make_shared<SumEnclosure>(terms);
  if (enclosure->whole()) traits.enclosure = enclosure;
  return Mixture(std::move(terms), std::move(traits));
}

}  // namespace reflectree
