// SPDX-License-Identifier: Apache-2.0
#include "examined_pairs.hpp"

#include "reflectree/math/frame.hpp"
#include "reflectree/math/random.hpp"
#include "refuse.hpp"

namespace reflectree::detail {

void make_pairs(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi) {
  constexpr std::size_t pairs = 4096;
  Pcg32 u(seed, 11);
  while (wo.size() < pairs) {
    const float cos_theta_o = max(to_unit_float(u()), 1e-3f);
    const float shrink = wo.size() % 4 < 2 ? 1.f : to_unit_float(u());
    const Vec2<float> p{shrink * (2 * to_unit_float(u()) - 1), shrink * (2 * to_unit_float(u()) - 1)};
    const Domain domain{wo.size() % 2 ? DomainKind::half_vector : DomainKind::equal_area, Symmetry::none, 0};
    const Direction known = wo_from_cosine(cos_theta_o);
    const DomainPoint q = lift(domain, known, p);
    if (!(q.geometry.wi.z > 1e-3f)) continue;
    wo.push_back(known), wi.push_back(q.geometry.wi);
  }
}

void add_lobe_pairs(const AnyBrdf& f, const std::vector<Ridge>& ridges, std::vector<Direction>& wo,
                    std::vector<Direction>& wi) {
  const auto add = [&](Direction known, const SharpLobe& lobe) {
    const LocalFrame<float> frame = frame_from_normal(lobe.centre);
    for (const float r : {0.f, 0.3f, 0.6f}) {
      for (const Direction& along : {frame.s, frame.t}) {
        const Direction w = normalize(lobe.centre + r * lobe.width * along);
        if (w.z > 1e-3f) wo.push_back(known), wi.push_back(w);
      }
    }
  };
  for (int k = 0; k < 16; ++k) {
    const float theta = 0.05f + 0.1f * float(k);
    const Direction known = wo_from_cosine(max(cos(theta), 1e-3f));
    if (f.traits().sharp) {
      for (const SharpLobe& lobe : f.traits().sharp(known)) add(known, lobe);
    }
    for (const Ridge& ridge : ridges) {
      if (const auto lobe = ridge.at(theta)) add(known, *lobe);
    }
  }
}

void turn_at_random(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi) {
  Pcg32 u(seed, 15);
  for (std::size_t k = 0; k < wo.size(); ++k) {
    const float phi = 6.2831853f * to_unit_float(u()), c = cos(phi), s = sin(phi);
    wo[k] = turn(wo[k], c, s), wi[k] = turn(wi[k], c, s);
  }
}

Values values_at(const AnyBrdf& f, const std::vector<Direction>& wo, const std::vector<Direction>& wi) {
  Values values(wo.size() * std::size_t(f.channels()));
  f.eval(wo, wi, values);
  return values;
}

void refuse_bad_values(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                       const std::vector<Direction>& wi) {
  const auto channels = std::size_t(f.channels());
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (is_good(values[k])) continue;
    const std::size_t i = k / channels;
    refuse_values(std::span(values).subspan(i * channels, channels), f.traits().name, wo[i], wi[i]);
  }
}

float difference(const Values& a, const Values& b) {
  double miss = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    miss += double(abs(a[i] - b[i])), sum += 0.5 * (double(a[i]) + double(b[i]));
  }
  return sum > 0 ? float(miss / sum) : 0.f;
}

}  // namespace reflectree::detail
