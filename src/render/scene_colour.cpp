// SPDX-License-Identifier: Apache-2.0
// Sampled spectra to linear sRGB. The colour-matching functions are the fits of Wyman, Sloan & Shirley 2013,
// "Simple Analytic Approximations to the CIE XYZ Color Matching Functions" (JCGT 2(2), eq. 4), good to about
// 1 %.
#include "scene_colour.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::render {

namespace {

double bump(double wavelength, double centre, double below, double above) {
  const double t = (wavelength - centre) / (wavelength < centre ? below : above);
  return std::exp(-.5 * t * t);
}

double at(const SampledSpectrum& s, double wavelength) {
  if (wavelength < s.front().first || wavelength > s.back().first) return 0;
  for (std::size_t i = 1; i < s.size(); ++i) {
    const auto [a, va] = s[i - 1];
    const auto [b, vb] = s[i];
    if (wavelength <= b) return va + (vb - va) * (wavelength - a) / (b - a);
  }
  return s.back().second;
}

}  // namespace

Rgb to_linear_srgb(const SampledSpectrum& spectrum, bool reflectance) {
  double xyz[3] = {}, white[3] = {};
  for (int nm = 360; nm <= 830; ++nm) {
    const double l = nm;
    const double cmf[3] = {1.056 * bump(l, 599.8, 37.9, 31.0) + .362 * bump(l, 442.0, 16.0, 26.7) -
                               .065 * bump(l, 501.1, 20.4, 26.2),
                           .821 * bump(l, 568.8, 46.9, 40.5) + .286 * bump(l, 530.9, 16.3, 31.1),
                           1.217 * bump(l, 437.0, 11.8, 36.0) + .681 * bump(l, 459.0, 26.0, 13.8)};
    const double v = at(spectrum, l);
    for (int k = 0; k < 3; ++k) xyz[k] += v * cmf[k], white[k] += cmf[k];
  }
  // A reflectance is seen by a white of its own: scaled so that 1 everywhere becomes (1, 1, 1).
  constexpr double d65[3] = {.95047, 1, 1.08883};
  for (int k = 0; k < 3; ++k) xyz[k] *= reflectance ? d65[k] / white[k] : 1 / white[1];
  const auto row = [&](double x, double y, double z) { return float(x * xyz[0] + y * xyz[1] + z * xyz[2]); };
  const Rgb c{row(3.240479, -1.537150, -.498535), row(-.969256, 1.875991, .041556),
              row(.055648, -.204043, 1.057311)};
  const auto kept = [&](float v) { return std::max(0.f, reflectance ? std::min(v, 1.f) : v); };
  return {kept(c.r), kept(c.g), kept(c.b)};
}

}  // namespace reflectree::render
