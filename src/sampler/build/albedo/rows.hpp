// SPDX-License-Identifier: Apache-2.0
// Rows of albedo over theta_o, each at an azimuth of the viewer, held against each other.
#pragma once

#include <functional>
#include <vector>

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

// The table at one azimuth of the viewer, radians, to a third of the error asked for. `checked` by other
// integrals: most rows are checked by what others foretell.
using RowAt = std::function<AlbedoTable(float phi_o, bool checked)>;

// [row][column], over common columns.
using RowValues = std::vector<std::vector<double>>;

// The cosines at which any row has an entry, and every row there.
std::vector<float> all_columns(const std::vector<AlbedoTable>& rows);
RowValues values_on(const std::vector<AlbedoTable>& rows, const std::vector<float>& columns);
std::vector<double> column_of(const RowValues& values, std::size_t column);
// |a - b| over the larger.
double relative(double a, double b);
// Columns that lines over them serve as well, in every row, are left out.
void thin_out(std::vector<float>& columns, RowValues& values, double error);

// By how much lines over the cosine may miss what was integrated: this share of the error, or all that what else
// is `known` to miss leaves of it.
inline constexpr double thinned = 0.15;
double thinning(double error, double known);

}  // namespace reflectree::detail
