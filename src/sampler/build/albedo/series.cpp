// SPDX-License-Identifier: Apache-2.0
#include "series.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "panels.hpp"

namespace reflectree::detail {

namespace {

constexpr std::size_t most_table_rows = 257;
constexpr double most_bent = 0.2;  // of the error, by which cubics between rows may miss

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

// By how much cubics through so many rows miss the series.
double bend(const std::vector<Series>& series, const std::vector<float>& columns, std::size_t count) {
  double bent = 0;
  const double n = double(count - 1);
  const std::array<float, 4> weights = cubic_weights(0.5f);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = 0; k + 1 < count; ++k) {
      double cubic = 0;
      for (std::size_t m = 0; m < 4; ++m)
        cubic += double(weights[m]) * series[i].at((double(k) + double(m) - 1) / n);
      bent = std::max(bent, relative(cubic, series[i].at((double(k) + 0.5) / n)) / times_allowed(columns[i]));
    }
  }
  return bent;
}

}  // namespace

SeriesRows::SeriesRows(ViewerSymmetry symmetry, double error, const RowAt& row_at)
    : span_(azimuth_span(symmetry)), even_(is_mirrored(symmetry)), error_(error), row_at_(row_at) {
  for (std::size_t k = 0; k < 5; ++k) rows_.push_back(row_at(span_ * (float(k) / 4), true));
  compare();
}

void SeriesRows::refine() {
  std::vector<AlbedoTable> finer;
  const std::size_t count = 2 * rows_.size() - 1;
  for (std::size_t k = 0; k < count; ++k) {
    finer.push_back(k % 2 == 0 ? std::move(rows_[k / 2])
                               : row_at_(span_ * (float(k) / float(count - 1)), false));
  }
  rows_ = std::move(finer);
  compare();
}

void SeriesRows::compare() {
  columns_ = all_columns(rows_);
  values_ = values_on(rows_, columns_);
  const double before = missed_;
  missed_ = 0;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::vector<double> all = column_of(values_, i);
    std::vector<double> every_second;
    for (std::size_t k = 0; k < all.size(); k += 2) every_second.push_back(all[k]);
    const Series series(every_second, even_);
    for (std::size_t k = 1; k < all.size(); k += 2) {
      const double foretold = series.at(double(k) / double(all.size() - 1));
      missed_ = std::max(missed_, relative(foretold, all[k]) / times_allowed(columns_[i]));
    }
  }
  remaining_ = missed_ * std::min(1., missed_ / before);
}

AlbedoTable SeriesRows::table() const {
  AlbedoTable table;
  for (const AlbedoTable& row : rows_)
    table.relative_error = std::max(table.relative_error, row.relative_error);
  std::vector<float> columns = columns_;
  RowValues values = values_;
  thin_out(columns, values, thinned * error_);
  // As many rows as cubics need. Where the series has not settled, the rows themselves are what is known.
  const bool foretells = missed_ <= 10 * error_;
  std::vector<Series> series;
  for (std::size_t i = 0; foretells && i < columns.size(); ++i)
    series.emplace_back(column_of(values, i), even_);
  std::size_t count = rows_.size();
  double bent = foretells ? 0 : missed_;  // by the cubics between the rows of the table
  for (; foretells; count = 2 * count - 1) {
    bent = bend(series, columns, count);
    if (bent <= most_bent * error_ || count >= most_table_rows) break;
  }
  if (foretells && bent < most_bent * error_) {
    // Cubics miss with the fourth power of the distance: how few rows may do is known, and tried.
    const double wider = std::pow(bent / (most_bent * error_), 0.25);
    const std::size_t fewer =
        std::max(std::size_t(5), 1 + std::size_t(std::ceil(1.03 * wider * double(count - 1))));
    const double then = fewer < count ? bend(series, columns, fewer) : 1;
    if (then <= most_bent * error_) count = fewer, bent = then;
  }
  const double thin = thinning(error_, double(table.relative_error) + bent + (foretells ? remaining_ : 0));
  if (thin > thinned * error_) {
    columns = columns_, values = values_;
    thin_out(columns, values, thin);
    series.clear();
    for (std::size_t i = 0; foretells && i < columns.size(); ++i)
      series.emplace_back(column_of(values, i), even_);
  }
  table.cos_theta_o = columns;
  for (std::size_t k = 0; k < count; ++k) {
    table.phi_o.push_back(span_ * (float(k) / float(count - 1)));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double a = foretells ? series[i].at(double(k) / double(count - 1)) : values[k][i];
      table.albedo.push_back(float(std::max(a, 0.)));
    }
  }
  table.even = even_;
  const double stated = double(table.relative_error) + thin + bent + (foretells ? remaining_ : 0);
  table.relative_error = float(std::min(std::max(stated, error_), 1.));
  return table;
}

}  // namespace reflectree::detail
