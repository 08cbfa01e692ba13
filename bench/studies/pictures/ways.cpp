// SPDX-License-Identifier: Apache-2.0
#include "ways.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::pictures {

namespace {

using render::Technique;
using Points = render::PointSet::Kind;

constexpr Way all[] = {
    {"plain", true, Points::independent, Technique::surface, 1, false},
    {"split in 4, independent", true, Points::independent, Technique::surface, 4, false},
    {"split in 4, stratified", true, Points::independent, Technique::surface, 4, true},
    {"Owen–Sobol' points", true, Points::sobol, Technique::surface, 1, false},
    {"MIS with lights", true, Points::independent, Technique::balance, 1, false},
    {"resampled by light, 1 of 8", true, Points::independent, Technique::resampled, 8, false},
    {"MIS, Sobol'", false, Points::sobol, Technique::balance, 1, false},
    {"MIS, split, stratified", false, Points::independent, Technique::balance, 4, true},
    {"MIS, split, stratified, Sobol'", false, Points::sobol, Technique::balance, 4, true},
    {"resampled, stratified, Sobol'", false, Points::sobol, Technique::resampled, 8, true},
};

// Ratio of the means over seeds, whose figures may be of few bright samples: logarithms would mistake them.
template <class Figure>
Estimate ratio_of_means(const Cells& a, const Cells& b, const Figure& figure) {
  std::vector<double> x, y;
  for (const PictureCell* c : a) x.push_back(figure(*c));
  for (const PictureCell* c : b) y.push_back(figure(*c));
  const Estimate p = mean_of(x), q = mean_of(y);
  const double value = p.value / q.value;
  return {value, value * std::hypot(p.error / p.value, q.error / q.value)};
}

}  // namespace

std::span<const Way> ways() { return all; }

Method method_of(const Way& way, int directions) {
  Method m;
  m.transport.method = render::Transport::Method::direct;
  m.transport.split = way.split;
  m.technique = way.technique, m.points = way.points;
  m.samples = way.technique == Technique::resampled ? directions : std::max(1, directions / way.split);
  return m;
}

bool is_shown(const Way& way, std::string_view sampler) {
  return sampler != "one-shot-monotone" || way.points == Points::sobol || &way == &all[0];
}

Gain gain_of(const Cells& plain, const Cells& way) {
  return {
      ratio_of_means(plain, way, [](const PictureCell& c) { return c.equal.error.all; }),
      ratio_of_means(plain, way, [](const PictureCell& c) { return c.equal.error.all * c.equal.seconds; }),
      ratio_of_means(plain, way, [](const PictureCell& c) { return c.equal.error.trimmed; })};
}

}  // namespace reflectree::pictures
