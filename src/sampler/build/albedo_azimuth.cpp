// SPDX-License-Identifier: Apache-2.0
#include "albedo_azimuth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "reflectree/math/scalar.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t most_rows = 65, most_table_rows = 257;
constexpr double thinned = 0.15;  // of the error, by which lines over the cosine may miss what was integrated

// Values at equidistant azimuths from 0 to the span, both ends included, as a trigonometric series: where
// mirroring leaves the function alone at both ends, of cosines; else periodic.
class Series {
 public:
  Series(const std::vector<double>& values, bool even) {
    const std::size_t n = values.size() - 1;
    std::vector<double> circle(values.begin(), values.end() - 1);  // a whole period
    if (even) {
      circle = values;
      for (std::size_t k = n - 1; k > 0; --k) circle.push_back(values[k]);
    }
    const std::size_t m = circle.size();
    turns_ = even ? 0.5 : 1;
    for (std::size_t j = 0; j <= m / 2; ++j) {
      double c = 0, s = 0;
      for (std::size_t k = 0; k < m; ++k) {
        const double angle = 2 * pi_v<double> * double(j * k % m) / double(m);
        c += circle[k] * std::cos(angle), s += circle[k] * std::sin(angle);
      }
      const double scale = (j == 0 || 2 * j == m ? 1. : 2.) / double(m);
      cosine_.push_back(scale * c), sine_.push_back(2 * j == m ? 0 : scale * s);
    }
  }
  // At a share of the span, in [0, 1].
  double at(double share) const {
    double sum = 0;
    for (std::size_t j = 0; j < cosine_.size(); ++j) {
      const double angle = 2 * pi_v<double> * double(j) * turns_ * share;
      sum += cosine_[j] * std::cos(angle) + sine_[j] * std::sin(angle);
    }
    return sum;
  }

 private:
  double turns_;
  std::vector<double> cosine_, sine_;
};

// [row][column], over common columns.
using Values = std::vector<std::vector<double>>;

std::vector<float> all_columns(const std::vector<AlbedoTable>& rows) {
  std::vector<float> columns;
  for (const AlbedoTable& row : rows) {
    columns.insert(columns.end(), row.cos_theta_o.begin(), row.cos_theta_o.end());
  }
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

std::vector<double> column_of(const Values& values, std::size_t column) {
  std::vector<double> v;
  for (const auto& row : values) v.push_back(row[column]);
  return v;
}

double allowance(float cosine) { return cosine < 1.745e-3f ? 10 : 1; }  // beyond 89.9 degrees

double relative(double a, double b) {
  const double larger = std::max(a, b);
  return larger > 0 ? std::abs(a - b) / larger : 0;
}

// Columns that lines over them serve as well, in every row, are left out.
void thin_out(std::vector<float>& columns, Values& values, double error) {
  std::vector<std::size_t> kept{0};
  const auto served = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from + 1; i < to; ++i) {
      const double t = double(columns[i] - columns[from]) / double(columns[to] - columns[from]);
      for (const auto& row : values) {
        const double line = (1 - t) * row[from] + t * row[to];
        if (relative(line, row[i]) > error * allowance(columns[i])) return false;
      }
    }
    return true;
  };
  for (std::size_t i = 1; i < columns.size();) {
    // As far as lines reach from the last column that was kept, by doubling steps and then single ones.
    std::size_t reach = i;
    for (std::size_t step = 1; reach + step < columns.size() && served(kept.back(), reach + step); step *= 2)
      reach += step;
    while (reach + 1 < columns.size() && served(kept.back(), reach + 1)) ++reach;
    kept.push_back(reach);
    i = reach + 1;
  }
  std::vector<float> left_columns;
  for (const std::size_t i : kept) left_columns.push_back(columns[i]);
  for (auto& row : values) {
    std::vector<double> left;
    for (const std::size_t i : kept) left.push_back(row[i]);
    row = std::move(left);
  }
  columns = std::move(left_columns);
}

}  // namespace

AlbedoTable albedo_over_azimuth(ViewerSymmetry symmetry, float relative_error,
                                const std::function<AlbedoTable(float phi_o, bool checked)>& row_at,
                                const std::function<bool()>& spent) {
  const float span = azimuth_span(symmetry);
  const bool even = is_mirrored(symmetry);
  const double error = double(relative_error);
  std::vector<AlbedoTable> rows;
  for (std::size_t k = 0; k < 5; ++k) rows.push_back(row_at(span * (float(k) / 4), true));
  std::vector<float> columns;
  Values values;
  // By the series through every second row, at the rows between; and, as it shrinks, what the series through
  // all rows will miss.
  double missed = 1, remaining = 1;
  for (;;) {
    columns = all_columns(rows);
    values.clear();
    for (const AlbedoTable& row : rows) {
      values.emplace_back();
      for (const float c : columns) values.back().push_back(double(albedo_at(row, c)));
    }
    const double before = missed;
    missed = 0;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::vector<double> all = column_of(values, i);
      std::vector<double> every_second;
      for (std::size_t k = 0; k < all.size(); k += 2) every_second.push_back(all[k]);
      const Series series(every_second, even);
      for (std::size_t k = 1; k < all.size(); k += 2) {
        const double foretold = series.at(double(k) / double(all.size() - 1));
        missed = std::max(missed, relative(foretold, all[k]) / allowance(columns[i]));
      }
    }
    remaining = missed * std::min(1., missed / before);
    if ((remaining <= 0.3 * error && missed <= 5 * error) || rows.size() >= most_rows || spent()) break;
    std::vector<AlbedoTable> finer;
    const std::size_t count = 2 * rows.size() - 1;
    for (std::size_t k = 0; k < count; ++k) {
      finer.push_back(k % 2 == 0 ? std::move(rows[k / 2])
                                 : row_at(span * (float(k) / float(count - 1)), false));
    }
    rows = std::move(finer);
  }

  AlbedoTable table;
  for (const AlbedoTable& row : rows)
    table.relative_error = std::max(table.relative_error, row.relative_error);
  thin_out(columns, values, thinned * error);
  // As many rows as lines need. Where the series has not settled, the rows themselves are what is known.
  const bool settled = missed <= 10 * error;
  std::vector<Series> series;
  for (std::size_t i = 0; settled && i < columns.size(); ++i) series.emplace_back(column_of(values, i), even);
  std::size_t count = rows.size();
  double bent = 0;  // by the cubics between the rows of the table
  for (; settled; count = 2 * count - 1) {
    bent = 0;
    const double n = double(count - 1);
    const std::array<float, 4> weights = cubic_weights(0.5f);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      for (std::size_t k = 0; k + 1 < count; ++k) {
        double cubic = 0;
        for (std::size_t m = 0; m < 4; ++m)
          cubic += double(weights[m]) * series[i].at((double(k) + double(m) - 1) / n);
        bent = std::max(bent, relative(cubic, series[i].at((double(k) + 0.5) / n)) / allowance(columns[i]));
      }
    }
    if (bent <= 0.2 * error || count >= most_table_rows) break;
  }
  table.cos_theta_o = columns;
  for (std::size_t k = 0; k < count; ++k) {
    table.phi_o.push_back(span * (float(k) / float(count - 1)));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double a = settled ? series[i].at(double(k) / double(count - 1)) : values[k][i];
      table.albedo.push_back(float(std::max(a, 0.)));
    }
  }
  table.even = even;
  if (!settled) bent = missed;
  const double stated = double(table.relative_error) + thinned * error + bent + (settled ? remaining : 0);
  table.relative_error = float(std::min(std::max(stated, error), 1.));
  return table;
}

}  // namespace reflectree::detail
