// SPDX-License-Identifier: Apache-2.0
#include "spectral_colour.hpp"

#include <cmath>
#include <iterator>

#include "reflectree/brdf/tables/between_nodes.hpp"
#include "reflectree/math/cie_1931.hpp"

namespace reflectree {

Rgb rgb_of_xyz(double x, double y, double z) {  // IEC 61966-2-1
  return {float(3.240479 * x - 1.537150 * y - 0.498535 * z),
          float(-0.969256 * x + 1.875991 * y + 0.041556 * z),
          float(0.055648 * x - 0.204043 * y + 1.057311 * z)};
}

std::vector<Rgb> rgb_of_wavelengths(const std::vector<float>& wavelengths) {
  struct Xyz {
    double v[3] = {};
  };
  std::vector<Xyz> sums(wavelengths.size());
  double white = 0;
  const int first = cie_1931[0].nm, last = cie_1931[std::size(cie_1931) - 1].nm;
  for (int nm = first; nm <= last; ++nm) {
    const CieRow* row = cie_1931 + (nm == last ? nm - 5 - first : nm - first) / 5;
    const double t = (nm - row->nm) / 5.;
    const double light = std::lerp(row[0].d65, row[1].d65, t);
    white += light * std::lerp(row[0].xyz[1], row[1].xyz[1], t);
    if (float(nm) < wavelengths.front() || float(nm) > wavelengths.back()) continue;
    const detail::BetweenNodes between = detail::between_nodes(wavelengths, float(nm));
    for (int k = 0; k < 3; ++k) {
      const double power = light * std::lerp(row[0].xyz[k], row[1].xyz[k], t);
      sums[between.low].v[k] += power * double(1 - between.fraction);
      sums[between.high].v[k] += power * double(between.fraction);
    }
  }
  std::vector<Rgb> weights;
  for (const Xyz& sum : sums)
    weights.push_back(rgb_of_xyz(sum.v[0] / white, sum.v[1] / white, sum.v[2] / white));
  return weights;
}

}  // namespace reflectree
