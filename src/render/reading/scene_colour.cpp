// SPDX-License-Identifier: Apache-2.0
// Sampled spectra to linear sRGB, as Mitsuba's RGB variants do: by the CIE 1931 functions, a reflectance or
// an index seen under D65, an emission as it is; Y of a constant 1 is 1. Tables are interpolated linearly
// at every nm.
#include "scene_colour.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "reflectree/math/cie_1931.hpp"

namespace reflectree::render {

namespace {

double at(const SampledSpectrum& s, double wavelength) {
  if (wavelength < s.front().first || wavelength > s.back().first) return 0;
  for (std::size_t i = 1; i < s.size(); ++i) {
    const auto [a, va] = s[i - 1];
    const auto [b, vb] = s[i];
    if (wavelength <= b) return va + (vb - va) * (wavelength - a) / (b - a);
  }
  return s.back().second;
}

CieRow row_at(double nm) {
  const CieRow* a =
      cie_1931 + std::min<std::ptrdiff_t>(std::ptrdiff_t(nm - 360) / 5, std::ssize(cie_1931) - 2);
  const double t = (nm - a->nm) / 5.;
  CieRow r{a->nm, {}, std::lerp(a[0].d65, a[1].d65, t)};
  for (int k = 0; k < 3; ++k) r.xyz[k] = std::lerp(a[0].xyz[k], a[1].xyz[k], t);
  return r;
}

}  // namespace

Rgb to_linear_srgb(const SampledSpectrum& spectrum, ColourOf of) {
  double xyz[3] = {}, white = 0;
  // Mitsuba's thousand points: a spectrum may end between them.
  for (int i = 0; i < 1000; ++i) {
    const double nm = 360 + 470 * (i / 999.);
    const CieRow row = row_at(nm);
    const double light = of == ColourOf::light ? 1 : row.d65, v = at(spectrum, nm);
    for (int k = 0; k < 3; ++k) xyz[k] += v * light * row.xyz[k];
    white += light * row.xyz[1];
  }
  // IEC 61966-2-1.
  const auto row = [&](double x, double y, double z) {
    return float((x * xyz[0] + y * xyz[1] + z * xyz[2]) / white);
  };
  const Rgb c{row(3.240479, -1.537150, -.498535), row(-.969256, 1.875991, .041556),
              row(.055648, -.204043, 1.057311)};
  const auto kept = [&](float v) {
    return std::max(0.f, of == ColourOf::reflectance ? std::min(v, 1.f) : v);
  };
  return {kept(c.r), kept(c.g), kept(c.b)};
}

}  // namespace reflectree::render
