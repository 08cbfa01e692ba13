// SPDX-License-Identifier: Apache-2.0
// The albedo of a function that is smooth all around: few rows at equidistant azimuths foretell all others.
#pragma once

#include "reflectree/sampler/known/viewer_frame.hpp"
#include "rows.hpp"

namespace reflectree::detail {

// Rows at equidistant azimuths from 0 to the span, five at first, and the trigonometric series through them.
class SeriesRows {
 public:
  SeriesRows(ViewerSymmetry symmetry, double error, const RowAt& row_at);
  std::size_t size() const { return rows_.size(); }
  // Whether every second row has foretold the others.
  bool settled() const { return remaining_ <= 0.3 * error_ && missed_ <= 5 * error_; }
  // Twice as many.
  void refine();
  // As many rows, read off the series, as cubics between them need.
  AlbedoTable table() const;

 private:
  void compare();

  const float span_;
  const bool even_;
  const double error_;
  const RowAt& row_at_;
  std::vector<AlbedoTable> rows_;
  std::vector<float> columns_;
  RowValues values_;
  // By the series through every second row, at the rows between; and, as that shrinks, what the series
  // through all rows will miss.
  double missed_ = 1, remaining_ = 1;
};

}  // namespace reflectree::detail
