// SPDX-License-Identifier: Apache-2.0
#include "parameters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "reflectree/math/scalar.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t most_slices = 129, most_rows = 257;
constexpr double thinned = 0.35;  // of the error, by which lines over the cosine may miss what was integrated

using Flat = std::vector<double>;  // [whatever else][cos_theta_o]

// What all slices are brought to.
struct Shape {
  std::vector<float> columns, azimuths;
  std::vector<AlbedoAxis> inner;
  bool even = false;
};
Shape shape_of(const std::vector<AlbedoTable>& slices) {
  Shape shape{{}, {}, slices.front().parameters, slices.front().even};
  for (const AlbedoTable& slice : slices) {
    shape.columns.insert(shape.columns.end(), slice.cos_theta_o.begin(), slice.cos_theta_o.end());
    if (slice.phi_o.size() > shape.azimuths.size()) shape.azimuths = slice.phi_o;
    for (std::size_t i = 0; i < shape.inner.size(); ++i)
      shape.inner[i].rows = std::max(shape.inner[i].rows, slice.parameters[i].rows);
  }
  std::sort(shape.columns.begin(), shape.columns.end());
  shape.columns.erase(std::unique(shape.columns.begin(), shape.columns.end()), shape.columns.end());
  return shape;
}
Flat flat_of(const AlbedoTable& slice, const Shape& shape) {
  Flat flat;
  const std::size_t inner = shape.inner.empty() ? 1 : shape.inner[0].rows;
  for (std::size_t k = 0; k < inner; ++k) {
    Coordinates at{};
    if (!shape.inner.empty())
      at[0] = linear_mix(float(k) / float(inner - 1), shape.inner[0].lo, shape.inner[0].hi);
    for (std::size_t a = 0; a < std::max<std::size_t>(shape.azimuths.size(), 1); ++a) {
      float phi = shape.azimuths.empty() ? 0 : shape.azimuths[a];
      // Where a segment ends and the next one begins, both sides.
      if (a + 1 < shape.azimuths.size() && shape.azimuths[a + 1] == phi) phi = std::nextafter(phi, 0.f);
      for (const float c : shape.columns) flat.push_back(double(albedo_at(slice, c, phi, at)));
    }
  }
  return flat;
}

// Chebyshev's places of the second kind, in [0, 1]: those of 2 n - 1 slices include those of n.
double place_of(std::size_t k, std::size_t count) {
  return 0.5 * (1 - std::cos(pi_v<double> * double(k) / double(count - 1)));
}
// The weights by which the polynomial through values at the places takes them, at x; barycentric (Berrut and
// Trefethen 2004, eq. 5.4).
std::vector<double> weights_at(double x, std::size_t count) {
  std::vector<double> w(count);
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double off = x - place_of(k, count);
    if (std::abs(off) < 1e-14) {
      std::fill(w.begin(), w.end(), 0.);
      w[k] = 1;
      return w;
    }
    w[k] = (k % 2 ? -1. : 1.) * (k == 0 || k + 1 == count ? 0.5 : 1.) / off;
    sum += w[k];
  }
  for (double& v : w) v /= sum;
  return w;
}
template <class Value>
double mixed(const std::vector<double>& weights, const Value& value) {
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * value(k);
  return sum;
}

double relative(double a, double b) {
  const double larger = std::max(a, b);
  return larger > 0 ? std::abs(a - b) / larger : 0;
}
double allowance(float cosine) { return cosine < 1.745e-3f ? 10 : 1; }  // beyond 89.9 degrees

// By how much the polynomial through every second slice misses those between.
double missed_by(const std::vector<Flat>& values, const std::vector<float>& columns) {
  const std::size_t count = values.size(), half = (count + 1) / 2;
  double missed = 0;
  for (std::size_t k = 1; k < count; k += 2) {
    const std::vector<double> w = weights_at(place_of(k, count), half);
    for (std::size_t i = 0; i < values[k].size(); ++i) {
      const double foretold = mixed(w, [&](std::size_t n) { return values[2 * n][i]; });
      missed = std::max(missed, relative(foretold, values[k][i]) / allowance(columns[i % columns.size()]));
    }
  }
  return missed;
}

