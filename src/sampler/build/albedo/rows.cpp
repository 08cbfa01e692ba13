// SPDX-License-Identifier: Apache-2.0
#include "rows.hpp"

#include <algorithm>
#include <cmath>

#include "panels.hpp"

namespace reflectree::detail {

std::vector<float> all_columns(const std::vector<AlbedoTable>& rows) {
  std::vector<float> columns;
  for (const AlbedoTable& row : rows) {
    columns.insert(columns.end(), row.cos_theta_o.begin(), row.cos_theta_o.end());
  }
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

RowValues values_on(const std::vector<AlbedoTable>& rows, const std::vector<float>& columns) {
  RowValues values;
  for (const AlbedoTable& row : rows) {
    values.emplace_back();
    for (const float c : columns) values.back().push_back(double(albedo_at(row, c)));
  }
  return values;
}

std::vector<double> column_of(const RowValues& values, std::size_t column) {
  std::vector<double> v;
  for (const auto& row : values) v.push_back(row[column]);
  return v;
}

double relative(double a, double b) {
  const double larger = std::max(a, b);
  return larger > 0 ? std::abs(a - b) / larger : 0;
}

double thinning(double error, double known) { return std::max(thinned * error, 0.99 * (error - known)); }

void thin_out(std::vector<float>& columns, RowValues& values, double error) {
  std::vector<std::size_t> kept{0};
  const auto served = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from + 1; i < to; ++i) {
      const double t = double(columns[i] - columns[from]) / double(columns[to] - columns[from]);
      for (const auto& row : values) {
        const double line = (1 - t) * row[from] + t * row[to];
        if (relative(line, row[i]) > error * times_allowed(columns[i])) return false;
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

}  // namespace reflectree::detail
