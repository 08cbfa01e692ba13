// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/rgl_fit.hpp"

#include <algorithm>
#include <cmath>

#include "probe_pairs.hpp"
#include "reflectree/error.hpp"
#include "rgl_normals.hpp"
#include "rgl_slice.hpp"

namespace reflectree {
namespace {

constexpr double right_angle = 0.5 * pi_v<double>;

// Whether f stays what it is when both directions are moved, at random pairs.
template <class Move>
bool is_symmetric(const AnyBrdf& f, const Move& move) {
  Pcg32 random(4), turns(5);
  double difference = 0, sum = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const RandomPair pair = next_pair(random, i);
    const float turn_by = to_unit_float(turns());
    const Spectrum a = f(pair.geometry);
    const Spectrum b = f(shading_geometry(move(pair.geometry.wo, turn_by), move(pair.geometry.wi, turn_by)));
    for (int c = 0; c < a.channels(); ++c)
      difference += std::abs(double(a[c]) - double(b[c])), sum += double(a[c]) + double(b[c]);
  }
  return difference <= 1e-4 * sum;
}

Direction turned(Direction w, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {w.x * c - w.y * s, w.x * s + w.y * c, w.z};
}

bool is_isotropic(const AnyBrdf& f) {
  if (f.traits().isotropic_by_formula) return true;
  return is_symmetric(f, [](Direction w, float t) { return turned(w, 2 * pi * t); });
}

int reduction_of(const AnyBrdf& f) {
  const bool mirrors = is_symmetric(f,
                                    [](Direction w, float) {
                                      return Direction{-w.x, w.y, w.z};
                                    }) &&
                       is_symmetric(f, [](Direction w, float) {
                         return Direction{w.x, -w.y, w.z};
                       });
  if (mirrors) return 4;
  return is_symmetric(f, [](Direction w, float) { return Direction{-w.x, -w.y, w.z}; }) ? 2 : 1;
}

}  // namespace

RglFit fit_rgl(const AnyBrdf& f, const RglFitOptions& options, const Host& host) {
  const BrdfTraits& traits = f.traits();
  if (traits.channels != 1 && traits.channels != 3) {
    throw Error(std::to_string(traits.channels) + " channels: RGL files are written with 3", traits.name,
                "bake a BRDF of 1 or 3 channels");
  }
  const bool isotropic = is_isotropic(f);
  RglFit fit;
  RglWideFields& fields = fit.fields;
  fields.name = traits.name;
  fields.reduction = isotropic ? 1 : reduction_of(f);
  if (!isotropic) {
    const int count = (options.azimuths - 1) * 4 / fields.reduction + 1;
    fields.phi_o.clear();
    for (int i = 0; i < count; ++i) {
      fields.phi_o.push_back(
          float(-pi_v<double> + 2 * pi_v<double> / fields.reduction * i / double(count - 1)));
    }
  }
  // Closer to each other towards grazing, where f changes most.
  for (int i = 0; i < options.elevations; ++i) {
    const double left = 1 - i / double(options.elevations - 1);
    fields.theta_o.push_back(float(right_angle * (1 - left * std::sqrt(left))));
  }
  host.stage("fitting the normals");
  const Host serial;
  const Host& threads = traits.concurrent ? host : serial;
  const RglNormals normals = fit_normals(f, isotropic, options.normals, threads);
  fields.ndf = normals.ndf, fields.sigma = normals.sigma;
  fields.warp_width = fields.warp_height = options.normals;
  fields.colour_width = fields.colour_height = options.colours;
  host.stage("fitting the colours");
  const std::size_t rows = fields.theta_o.size();
  std::vector<RglSlice> slices(rows);
  for (std::size_t p = 0; p < fields.phi_o.size(); ++p) {
    if (host.cancelled()) throw Cancelled();
    const auto some = [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        slices[t] =
            fit_rgl_slice(f, normals, options, isotropic, double(fields.theta_o[t]), double(fields.phi_o[p]));
    };
    threads.parallel_for(rows, some);
    for (const RglSlice& slice : slices) {
      fields.vndf.insert(fields.vndf.end(), slice.vndf.begin(), slice.vndf.end());
      fields.colours.insert(fields.colours.end(), slice.colours.begin(), slice.colours.end());
      fit.luminance.insert(fit.luminance.end(), slice.luminance.begin(), slice.luminance.end());
    }
    host.progress(float(p + 1) / float(fields.phi_o.size()));
  }
  return fit;
}

double rgl_fit_error(const RglWideTable& table, const AnyBrdf& f) {
  Pcg32 random(38);
  double difference = 0, sum = 0;
  for (std::uint64_t i = 0; i < probed_pairs; ++i) {
    const ShadingGeometry<float> g = next_pair(random, i).geometry;
    const double weight = double(g.cos_theta_o) * double(g.cos_theta_i);
    const Spectrum fitted = table(g), wanted = f(g);
    for (int c = 0; c < 3; ++c) {
      const double v = double(wanted[wanted.channels() == 3 ? c : 0]);
      difference += weight * std::abs(double(fitted[c]) - v), sum += weight * v;
    }
  }
  return sum > 0 ? difference / sum : 0;
}

}  // namespace reflectree