// Equidistant rows read off the polynomial, and what the cubics through them miss between.
struct Rows {
  std::vector<Flat> values;
  double bent = 0;
};
Rows rows_of(const std::vector<Flat>& slices, std::size_t count, const std::vector<float>& columns) {
  Rows rows;
  const std::size_t size = slices.front().size();
  const auto read = [&](double x) {
    const std::vector<double> w = weights_at(x, slices.size());
    Flat flat(size);
    for (std::size_t i = 0; i < size; ++i)
      flat[i] = std::max(mixed(w, [&](std::size_t n) { return slices[n][i]; }), 0.);
    return flat;
  };
  for (std::size_t k = 0; k < count; ++k) rows.values.push_back(read(double(k) / double(count - 1)));
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const Flat middle = read((double(k) + 0.5) / double(count - 1));
    // The four rows of the cubic; at both ends those of the next one.
    const std::size_t first = std::min(k > 0 ? k - 1 : 0, count - 4);
    const std::array<float, 4> w = cubic_weights(float(k) + 0.5f - float(first + 1));
    for (std::size_t i = 0; i < size; ++i) {
      double cubic = 0;
      for (std::size_t n = 0; n < 4; ++n) cubic += double(w[n]) * rows.values[first + n][i];
      rows.bent = std::max(rows.bent, relative(cubic, middle[i]) / allowance(columns[i % columns.size()]));
    }
  }
  return rows;
}

// Columns that lines over them serve as well, in every row, are left out.
std::vector<std::size_t> columns_kept(const std::vector<Flat>& rows, const std::vector<float>& columns,
                                      double error) {
  const std::size_t n = columns.size();
  const auto served = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from + 1; i < to; ++i) {
      const double t = double(columns[i] - columns[from]) / double(columns[to] - columns[from]);
      for (const Flat& row : rows) {
        for (std::size_t at = 0; at < row.size(); at += n) {
          const double line = (1 - t) * row[at + from] + t * row[at + to];
          if (relative(line, row[at + i]) > error * allowance(columns[i])) return false;
        }
      }
    }
    return true;
  };
  std::vector<std::size_t> kept{0};
  for (std::size_t i = 1; i < n;) {
    std::size_t reach = i;
    for (std::size_t step = 1; reach + step < n && served(kept.back(), reach + step); step *= 2)
      reach += step;
    while (reach + 1 < n && served(kept.back(), reach + 1)) ++reach;
    kept.push_back(reach);
    i = reach + 1;
  }
  return kept;
}

}  // namespace

AlbedoTable albedo_over_parameter(const KnownParameter& parameter, float relative_error,
                                  const std::function<AlbedoTable(float coordinate, bool checked)>& slice_at,
                                  const std::function<bool()>& spent) {
  const double error = double(relative_error);
  const float lo = lowest(parameter), hi = highest(parameter);
  const auto slice = [&](std::size_t k, std::size_t count, bool checked) {
    return slice_at(clamp(linear_mix(float(place_of(k, count)), lo, hi), lo, hi), checked);
  };
  std::vector<AlbedoTable> slices;
  for (std::size_t k = 0; k < 5; ++k) slices.push_back(slice(k, 5, true));
  Shape shape;
  std::vector<Flat> values;
  double missed = 1, remaining = 1;
  for (;;) {
    shape = shape_of(slices);
    values.clear();
    for (const AlbedoTable& one : slices) values.push_back(flat_of(one, shape));
    const double before = missed;
    missed = missed_by(values, shape.columns);
    remaining = missed * std::min(1., missed / before);
    if ((remaining <= 0.15 * error && missed <= 5 * error) || slices.size() >= most_slices || spent()) break;
    std::vector<AlbedoTable> finer;
    const std::size_t count = 2 * slices.size() - 1;
    for (std::size_t k = 0; k < count; ++k)
      finer.push_back(k % 2 == 0 ? std::move(slices[k / 2]) : slice(k, count, false));
    slices = std::move(finer);
  }
  double of_slices = 0;
  for (const AlbedoTable& one : slices) of_slices = std::max(of_slices, double(one.relative_error));

  std::size_t count = 4;
  Rows rows = rows_of(values, count, shape.columns);
  // No finer than what the slices know.
  const double known = std::max(error, of_slices + remaining);
  while (rows.bent > 0.15 * known && count < most_rows) {
    count = std::min(most_rows, count + std::max<std::size_t>(1, count / 6));
    rows = rows_of(values, count, shape.columns);
  }
  const std::vector<std::size_t> kept = columns_kept(rows.values, shape.columns, thinned * known);
  AlbedoTable table;
  for (const std::size_t i : kept) table.cos_theta_o.push_back(shape.columns[i]);
  for (const Flat& row : rows.values) {
    for (std::size_t at = 0; at < row.size(); at += shape.columns.size()) {
      for (const std::size_t i : kept) table.albedo.push_back(float(row[at + i]));
    }
  }
  table.phi_o = shape.azimuths, table.even = shape.even;
  table.parameters = shape.inner;
  table.parameters.push_back({lo, hi, std::uint32_t(count)});
  const double stated = of_slices + thinned * known + rows.bent + remaining;
  table.relative_error = float(std::min(std::max(stated, error), 1.));
  return table;
}

}  // namespace reflectree::detail
